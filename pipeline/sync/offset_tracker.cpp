#include "pipeline/sync/offset_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pipeline/sync/median.hpp"
#include "pipeline/sync/offset_search.hpp"

namespace gimbal {
namespace {

constexpr double kUnknownSigma_s = 0.1;
constexpr double kFoundSigma_s = 0.004;  // of what a search finds
constexpr double kKnownSigma_s = 0.003;
constexpr double kMostSigma_s = 0.01;  // before the offset is looked for anew
constexpr int kDisagreeingPairs = 6;   // more of these than of others, too
constexpr std::size_t kKeptPairs = 6;  // to begin that with
constexpr double kSearchedSpan_s = 8;
constexpr std::size_t kSearchedPairs = 12;  // so many are kept for longer, where bursts are rare
constexpr double kLongestSpan_s = 30;       // in which a clock drifts by what a search blurs
constexpr int kSearchRounds = 3;            // each sees rows where the one before found them
constexpr double kOutlier = 4;              // in medians
constexpr double kAgreeingShare = 0.6;
constexpr double kMargin_s = 0.05;  // of the gyroscope's log, beside the frames
constexpr double kMotionSpan_s = 0.5;
constexpr double kLeastRateChange_rad_s = 0.02;  // rms, from a burst's begin to its end

/// Precondition: there is one.
double median_miss_rad(const std::vector<TurnMiss>& turns) {
  std::vector<double> misses_rad;
  for (const TurnMiss& turn : turns) misses_rad.push_back(turn.miss_rad.norm());
  return median(std::move(misses_rad));
}

}  // namespace

Result<OffsetTracker> OffsetTracker::create(const CameraCalibration& camera,
                                            const ImuCalibration& imu) {
  auto maker = SightingMaker::create(camera, 1, SensorTime());
  if (!maker) return tl::unexpected(maker.error());
  return OffsetTracker(camera, imu, *std::move(maker));
}

OffsetTracker::OffsetTracker(const CameraCalibration& camera, const ImuCalibration& imu,
                             SightingMaker maker)
    : readout_s_(to_seconds(camera.readout)),
      R_camera_imu_(imu.R_camera_imu),
      maker_(std::move(maker)),
      filter_(to_seconds(camera.time_offset), kUnknownSigma_s) {}

void OffsetTracker::push(const GyroSample& sample) {
  if (!gyro_.empty() && sample.time <= gyro_.back().time) return;
  gyro_.push_back(sample);
  const SensorDuration kept = duration_from_seconds(kLongestSpan_s + 2 * kOffsetReach_s);
  while (gyro_.front().time < sample.time - kept) gyro_.pop_front();
}

std::optional<GyroIntegral> OffsetTracker::gyro_between(double from_s, double to_s,
                                                        const Eigen::Vector3d& bias_rad_s) const {
  const auto after = [&](double time_s) {
    return std::ranges::upper_bound(gyro_, time_from_seconds(time_s), {}, &GyroSample::time);
  };
  const auto begin = after(from_s);
  const auto end = after(to_s);
  const std::vector<GyroSample> samples(begin == gyro_.begin() ? begin : std::prev(begin),
                                        end == gyro_.end() ? end : std::next(end));
  if (samples.size() < 2) return std::nullopt;
  return GyroIntegral(samples, SensorTime(), bias_rad_s);
}

Worth OffsetTracker::worth_of(const FrameStamp& from, const FrameStamp& to) const {
  const double offset_s = filter_.offset_s();
  const double step_s = to_seconds(to.time - from.time);
  const double to_s = seconds_since_epoch(to.time) + offset_s;
  const double end_s = to_s + readout_s_ + kMargin_s;
  if (!(step_s > 0 && step_s < kMotionSpan_s)) return Worth::nothing;  // the clock has jumped
  if (gyro_.empty() || seconds_since_epoch(gyro_.back().time) < end_s) return Worth::unknown;
  const auto gyro = gyro_between(to_s - kMotionSpan_s, to_s, filter_.bias_rad_s());
  if (!gyro) return Worth::nothing;
  double sum_sq = 0;
  int count = 0;
  for (double time_s = to_s - kMotionSpan_s; time_s + step_s <= to_s; time_s += step_s) {
    const auto before = gyro->at(time_s);
    const auto after = gyro->at(time_s + step_s);
    if (!before || !after) continue;
    sum_sq += (after->rate_rad_s - before->rate_rad_s).squaredNorm();
    ++count;
  }
  const bool turns = sum_sq > count * kLeastRateChange_rad_s * kLeastRateChange_rad_s;
  return turns ? Worth::something : Worth::nothing;
}

void OffsetTracker::push(const FollowedBurst& burst) {
  const std::vector<SightingPair> pairs = make_pairs(maker_, burst.frames, burst.corners, {});
  for (auto begin = pairs.begin(), end = begin; begin != pairs.end(); begin = end) {
    end = std::find_if(begin, pairs.end(), [&](const SightingPair& pair) {
      return pair.from.frame != begin->from.frame;
    });
    push({seconds_since_epoch(burst.frames[begin->to.frame].time), {begin, end}});
  }
  if (!is_found_ && !recent_.empty()) look_for_offset();
}

void OffsetTracker::push(Seen seen) {
  recent_.push_back(std::move(seen));
  if (is_found_) {
    follow(recent_.back());
    while (recent_.size() > kKeptPairs) recent_.pop_front();
  }
  const auto is_too_old = [this](const Seen& one) {
    const double span_s = recent_.size() > kSearchedPairs ? kSearchedSpan_s : kLongestSpan_s;
    return one.time_s < recent_.back().time_s - span_s;
  };
  while (is_too_old(recent_.front())) recent_.pop_front();
}

std::optional<TurnMiss> OffsetTracker::miss_of(const Seen& seen, const OffsetFilter& filter) const {
  const double middle_s = seen.time_s + filter.offset_s();
  const auto gyro =
      gyro_between(middle_s - kMotionSpan_s, middle_s + kMotionSpan_s, filter.bias_rad_s());
  if (!gyro || !gyro->covers(seen.corners.front().from.stamp_s + filter.offset_s(),
                             seen.time_s + readout_s_ + filter.offset_s())) {
    return std::nullopt;
  }
  return turn_miss(seen.corners, {*gyro, R_camera_imu_, readout_s_, filter.offset_s()});
}

void OffsetTracker::follow(const Seen& seen) {
  filter_.predict(std::max(0.0, seen.time_s - *time_s_));
  time_s_ = seen.time_s;
  if (filter_.sigma_s() > kMostSigma_s) return lose();
  const auto miss = miss_of(seen, filter_);
  if (!miss) return;
  const bool agrees = filter_.update(*miss) == Verdict::agrees;
  disagreeing_ = std::max(0, disagreeing_ + (agrees ? -1 : 1));
  if (disagreeing_ >= kDisagreeingPairs || filter_.has_jumped()) lose();
}

void OffsetTracker::lose() {
  is_found_ = false;
  filter_.restart(filter_.offset_s(), kUnknownSigma_s);
}

void OffsetTracker::look_for_offset() {
  const double begin_s = recent_.front().time_s + filter_.offset_s() - 2 * kOffsetReach_s;
  const auto gyro =
      gyro_between(begin_s, seconds_since_epoch(gyro_.back().time), filter_.bias_rad_s());
  if (!gyro) return;
  auto offset_s = find_offset(turns_seen(filter_), *gyro, R_camera_imu_, filter_.offset_s());
  if (!offset_s) return;
  OffsetFilter filter = filter_;
  // Of the drift it knows as little as of any after such a time; the offset is that of now.
  if (time_s_) filter.predict(std::max(0.0, recent_.front().time_s - *time_s_));
  for (int round = 0; round < kSearchRounds; ++round) {
    filter.restart(*offset_s, kFoundSigma_s);
    *offset_s = improve_offset(turns_seen(filter), *gyro, R_camera_imu_, *offset_s);
  }
  filter.restart(*offset_s, kFoundSigma_s);
  if (!learns_from_recent(filter)) return;
  filter_ = filter;
  time_s_ = recent_.back().time_s;
  is_found_ = true;
  disagreeing_ = 0;
}

std::vector<TurnMiss> OffsetTracker::turns_seen(const OffsetFilter& filter) const {
  std::vector<TurnMiss> turns;
  for (const Seen& pair : recent_) {
    if (const auto miss = miss_of(pair, filter)) turns.push_back(*miss);
  }
  return turns;
}

/// Whether most of what was seen lately agrees with the filter, which learns from that.
bool OffsetTracker::learns_from_recent(OffsetFilter& filter) const {
  const std::vector<TurnMiss> turns = turns_seen(filter);
  if (turns.empty()) return false;
  const double usual_rad = median_miss_rad(turns);
  double time_s = recent_.front().time_s;
  std::size_t agreeing = 0;
  for (const Seen& seen : recent_) {
    filter.predict(std::max(0.0, seen.time_s - std::exchange(time_s, seen.time_s)));
    const auto miss = miss_of(seen, filter);
    // One from before a jump, in its turn, would lead all that follow astray.
    if (!miss || miss->miss_rad.norm() > kOutlier * usual_rad) continue;
    if (filter.update(*miss) == Verdict::agrees) ++agreeing;
  }
  return static_cast<double>(agreeing) > kAgreeingShare * static_cast<double>(recent_.size());
}

OffsetEstimate OffsetTracker::estimate_at(SensorTime time) const {
  OffsetFilter filter = filter_;
  if (is_found_) filter.predict(std::max(0.0, seconds_since_epoch(time) - *time_s_));
  return {duration_from_seconds(filter.offset_s()), duration_from_seconds(filter.sigma_s()),
          filter.drift(), is_found_ && filter.sigma_s() < kKnownSigma_s};
}

}  // namespace gimbal
