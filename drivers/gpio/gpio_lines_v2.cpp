// libgpiod 2.x, as in Debian 13.
#include <fmt/format.h>
#include <gpiod.h>

#include <cerrno>
#include <chrono>
#include <utility>

#include "drivers/gpio/gpio_lines.hpp"

namespace gimbal {
namespace {

constexpr const char* kConsumer = "gimbald";
constexpr std::size_t kEdgesHeld = 256;  // by the kernel and by one read

template <auto function>
struct Deleter {
  template <typename T>
  void operator()(T* object) const {
    function(object);
  }
};
using Chip = std::unique_ptr<gpiod_chip, Deleter<gpiod_chip_close>>;
using ChipInfo = std::unique_ptr<gpiod_chip_info, Deleter<gpiod_chip_info_free>>;
using LineInfo = std::unique_ptr<gpiod_line_info, Deleter<gpiod_line_info_free>>;
using LineSettings = std::unique_ptr<gpiod_line_settings, Deleter<gpiod_line_settings_free>>;
using LineConfig = std::unique_ptr<gpiod_line_config, Deleter<gpiod_line_config_free>>;
using RequestConfig = std::unique_ptr<gpiod_request_config, Deleter<gpiod_request_config_free>>;
using Request = std::unique_ptr<gpiod_line_request, Deleter<gpiod_line_request_release>>;
using EdgeBuffer = std::unique_ptr<gpiod_edge_event_buffer, Deleter<gpiod_edge_event_buffer_free>>;

tl::unexpected<Error> not_to_be_had(const GpioAddress& address, const std::string& obstacle) {
  return bad_input(fmt::format("gpio {}: {}", to_string(address), obstacle));
}

Result<Request> request_line(const GpioAddress& address, gpiod_line_settings& settings) {
  const std::string path = gpio_chip_path(address.chip);
  const Chip chip(gpiod_chip_open(path.c_str()));
  if (!chip) return not_to_be_had(address, gpio_chip_obstacle(path, errno));
  const LineConfig lines(gpiod_line_config_new());
  const RequestConfig how(gpiod_request_config_new());
  if (!lines || !how) return not_to_be_had(address, gpio_line_obstacle(errno));
  gpiod_request_config_set_consumer(how.get(), kConsumer);
  gpiod_request_config_set_event_buffer_size(how.get(), kEdgesHeld);
  if (gpiod_line_config_add_line_settings(lines.get(), &address.line, 1, &settings) != 0) {
    return not_to_be_had(address, gpio_line_obstacle(errno));
  }
  Request request(gpiod_chip_request_lines(chip.get(), how.get(), lines.get()));
  if (!request) return not_to_be_had(address, gpio_line_obstacle(errno));
  return request;
}

gpiod_line_edge edges_of(const GpioInputSettings& settings) {
  switch (settings.edges) {
    case GpioEdges::rising:
      return GPIOD_LINE_EDGE_RISING;
    case GpioEdges::falling:
      return GPIOD_LINE_EDGE_FALLING;
    case GpioEdges::both:
      break;
  }
  return GPIOD_LINE_EDGE_BOTH;
}

gpiod_line_bias bias_of(const GpioInputSettings& settings) {
  switch (settings.bias) {
    case GpioBias::pull_up:
      return GPIOD_LINE_BIAS_PULL_UP;
    case GpioBias::pull_down:
      return GPIOD_LINE_BIAS_PULL_DOWN;
    case GpioBias::as_is:
      break;
  }
  return GPIOD_LINE_BIAS_AS_IS;
}

KernelEdge to_edge(gpiod_edge_event* event) {
  const bool is_rising = gpiod_edge_event_get_event_type(event) == GPIOD_EDGE_EVENT_RISING_EDGE;
  const auto stamp_ns = static_cast<std::int64_t>(gpiod_edge_event_get_timestamp_ns(event));
  return {.stamp = SensorTime(SensorDuration(stamp_ns)),
          .direction = is_rising ? EdgeDirection::rising : EdgeDirection::falling,
          .sequence = static_cast<std::uint32_t>(gpiod_edge_event_get_line_seqno(event))};
}

class InputV2 final : public GpioInput {
 public:
  InputV2(GpioAddress address, Request request)
      : address_(std::move(address)),
        request_(std::move(request)),
        buffer_(gpiod_edge_event_buffer_new(kEdgesHeld)) {}

  [[nodiscard]] int fd() const override { return gpiod_line_request_get_fd(request_.get()); }

  [[nodiscard]] Result<std::vector<KernelEdge>> read() override {
    const int count =
        gpiod_line_request_read_edge_events(request_.get(), buffer_.get(), kEdgesHeld);
    if (count < 0) {
      return failed(fmt::format("gpio {}: cannot read edges: {}", to_string(address_),
                                gpio_line_obstacle(errno)));
    }
    std::vector<KernelEdge> edges;
    edges.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
      edges.push_back(
          to_edge(gpiod_edge_event_buffer_get_event(buffer_.get(), static_cast<unsigned long>(i))));
    }
    return edges;
  }

 private:
  GpioAddress address_;
  Request request_;
  EdgeBuffer buffer_;
};

class OutputV2 final : public GpioOutput {
 public:
  OutputV2(GpioAddress address, Request request)
      : address_(std::move(address)), request_(std::move(request)) {}

  [[nodiscard]] Result<void> set(GpioLevel level) override {
    const auto value =
        level == GpioLevel::active ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
    if (gpiod_line_request_set_value(request_.get(), address_.line, value) == 0) return {};
    return failed(
        fmt::format("gpio {}: cannot be set: {}", to_string(address_), gpio_line_obstacle(errno)));
  }

 private:
  GpioAddress address_;
  Request request_;
};

}  // namespace

Result<std::unique_ptr<GpioInput>> GpioInput::open(const GpioInputSettings& settings) {
  const LineSettings line(gpiod_line_settings_new());
  if (!line) return not_to_be_had(settings.address, gpio_line_obstacle(errno));
  gpiod_line_settings_set_direction(line.get(), GPIOD_LINE_DIRECTION_INPUT);
  gpiod_line_settings_set_edge_detection(line.get(), edges_of(settings));
  gpiod_line_settings_set_bias(line.get(), bias_of(settings));
  gpiod_line_settings_set_event_clock(line.get(), GPIOD_LINE_CLOCK_MONOTONIC);
  gpiod_line_settings_set_active_low(line.get(), settings.polarity == GpioPolarity::active_low);
  auto request = request_line(settings.address, *line);
  if (!request) return tl::unexpected(request.error());
  return std::make_unique<InputV2>(settings.address, *std::move(request));
}

Result<std::unique_ptr<GpioOutput>> GpioOutput::open(const GpioOutputSettings& settings) {
  const LineSettings line(gpiod_line_settings_new());
  if (!line) return not_to_be_had(settings.address, gpio_line_obstacle(errno));
  gpiod_line_settings_set_direction(line.get(), GPIOD_LINE_DIRECTION_OUTPUT);
  gpiod_line_settings_set_output_value(line.get(), GPIOD_LINE_VALUE_INACTIVE);
  gpiod_line_settings_set_active_low(line.get(), settings.polarity == GpioPolarity::active_low);
  auto request = request_line(settings.address, *line);
  if (!request) return tl::unexpected(request.error());
  return std::make_unique<OutputV2>(settings.address, *std::move(request));
}

Result<GpioChipInfo> read_gpio_chip(const std::string& path) {
  const Chip chip(gpiod_chip_open(path.c_str()));
  if (!chip) return bad_input(gpio_chip_obstacle(path, errno));
  const ChipInfo chip_info(gpiod_chip_get_info(chip.get()));
  if (!chip_info) return bad_input(gpio_chip_obstacle(path, errno));
  GpioChipInfo info{.name = gpiod_chip_info_get_name(chip_info.get()),
                    .label = gpiod_chip_info_get_label(chip_info.get()),
                    .lines = static_cast<unsigned>(gpiod_chip_info_get_num_lines(chip_info.get())),
                    .named_lines = {}};
  for (unsigned i = 0; i < info.lines; ++i) {
    const LineInfo line(gpiod_chip_get_line_info(chip.get(), i));
    const char* name = line ? gpiod_line_info_get_name(line.get()) : nullptr;
    if (name != nullptr) info.named_lines.push_back(fmt::format("{} {}", i, name));
  }
  return info;
}

}  // namespace gimbal
