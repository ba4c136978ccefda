#include "daemon/frame_drawer.hpp"

#include <algorithm>
#include <utility>

#include "drivers/clock/monotonic_now.hpp"

namespace gimbal {

bool FrameDrawer::has_room() const {
  if (in_flight_.empty()) return true;
  return in_flight_.size() < warper_->most_in_flight() &&
         !is_filled(in_flight_.back().drawing.mesh.border);
}

Result<void> FrameDrawer::begin(Drawing drawing) {
  const SensorTime begin = monotonic_now();
  in_flight_.push_back({std::move(drawing)});
  auto begun = hand_over();
  if (!begun) {
    begun = replace_warper(begun.error()).and_then([this] { return hand_over(); });
  }
  in_flight_.back().time = monotonic_now() - begin;
  return begun;
}

Result<DrawnFrame> FrameDrawer::finish() {
  const SensorTime begin = monotonic_now();
  auto drawn = finish_oldest();
  if (!drawn) {
    drawn = replace_warper(drawn.error()).and_then([this] { return finish_oldest(); });
  }
  if (!drawn) return drawn;
  has_drawn_ = true;
  drawn->time = in_flight_.front().time + (monotonic_now() - begin);
  in_flight_.pop_front();
  --handed_over_;
  return drawn;
}

Result<std::optional<DrawnFrame>> FrameDrawer::advance(Waiting& waiting,
                                                       std::chrono::nanoseconds patience) {
  if (has_room()) {
    auto next = waiting.pop_within(is_idle() ? patience : std::chrono::nanoseconds::zero());
    if (next) {
      if (auto begun = begin(*std::move(next)); !begun) return tl::unexpected(begun.error());
      return std::nullopt;
    }
    if (is_idle()) return std::nullopt;
  }
  auto drawn = finish();
  if (!drawn) return tl::unexpected(drawn.error());
  return *std::move(drawn);
}

/// All that the warper takes: another may take fewer at a time than the one that began them.
Result<void> FrameDrawer::hand_over() {
  while (handed_over_ < std::min(in_flight_.size(), warper_->most_in_flight())) {
    const Drawing& drawing = in_flight_[handed_over_].drawing;
    if (!is_filled(drawing.mesh.border)) {  // else it is drawn once those before it are finished
      if (auto begun = warper_->begin(drawing.frame, drawing.mesh); !begun) return begun;
    }
    ++handed_over_;
  }
  return {};
}

Result<DrawnFrame> FrameDrawer::finish_oldest() {
  if (auto begun = hand_over(); !begun) return tl::unexpected(begun.error());
  const Drawing& drawing = in_flight_.front().drawing;
  if (!is_filled(drawing.mesh.border)) {
    return warper_->finish().map([](VideoFrame picture) { return DrawnFrame{std::move(picture)}; });
  }
  return fill_.draw(*warper_, drawing.frame, drawing.mesh, drawing.neighbours)
      .map([](FilledPicture filled) {
        return DrawnFrame{std::move(filled.picture), filled.border_px};
      });
}

/// One that fails before it has drawn anything is not replaced.
Result<void> FrameDrawer::replace_warper(const Error& error) {
  if (!std::exchange(has_drawn_, false)) return tl::unexpected(error);
  auto other = replace_(std::move(warper_), error);
  if (!other) return tl::unexpected(other.error());
  warper_ = *std::move(other);
  handed_over_ = 0;
  return {};
}

}  // namespace gimbal
