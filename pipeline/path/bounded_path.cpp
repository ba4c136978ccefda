#include "pipeline/path/bounded_path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "pipeline/path/turn.hpp"
#include "pipeline/path/view_fit.hpp"
#include "pipeline/sample/smooth_step.hpp"

namespace gimbal {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kUsualInterval_s = 1 / 30.0;

/// No view depends on frames further ahead than that, whatever the latency.
constexpr double kLongestHorizon_s = 4;

// Turns are measured as rotation vectors from the next view's camera, which are no good near half a
// turn: what lies beyond an about-turn is not looked at yet.
constexpr double kFarthestTurn_rad = 2;

// Of the smoothing time T: a path that knows little of the future must be ready to give way.
constexpr double kLeastSmoothing_s = 0.17;
constexpr double kSmoothingPerHorizon = 0.5;
constexpr double kMostSmoothing_s = 1;

// How far ahead frames are guessed where they are not known.
constexpr double kLongestGuess_s = 0.67;
constexpr double kGuessOfNothing_s = 0.75;
constexpr double kLessGuessPerHorizon = 0.45;
constexpr double kGuessConfidence = 0.3;
constexpr double kConfidenceFades_s = 0.25;

/// From half of the room on a view is pulled back gently, at the frame's edge for good. The edge
/// gives a little, so that a stiff path's plan does not turn on a frame: what is too much is taken
/// off. It does not give much, or what is taken off would be seen as kinks.
constexpr PathWall kSoftWall = {0.5, 10};
constexpr PathWall kHardWall = {1, 3e5};
constexpr PathWall kLastWall = {1.06, 3e7};

// The stretch around a frame whose turns its view keeps to, and by how much it may exceed them.
// Before and after it are a pair of steps, which a view must be able to stand through.
constexpr double kRange_s = 0.55;
constexpr double kOvershoot_rad = 0.75 * std::numbers::pi / 180;
constexpr double kOvershootWeight_per_s3 = 8e5;

// A camera that stays within this share of its room for as long is meant to stand: its view then
// hardly follows.
constexpr double kStandingShare = 0.6;
constexpr double kLeastPull = 0.02;

/// A zoom is chosen so that a path without walls would use this much of the room: walls take off
/// what is beyond so gently that a larger zoom would not pay.
constexpr double kSmoothingWithoutWalls_s = 0.5;
constexpr double kWantedUse = 1.3;

/// A horizon that is kept whatever happens has to fit as it is.
constexpr double kUseOfHardLock = 0.9;

// Pulls the view's roll to the horizon, more than anything else, while a turn to it leaves some of
// the room; where it does not, it is drawn there as it is to any other aim.
constexpr double kHoldLevel = 1e7;
constexpr double kUseOfTurnToLevel = 0.9;
constexpr double kStretchOfLettingGo = 0.3;
constexpr double kStretchAtRange = 0.1;

/// A room that the zoom does not give is measured against this one.
constexpr double kLeastNominalRoom = 0.005;

/// The turn over such a stretch tells the camera's pace; that over less of it says more of its
/// shake, and counts for less.
constexpr double kLeastPaceStretch_s = 0.5;
constexpr double kMostPaceStretch_s = 1;

/// Weighs new intervals between frames against those before.
constexpr double kIntervalShare = 0.05;

/// Where so many frames are missing, nothing is learned of the hand.
constexpr double kGapIntervals = 5;

double time_of(const FramePose& pose) {
  return seconds_since_epoch(pose.stamp.time);
}

PathPoint point_of(const FramePose& pose, const FramePose& origin) {
  return {to_seconds(pose.stamp.time - origin.stamp.time),
          world_turn(origin.q_world_camera, pose.q_world_camera)};
}

/// What rolls beyond the lock is not level anyway, and is not held.
double held_in_range(const Quaterniond& q_world_camera, double most_roll_rad) {
  const double left = 1 - std::abs(roll_rad(q_world_camera)) / most_roll_rad;
  return smooth_step(left / kStretchAtRange);
}

/// The zoom at which a turn `d` away from the real camera, in its axes, uses as much of the room as
/// is wanted.
double wanted_zoom(const ViewRoom& room, const Vector3d& d, double wanted_use) {
  const ViewRoom::Limits left = room.side - room.shift_per_rad * d / wanted_use;
  double zoom = 1;
  for (Eigen::Index i = 0; i < left.size(); ++i) {
    zoom = left[i] > 0 ? std::max(zoom, room.corner[i] / left[i])
                       : std::numeric_limits<double>::infinity();
    if (!std::isfinite(zoom)) break;
  }
  return zoom;
}

/// How firmly the horizon can be held: 1 where the turn to it leaves room, 0 where it does not.
double held_level(const PathTarget& target) {
  const Vector3d to_level = target.aim.turn_rad - target.real_turn_rad;
  const double use = (target.use_per_rad * to_level).maxCoeff();
  return smooth_step((1 - use / kUseOfTurnToLevel) / kStretchOfLettingGo);
}

}  // namespace

BoundedPath::BoundedPath(const BoundedPathParameters& parameters, ZoomChoice zoom,
                         PathLatency latency)
    : amount_(std::clamp(parameters.amount, 0.0, 1.0)),
      lock_(parameters.lock),
      zoom_(zoom),
      latency_(latency) {}

void BoundedPath::push(PathFrame frame) {
  if (!held_.empty() || !behind_.empty()) {
    const FramePose& before = held_.empty() ? behind_.back() : held_.back().real;
    learn_from(before, frame.real);
  }
  least_zooms_.push_back(
      zoom_.is_fixed() ? 1 : needed_zoom(frame.required_zoom, frame.real.q_world_camera));
  held_.push_back(std::move(frame));
  // At once, not in `pop`: what is pushed later must not matter.
  while (is_enough_held()) release_next();
}

void BoundedPath::learn_from(const FramePose& before, const FramePose& now) {
  const double interval_s = to_seconds(now.stamp.time - before.stamp.time);
  const bool is_gap = interval_s_ > 0 && interval_s > kGapIntervals * interval_s_;
  if (interval_s <= 0 || is_gap) return;
  prediction_.push(world_turn(before.q_world_camera, now.q_world_camera) / interval_s, interval_s);
  const double share = interval_s_ > 0 ? kIntervalShare : 1;
  interval_s_ += share * (interval_s - interval_s_);
}

bool BoundedPath::is_enough_held() const {
  if (held_.empty()) return false;
  if (latency_) return held_.size() > *latency_;
  return time_of(held_.back().real) - time_of(held_.front().real) >= kLongestHorizon_s;
}

void BoundedPath::finish() {
  while (!held_.empty()) release_next();
}

std::optional<SteadyView> BoundedPath::pop() {
  if (ready_.empty()) return std::nullopt;
  SteadyView view = ready_.front();
  ready_.pop_front();
  return view;
}

/// Not what is held at the moment, which grows less at the end.
double BoundedPath::horizon_s() const {
  if (!latency_) return kLongestHorizon_s;
  return std::min(kLongestHorizon_s, static_cast<double>(*latency_) * interval_s_);
}

void BoundedPath::release_next() {
  if (!bounded_) start_tracks();
  Outlook outlook = look_ahead();
  mark_ranges(outlook);
  guess_further(outlook);
  const std::vector<double> zooms = plan_zooms(outlook);
  furnish(outlook, zooms);

  PathCost cost;
  cost.smoothing_s = amount_ * std::clamp(kLeastSmoothing_s + kSmoothingPerHorizon * horizon_s(),
                                          kLeastSmoothing_s, kMostSmoothing_s);
  cost.walls = {PathWall{kSoftWall.at, amount_ * kSoftWall.weight}, kHardWall, kLastWall};
  // Stiff paths take more to be held.
  cost.overshoot_weight = kOvershootWeight_per_s3 * std::pow(cost.smoothing_s, 3);
  follow(cost, outlook, *bounded_);

  const PathFrame& frame = held_.front();
  const FramePose& view = bounded_->last.back();
  const Quaterniond& real = frame.real.q_world_camera;
  const double share = fitting_share(frame.required_zoom, real, view.q_world_camera, zooms[0]);
  if (share > 0 && share < 1) shift(*bounded_, real.slerp(share, view.q_world_camera));
  ready_.push_back({view, zooms[0]});

  behind_.push_back(frame.real);
  held_.pop_front();
  least_zooms_.pop_front();
  while (time_of(behind_.back()) - time_of(behind_.front()) > kRange_s) behind_.pop_front();
}

/// As if the view had come along with the camera, as far as it is known where that goes.
void BoundedPath::start_tracks() {
  const FramePose first = aim_of(held_.front().real);
  const double stretch_s = std::clamp(horizon_s(), kLeastPaceStretch_s, kMostPaceStretch_s);
  Vector3d rate_rad_s = Vector3d::Zero();
  for (const PathFrame& frame : held_) {
    const PathPoint ahead = point_of(aim_of(frame.real), first);
    if (ahead.time_s > stretch_s) break;
    rate_rad_s = ahead.turn_rad / stretch_s;
  }
  Track track;
  const double interval_s = interval_s_ > 0 ? interval_s_ : kUsualInterval_s;
  for (std::size_t i = 0; i < track.last.size(); ++i) {
    const double before_s = static_cast<double>(track.last.size() - i) * interval_s;
    track.last[i] = {first.stamp, turned(first.q_world_camera, -before_s * rate_rad_s)};
    track.last[i].stamp.time -= duration_from_seconds(before_s);
  }
  bounded_ = track;
  unbounded_ = track;
}

FramePose BoundedPath::aim_of(const FramePose& real) const {
  if (lock_.horizon == Horizon::off) return real;
  return {real.stamp, levelled(real.q_world_camera, lock_.most_roll_rad)};
}

BoundedPath::Outlook BoundedPath::look_ahead() const {
  Outlook outlook;
  const FramePose& origin = held_.front().real;
  for (const PathFrame& frame : held_) {
    PathTarget target;
    const PathPoint real = point_of(frame.real, origin);
    if (real.time_s > kLongestHorizon_s || real.turn_rad.norm() > kFarthestTurn_rad) break;
    target.real_turn_rad = real.turn_rad;
    const FramePose aim = aim_of(frame.real);
    target.aim = point_of(aim, origin);
    if (lock_.horizon == Horizon::hard) {
      target.axis = roll_per_turn(aim.q_world_camera);
      target.axis_pull = kHoldLevel * held_in_range(frame.real.q_world_camera, lock_.most_roll_rad);
    }
    outlook.targets.push_back(target);
  }
  outlook.known = outlook.targets.size();
  return outlook;
}

/// Where the camera comes to around each frame, and how much it means to stand there.
void BoundedPath::mark_ranges(Outlook& outlook) const {
  std::vector<PathPoint> points;
  for (const FramePose& pose : behind_) {
    points.push_back(point_of(aim_of(pose), held_.front().real));
  }
  for (const PathTarget& target : outlook.targets) points.push_back(target.aim);
  auto first = points.begin();
  for (std::size_t i = 0; i < outlook.known; ++i) {
    PathTarget& target = outlook.targets[i];
    while (first->time_s < target.aim.time_s - kRange_s) ++first;
    Vector3d least = target.aim.turn_rad;
    Vector3d most = least;
    for (auto p = first; p != points.end() && p->time_s <= target.aim.time_s + kRange_s; ++p) {
      least = least.cwiseMin(p->turn_rad);
      most = most.cwiseMax(p->turn_rad);
    }
    target.least_rad = least.array() - kOvershoot_rad;
    target.most_rad = most.array() + kOvershoot_rad;
  }
}

void BoundedPath::guess_further(Outlook& outlook) const {
  if (outlook.known < held_.size()) return;  // beyond an about-turn
  const double interval_s = interval_s_ > 0 ? interval_s_ : kUsualInterval_s;
  const double guess_s =
      std::clamp(kGuessOfNothing_s - kLessGuessPerHorizon * horizon_s(), 0.0, kLongestGuess_s);
  const auto count = static_cast<std::size_t>(std::lround(guess_s / interval_s));
  const Vector3d forward = held_[outlook.known - 1].real.q_world_camera * Vector3d::UnitZ();
  const double known_until_s = outlook.targets.back().aim.time_s;
  for (const Vector3d& rate_rad_s : prediction_.next(count, interval_s)) {
    PathTarget target = outlook.targets.back();
    target.aim.time_s += interval_s;
    const Vector3d turn_rad = interval_s * rate_rad_s;
    target.real_turn_rad += turn_rad;
    // What rolls is not aimed at where the horizon is kept.
    target.aim.turn_rad += turn_rad;
    if (lock_.horizon != Horizon::off) {
      target.aim.turn_rad -= turn_rad.dot(forward) * forward;
    }
    target.least_rad = target.least_rad.cwiseMin(target.aim.turn_rad);
    target.most_rad = target.most_rad.cwiseMax(target.aim.turn_rad);
    target.confidence =
        kGuessConfidence * std::exp((known_until_s - target.aim.time_s) / kConfidenceFades_s);
    outlook.targets.push_back(target);
  }
}

std::vector<double> BoundedPath::plan_zooms(const Outlook& outlook) {
  std::vector<ZoomNeed> needs;
  for (std::size_t i = 0; i < outlook.known; ++i) {
    needs.push_back({seconds_since_epoch(held_[i].real.stamp.time), 1});
  }
  if (zoom_.is_fixed()) return zoom_.plan(needs);
  PathCost cost;
  cost.smoothing_s = amount_ * kSmoothingWithoutWalls_s;
  follow(cost, outlook, *unbounded_);
  const double wanted_use = lock_.horizon == Horizon::hard ? kUseOfHardLock : kWantedUse;
  for (std::size_t i = 0; i < outlook.known; ++i) {
    const Quaterniond& real = held_[i].real.q_world_camera;
    const Quaterniond& view = unbounded_->planned[i];
    needs[i].zoom =
        std::max(least_zooms_[i],
                 wanted_zoom(held_[i].room, real.conjugate() * world_turn(real, view), wanted_use));
  }
  return zoom_.plan(needs);
}

/// Puts up the walls that each frame has at its zoom. Guessed frames have those of the last known
/// one.
void BoundedPath::furnish(Outlook& outlook, const std::vector<double>& zooms) const {
  for (std::size_t i = 0; i < outlook.targets.size(); ++i) {
    PathTarget& target = outlook.targets[i];
    const std::size_t known = std::min(i, outlook.known - 1);
    const PathFrame& frame = held_[known];
    const double nominal =
        std::max(1 - frame.room.corner.maxCoeff() / zooms[known], kLeastNominalRoom);
    if (i < outlook.known) target.use = 1 - frame.room.at_zoom(zooms[known]).array() / nominal;
    target.use_per_rad = frame.room.shift_per_rad / nominal *
                         frame.real.q_world_camera.conjugate().toRotationMatrix();
    target.axis_pull *= held_level(target);
    const double use_per_rad = target.use_per_rad.norm() / std::sqrt(ViewRoom::kLimits);
    const double moved = (target.most_rad - target.least_rad).maxCoeff() - 2 * kOvershoot_rad;
    const double share = moved * use_per_rad / kStandingShare;
    target.pull = std::clamp(share * share * share * share, kLeastPull, 1.0);
  }
}

/// What the frame's edge takes from a view is taken from those before it alike: what goes on is the
/// pace that was planned, and not the jerk of giving way, which a stiff plan would swing with.
void BoundedPath::shift(Track& track, const Quaterniond& q_world_last) {
  const Quaterniond shift = q_world_last * track.last.back().q_world_camera.conjugate();
  for (FramePose& pose : track.last) pose.q_world_camera = shift * pose.q_world_camera;
}

/// Plans a track anew and goes one frame along.
void BoundedPath::follow(const PathCost& cost, const Outlook& outlook, Track& track) {
  const FramePose& origin = held_.front().real;
  std::array<PathPoint, 3> past;
  for (std::size_t i = 0; i < past.size(); ++i) past[i] = point_of(track.last[i], origin);
  std::vector<Vector3d> views;
  for (std::size_t i = 0; i < outlook.targets.size(); ++i) {
    if (i + 1 < track.planned.size()) {
      views.push_back(world_turn(origin.q_world_camera, track.planned[i + 1]));
    } else if (i >= 2) {
      views.emplace_back(2 * views[i - 1] - views[i - 2]);
    } else {
      views.push_back(outlook.targets[i].aim.turn_rad);
    }
  }
  optimum_.find(cost, past, outlook.targets, views);
  track.planned.clear();
  for (const Vector3d& view : views) track.planned.push_back(turned(origin.q_world_camera, view));
  std::rotate(track.last.begin(), track.last.begin() + 1, track.last.end());
  track.last.back() = {origin.stamp, track.planned.front()};
}

}  // namespace gimbal
