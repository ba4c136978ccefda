#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "pipeline/path/camera_path.hpp"
#include "pipeline/path/horizon.hpp"
#include "pipeline/path/path_optimum.hpp"
#include "pipeline/path/rate_prediction.hpp"
#include "pipeline/path/zoom_plan.hpp"

namespace gimbal {

/// The steadiest path that the frames leave room for, planned anew for each frame over all of the
/// future that the latency allows and, where that is short, over what the hand is expected to do
/// next (receding horizon; Rawlings, Mayne, Diehl, "Model Predictive Control", 2017). Of each plan
/// the first view is kept: any latency is the same code, with another horizon.
///
/// A view gives way before its frame ends, it does not overshoot where a pan ends, and it stands
/// still while the hand means to.
class BoundedPath final : public CameraPath {
 public:
  BoundedPath(const BoundedPathParameters& parameters, ZoomChoice zoom, PathLatency latency);

  void push(PathFrame frame) override;
  void finish() override;
  [[nodiscard]] std::optional<SteadyView> pop() override;

 private:
  /// A path that has been decided on so far, and how it was meant to go on.
  struct Track {
    std::array<FramePose, 3> last;  ///< oldest first
    std::vector<Eigen::Quaterniond> planned;
  };

  /// What a plan starts from: the frames from the next view's on, as turns from the first one's
  /// camera, those that are known before those that are guessed.
  struct Outlook {
    std::vector<PathTarget> targets;
    std::size_t known = 0;
  };

  void learn_from(const FramePose& before, const FramePose& now);
  [[nodiscard]] bool is_enough_held() const;
  void release_next();
  [[nodiscard]] double horizon_s() const;
  [[nodiscard]] FramePose aim_of(const FramePose& real) const;
  [[nodiscard]] Outlook look_ahead() const;
  void mark_ranges(Outlook& outlook) const;
  void guess_further(Outlook& outlook) const;
  void furnish(Outlook& outlook, const std::vector<double>& zooms) const;
  [[nodiscard]] std::vector<double> plan_zooms(const Outlook& outlook);
  void follow(const PathCost& cost, const Outlook& outlook, Track& track);
  static void shift(Track& track, const Eigen::Quaterniond& q_world_last);
  void start_tracks();

  double amount_;
  HorizonLock lock_;
  ZoomPlan zoom_;
  PathLatency latency_;
  double interval_s_ = 0;  ///< typical, from frame to frame

  std::deque<PathFrame> held_;      ///< frames whose views are still to come
  std::deque<double> least_zooms_;  ///< of the held frames, that their own camera's view needs
  std::deque<FramePose> behind_;    ///< the camera at the last ones that came
  RatePrediction prediction_;
  PathOptimum optimum_;
  std::optional<Track> bounded_;
  std::optional<Track> unbounded_;  ///< as if frames had no end: tells the zoom that is wanted
  std::deque<SteadyView> ready_;
};

}  // namespace gimbal
