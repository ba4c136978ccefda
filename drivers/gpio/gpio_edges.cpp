#include "drivers/gpio/gpio_edges.hpp"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <ctime>
#include <deque>
#include <utility>

#include "drivers/clock/monotonic_now.hpp"
#include "drivers/stop_event.hpp"

namespace gimbal {
namespace {

class GpioEdgeSource final : public EdgeSource {
 public:
  GpioEdgeSource(GpioInputSettings settings, GpioInputOpener opener)
      : settings_(std::move(settings)), opener_(std::move(opener)) {}

  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] Result<std::optional<Edge>> read_until(SensorTime deadline) override;
  void stop() override { stop_.set(); }
  [[nodiscard]] std::uint64_t lost() const override { return lost_; }

 private:
  [[nodiscard]] bool wait_until(SensorTime deadline) const;
  [[nodiscard]] Result<void> take_edges();
  [[nodiscard]] Result<void> check_clock(SensorTime stamp, SensorTime arrival) const;
  void count_lost(const KernelEdge& edge);

  GpioInputSettings settings_;
  GpioInputOpener opener_;
  StopEvent stop_;
  std::unique_ptr<GpioInput> input_;
  SensorTime requested_;   ///< no edge is older
  SensorTime last_stamp_;  ///< that was handed on
  std::deque<Edge> edges_;
  std::uint32_t last_sequence_ = 0;  ///< the kernel's; it counts from 1 at each request
  std::uint64_t sequence_ = 0;
  std::uint64_t lost_ = 0;
};

Result<void> GpioEdgeSource::start() {
  stop_.clear();
  input_.reset();
  requested_ = last_stamp_ = monotonic_now();
  auto input = opener_(settings_);
  if (!input) return tl::unexpected(input.error());
  input_ = *std::move(input);
  edges_.clear();
  last_sequence_ = 0;
  sequence_ = lost_ = 0;
  return {};
}

Result<std::optional<Edge>> GpioEdgeSource::read_until(SensorTime deadline) {
  const std::optional<Edge> nothing;
  if (!input_)
    return failed(fmt::format("gpio {}: read before start", to_string(settings_.address)));
  while (edges_.empty()) {
    if (!wait_until(deadline)) return nothing;
    if (auto taken = take_edges(); !taken) return tl::unexpected(taken.error());
  }
  if (stop_.is_set()) return nothing;
  const Edge edge = edges_.front();
  edges_.pop_front();
  return edge;
}

/// False when it was stopped or the deadline is over without an edge.
bool GpioEdgeSource::wait_until(SensorTime deadline) const {
  const SensorDuration left = std::max(deadline - monotonic_now(), SensorDuration::zero());
  const auto whole = std::chrono::duration_cast<std::chrono::seconds>(left);
  const timespec timeout{.tv_sec = whole.count(), .tv_nsec = (left - whole).count()};
  std::array<pollfd, 2> waiting{pollfd{.fd = stop_.fd(), .events = POLLIN, .revents = 0},
                                pollfd{.fd = input_->fd(), .events = POLLIN, .revents = 0}};
  ppoll(waiting.data(), waiting.size(), &timeout, nullptr);
  return waiting[0].revents == 0 && waiting[1].revents != 0;
}

Result<void> GpioEdgeSource::take_edges() {
  const auto edges = input_->read();
  if (!edges) return tl::unexpected(edges.error());
  const SensorTime arrival = monotonic_now();
  for (const KernelEdge& edge : *edges) {
    if (auto checked = check_clock(edge.stamp, arrival); !checked) return checked;
    count_lost(edge);
    if (edge.stamp <= last_stamp_) {
      ++lost_;
      continue;
    }
    last_stamp_ = edge.stamp;
    edges_.push_back({edge.stamp, settings_.address.line, edge.direction, sequence_});
  }
  return {};
}

/// However late it is read, an edge came after the line was requested and before it was read; by
/// CLOCK_REALTIME it would have come decades later.
Result<void> GpioEdgeSource::check_clock(SensorTime stamp, SensorTime arrival) const {
  if (requested_ <= stamp && stamp <= arrival) return {};
  return failed(
      fmt::format("gpio {}: its stamps are {:.3f} s off CLOCK_MONOTONIC; edges want Linux "
                  "5.7 or later",
                  to_string(settings_.address), to_seconds(stamp - arrival)));
}

void GpioEdgeSource::count_lost(const KernelEdge& edge) {
  const std::uint32_t step = edge.sequence ? *edge.sequence - last_sequence_ : 1;  // wraps around
  last_sequence_ += step;
  sequence_ += step;
  lost_ += step - 1;
}

}  // namespace

std::unique_ptr<EdgeSource> open_gpio_edges(const GpioInputSettings& settings) {
  return open_gpio_edges(settings, GpioInput::open);
}

std::unique_ptr<EdgeSource> open_gpio_edges(const GpioInputSettings& settings,
                                            GpioInputOpener opener) {
  return std::make_unique<GpioEdgeSource>(settings, std::move(opener));
}

}  // namespace gimbal
