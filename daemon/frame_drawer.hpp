#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "pipeline/fill/border_fill.hpp"
#include "pipeline/queue/bounded_queue.hpp"
#include "pipeline/sample/result.hpp"
#include "pipeline/sample/sensor_time.hpp"
#include "pipeline/sample/video_frame.hpp"
#include "pipeline/warp/warp_mesh.hpp"
#include "pipeline/warp/warper.hpp"

namespace gimbal {

/// A frame and the way it is to be drawn.
struct Drawing {
  VideoFrame frame;
  WarpMesh mesh;
  std::vector<Neighbour> neighbours;  ///< for border fill
};

struct DrawnFrame {
  VideoFrame picture;
  std::int64_t filled_border_px = 0;  ///< pixels without a source, where the border is filled
  SensorDuration time{};              ///< that the caller spent on it
};

/// Draws frames in the order in which they come, as many at a time as the warper can, and one whose
/// border is filled alone. Where the warper fails, another takes its place and draws again what is
/// not finished.
class FrameDrawer {
 public:
  /// What draws instead of the warper that failed so, which comes along to be closed; the error if
  /// there is nothing.
  using Replace = std::function<Result<std::unique_ptr<Warper>>(std::unique_ptr<Warper> failed,
                                                                const Error& error)>;
  using Waiting = BoundedQueue<Drawing, WhenFull::drop_oldest>;

  FrameDrawer(std::unique_ptr<Warper> warper, Replace replace)
      : warper_(std::move(warper)), replace_(std::move(replace)) {}

  /// Whether another frame may be begun.
  [[nodiscard]] bool has_room() const;

  /// Whether none is in flight.
  [[nodiscard]] bool is_idle() const { return in_flight_.empty(); }

  /// Wants room. Fails, for good, where no warper draws.
  [[nodiscard]] Result<void> begin(Drawing drawing);

  /// The frame that has been in flight for the longest time; wants one. Fails as `begin` does.
  [[nodiscard]] Result<DrawnFrame> finish();

  /// One step of drawing what waits: begins the next while there is room, else, and where nothing
  /// waits, finishes the oldest and gives its picture. While nothing is in flight it waits for that
  /// long.
  [[nodiscard]] Result<std::optional<DrawnFrame>> advance(Waiting& waiting,
                                                          std::chrono::nanoseconds patience);

  /// Not to be drawn with.
  [[nodiscard]] Warper& warper() const { return *warper_; }

  /// Of all frames so far, beside what the warper copies.
  [[nodiscard]] std::int64_t bytes_copied() const { return fill_.bytes_copied(); }

 private:
  struct InFlight {
    Drawing drawing;
    SensorDuration time{};
  };

  [[nodiscard]] Result<void> hand_over();
  [[nodiscard]] Result<DrawnFrame> finish_oldest();
  [[nodiscard]] Result<void> replace_warper(const Error& error);

  std::unique_ptr<Warper> warper_;
  Replace replace_;
  bool has_drawn_ = true;  ///< the warper, since it took another's place
  BorderFill fill_;
  std::deque<InFlight> in_flight_;
  std::size_t handed_over_ = 0;  ///< of these
};

}  // namespace gimbal
