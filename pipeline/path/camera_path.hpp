#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>

#include "pipeline/path/horizon.hpp"
#include "pipeline/path/pan_detector.hpp"
#include "pipeline/sample/video_frame.hpp"
#include "pipeline/sample/view_room.hpp"

namespace gimbal {

/// The real camera at a frame's reference row.
struct FramePose {
  FrameStamp stamp;
  Eigen::Quaterniond q_world_camera;
};

/// The zoom at which a view in the given direction, q_world_camera, shows no border; infinite if
/// none does.
using RequiredZoom = std::function<double(const Eigen::Quaterniond&)>;

/// A frame as a path sees it: where the real camera looks, and how far a view may turn away from
/// it, to first order and exactly.
struct PathFrame {
  FramePose real;
  ViewRoom room;
  RequiredZoom required_zoom;
};

/// The virtual camera for a frame.
struct SteadyView {
  FramePose steady;
  double zoom = 1;
};

/// How fast a zoom that follows the need grows, of the picture's size a second. Faster is seen as
/// such, slower comes too late.
constexpr double kUsualZoomSpeed_per_s = 0.08;

/// Either a zoom for all frames, or as little as is needed between two limits.
struct ZoomChoice {
  double least = 1;
  double most = 1;
  /// It grows so fast at most, and shrinks a quarter as fast; only the bounded path's zoom moves
  /// both ways.
  double speed_per_s = kUsualZoomSpeed_per_s;
};

/// From the real camera to the virtual one, frame by frame. With a latency of k frames the view of
/// frame i comes out once frame i+k went in, and depends on nothing later; with no latency given,
/// the path takes as much of the future as it can use.
class CameraPath {
 public:
  CameraPath() = default;
  CameraPath(const CameraPath&) = delete;
  CameraPath& operator=(const CameraPath&) = delete;
  virtual ~CameraPath() = default;

  /// Stamps rise strictly.
  virtual void push(PathFrame frame) = 0;

  /// No more frames come: what is held is released by `pop`.
  virtual void finish() = 0;

  /// The next view, in order, once enough of the future is known.
  [[nodiscard]] virtual std::optional<SteadyView> pop() = 0;
};

/// Frames of future that a path may use; none means all that it can use.
using PathLatency = std::optional<std::size_t>;

/// The thesis' low-pass (2.33, 2.34): Hann window of `window` frames, odd; 1 leaves poses as they
/// are. What does not fit its frame is turned back (ViewLimiter).
[[nodiscard]] std::unique_ptr<CameraPath> make_hann_path(int window, ZoomChoice zoom,
                                                         PathLatency latency);

struct AdaptiveHannParameters {
  int wide_window = 99;    ///< frames, odd, while the camera is held (2.3.3)
  int narrow_window = 29;  ///< frames, odd, in a fast pan
  PanDetectorParameters pan;
};

/// The thesis' adaptive low-pass: a CUSUM test on the orientation change slides the window between
/// the wide and the narrow one.
[[nodiscard]] std::unique_ptr<CameraPath> make_adaptive_hann_path(
    const AdaptiveHannParameters& parameters, ZoomChoice zoom, PathLatency latency);

struct BoundedPathParameters {
  double amount = 1;  ///< from 0, which leaves poses as they are, to 1
  HorizonLock lock;
};

/// The steadiest path that the frames leave room for (BoundedPath).
[[nodiscard]] std::unique_ptr<CameraPath> make_bounded_path(const BoundedPathParameters& parameters,
                                                            ZoomChoice zoom, PathLatency latency);

/// The frame rate that the thesis' windows are for. What matters to the eye is how long a window
/// lasts, so for other rates they are scaled.
constexpr double kThesisFps = 30;

/// The window (odd) for an amount of stabilization from 0 (none) to 1 (the thesis' 99 frames at 30
/// fps), in proportion. `fps` must be positive.
[[nodiscard]] int window_for_amount(double amount, double fps = kThesisFps);

/// The same for both windows of the adaptive low-pass.
[[nodiscard]] AdaptiveHannParameters adaptive_hann_for_amount(double amount,
                                                              double fps = kThesisFps);

}  // namespace gimbal
