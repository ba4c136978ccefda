// libgpiod 1.x, as in Debian 12.
#include <fmt/format.h>
#include <gpiod.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <utility>

#include "drivers/gpio/gpio_lines.hpp"

namespace gimbal {
namespace {

constexpr const char* kConsumer = "gimbald";

struct ChipCloser {
  void operator()(gpiod_chip* chip) const { gpiod_chip_close(chip); }  // gives lines back, too
};
using Chip = std::unique_ptr<gpiod_chip, ChipCloser>;

struct Line {
  Chip chip;
  gpiod_line* line = nullptr;
};

tl::unexpected<Error> not_to_be_had(const GpioAddress& address, const std::string& obstacle) {
  return bad_input(fmt::format("gpio {}: {}", to_string(address), obstacle));
}

Result<Line> find_line(const GpioAddress& address) {
  const std::string path = gpio_chip_path(address.chip);
  Chip chip(gpiod_chip_open(path.c_str()));
  if (!chip) return not_to_be_had(address, gpio_chip_obstacle(path, errno));
  gpiod_line* line = gpiod_chip_get_line(chip.get(), address.line);
  if (line == nullptr) return not_to_be_had(address, gpio_line_obstacle(errno));
  return Line{std::move(chip), line};
}

int polarity_flags(GpioPolarity polarity) {
  return polarity == GpioPolarity::active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0;
}

int input_flags(const GpioInputSettings& settings) {
  const int polarity = polarity_flags(settings.polarity);
  switch (settings.bias) {
    case GpioBias::pull_up:
      return polarity | GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP;
    case GpioBias::pull_down:
      return polarity | GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN;
    case GpioBias::as_is:
      break;
  }
  return polarity;
}

int request_edges(gpiod_line* line, const GpioInputSettings& settings) {
  const int flags = input_flags(settings);
  switch (settings.edges) {
    case GpioEdges::rising:
      return gpiod_line_request_rising_edge_events_flags(line, kConsumer, flags);
    case GpioEdges::falling:
      return gpiod_line_request_falling_edge_events_flags(line, kConsumer, flags);
    case GpioEdges::both:
      break;
  }
  return gpiod_line_request_both_edges_events_flags(line, kConsumer, flags);
}

KernelEdge to_edge(const gpiod_line_event& event) {
  const bool is_rising = event.event_type == GPIOD_LINE_EVENT_RISING_EDGE;
  return {.stamp = SensorTime(std::chrono::seconds(event.ts.tv_sec) +
                              std::chrono::nanoseconds(event.ts.tv_nsec)),
          .direction = is_rising ? EdgeDirection::rising : EdgeDirection::falling,
          .sequence = {}};
}

class InputV1 final : public GpioInput {
 public:
  InputV1(GpioAddress address, Line line) : address_(std::move(address)), line_(std::move(line)) {}

  [[nodiscard]] int fd() const override { return gpiod_line_event_get_fd(line_.line); }

  [[nodiscard]] Result<std::vector<KernelEdge>> read() override {
    std::array<gpiod_line_event, 16> events{};
    const int count = gpiod_line_event_read_multiple(line_.line, events.data(), events.size());
    if (count < 0) {
      return failed(fmt::format("gpio {}: cannot read edges: {}", to_string(address_),
                                gpio_line_obstacle(errno)));
    }
    std::vector<KernelEdge> edges;
    edges.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i)
      edges.push_back(to_edge(events.at(static_cast<std::size_t>(i))));
    return edges;
  }

 private:
  GpioAddress address_;
  Line line_;
};

class OutputV1 final : public GpioOutput {
 public:
  OutputV1(GpioAddress address, Line line) : address_(std::move(address)), line_(std::move(line)) {}

  [[nodiscard]] Result<void> set(GpioLevel level) override {
    if (gpiod_line_set_value(line_.line, level == GpioLevel::active ? 1 : 0) == 0) return {};
    return failed(
        fmt::format("gpio {}: cannot be set: {}", to_string(address_), gpio_line_obstacle(errno)));
  }

 private:
  GpioAddress address_;
  Line line_;
};

}  // namespace

Result<std::unique_ptr<GpioInput>> GpioInput::open(const GpioInputSettings& settings) {
  auto line = find_line(settings.address);
  if (!line) return tl::unexpected(line.error());
  if (request_edges(line->line, settings) != 0) {
    return not_to_be_had(settings.address, gpio_line_obstacle(errno));
  }
  return std::make_unique<InputV1>(settings.address, *std::move(line));
}

Result<std::unique_ptr<GpioOutput>> GpioOutput::open(const GpioOutputSettings& settings) {
  auto line = find_line(settings.address);
  if (!line) return tl::unexpected(line.error());
  const int flags = polarity_flags(settings.polarity);
  if (gpiod_line_request_output_flags(line->line, kConsumer, flags, 0) != 0) {
    return not_to_be_had(settings.address, gpio_line_obstacle(errno));
  }
  return std::make_unique<OutputV1>(settings.address, *std::move(line));
}

Result<GpioChipInfo> read_gpio_chip(const std::string& path) {
  const Chip chip(gpiod_chip_open(path.c_str()));
  if (!chip) return bad_input(gpio_chip_obstacle(path, errno));
  GpioChipInfo info{.name = gpiod_chip_name(chip.get()),
                    .label = gpiod_chip_label(chip.get()),
                    .lines = gpiod_chip_num_lines(chip.get()),
                    .named_lines = {}};
  for (unsigned i = 0; i < info.lines; ++i) {
    gpiod_line* line = gpiod_chip_get_line(chip.get(), i);
    const char* name = line != nullptr ? gpiod_line_name(line) : nullptr;
    if (name != nullptr) info.named_lines.push_back(fmt::format("{} {}", i, name));
  }
  return info;
}

}  // namespace gimbal
