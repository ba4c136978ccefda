#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <utility>

#include "drivers/edge_source.hpp"

namespace gimbal {

/// Tells a press from the bouncing of its contact: the level must have been steady for the period.
class Debouncer {
 public:
  explicit Debouncer(SensorDuration period) : period_(period) {}

  /// Rising: pressed. In order of time.
  void take(const Edge& edge);

  /// The instant of a press that has proved steady by `now`; each is told once.
  [[nodiscard]] std::optional<SensorTime> press(SensorTime now);

  /// When to ask again, if something is unsettled.
  [[nodiscard]] std::optional<SensorTime> settles_at() const;

 private:
  SensorDuration period_;
  EdgeDirection steady_ = EdgeDirection::falling;
  EdgeDirection latest_ = EdgeDirection::falling;
  SensorTime changed_;  ///< when the latest level came
};

/// A button on a line that is active when pressed.
class Button {
 public:
  explicit Button(std::unique_ptr<EdgeSource> edges,
                  SensorDuration debounce = std::chrono::milliseconds(20))
      : edges_(std::move(edges)), debouncer_(debounce) {}

  [[nodiscard]] Result<void> start() { return edges_->start(); }

  /// Waits for a press until the deadline; nothing if none came, or after `stop`.
  [[nodiscard]] Result<std::optional<SensorTime>> wait_for_press(SensorTime deadline);

  /// From any thread.
  void stop() { edges_->stop(); }

 private:
  std::unique_ptr<EdgeSource> edges_;
  Debouncer debouncer_;
};

}  // namespace gimbal
