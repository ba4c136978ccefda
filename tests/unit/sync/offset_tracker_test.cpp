// Tracks whose truth is known, a few pairs of frames a second, from a camera whose clock drifts or
// jumps.

#include "pipeline/sync/offset_tracker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "tests/support/synthetic_tracks.hpp"

namespace gimbal {
namespace {

using std::chrono::milliseconds;
using test::camera_720p;
using test::make_tracks;
using test::TrackScenario;

constexpr std::size_t kBurst = 4;        // frames
constexpr std::size_t kBurstEvery = 18;  // frames

/// What the camera's stamps lack beyond the calibration's offset, by true time.
using ClockError = std::function<double(double time_s)>;

/// Whether the tracker is shown what there is then: it is not where nothing turns.
using Shown = std::function<bool(double time_s)>;

bool always(double /*time_s*/) {
  return true;
}

struct Followed {
  double time_s = 0;
  double error_s = 0;  ///< of the offset
  double sigma_s = 0;
  bool is_known = false;
};

FollowedBurst burst_at(const JointData& data, std::size_t first) {
  const auto begin = data.frames.begin() + static_cast<std::ptrdiff_t>(first);
  FollowedBurst burst{{begin, begin + static_cast<std::ptrdiff_t>(kBurst)}, {}};
  for (const FeatureTrack& track : data.tracks) {
    FeatureTrack part;
    for (const TrackPoint& point : track) {
      if (point.frame >= first && point.frame < first + kBurst) {
        part.push_back({point.frame - first, point.px});
      }
    }
    if (part.size() > 1) burst.corners.push_back(part);
  }
  return burst;
}

JointData recorded_by(const TrackScenario& scenario, const ClockError& clock_error) {
  JointData data = make_tracks(scenario);
  for (std::size_t i = 0; i < data.frames.size(); ++i) {
    const double time_s = static_cast<double>(i) / scenario.camera.fps;
    data.frames[i].time -= duration_from_seconds(clock_error(time_s));
  }
  return data;
}

struct Following {
  Shown shown = always;
  std::optional<Eigen::Matrix3d> R_camera_imu_said = std::nullopt;  ///< the true one unless given
  std::size_t burst_every = kBurstEvery;
};

/// What a tracker says at the end of each burst.
std::vector<Followed> follow(const TrackScenario& scenario, const ClockError& clock_error,
                             const Following& following = {}) {
  const auto R_camera_imu_said = following.R_camera_imu_said.value_or(scenario.M_camera_imu);
  const JointData data = recorded_by(scenario, clock_error);
  OffsetTracker tracker = *OffsetTracker::create(data.camera, {R_camera_imu_said, std::nullopt});
  std::vector<Followed> all;
  auto sample = data.gyro.begin();
  for (std::size_t i = 0; i + kBurst <= data.frames.size(); i += following.burst_every) {
    const FollowedBurst burst = burst_at(data, i);
    const FrameStamp& first = burst.frames.front();
    const FrameStamp& last = burst.frames.back();
    while (sample != data.gyro.end() && tracker.worth_of(first, last) == Worth::unknown) {
      tracker.push(*sample++);
    }
    const double time_s = static_cast<double>(i + kBurst - 1) / scenario.camera.fps;
    const bool turns = following.shown(time_s) && tracker.worth_of(first, last) == Worth::something;
    if (turns) tracker.push(burst);
    const OffsetEstimate estimate = tracker.estimate_at(last.time);
    const double truth_s = to_seconds(scenario.camera.time_offset) + clock_error(time_s);
    all.push_back({time_s, to_seconds(estimate.offset) - truth_s, to_seconds(estimate.sigma),
                   estimate.is_known});
  }
  return all;
}

/// A hand that walks and sways; as a phone has them, and as a board has them.
TrackScenario scenario_of(std::uint64_t seed) {
  TrackScenario scenario;
  scenario.camera = camera_720p(milliseconds(seed % 3 == 0 ? 30 : 16));
  scenario.camera.time_offset = milliseconds(-12);
  scenario.gyro_rate_hz = seed % 2 == 0 ? 100 : 400;
  scenario.corners = 40;
  scenario.hand_sway_m = 0.01;
  scenario.seed = seed;
  return scenario;
}

/// 30 ms a minute.
double phone_drift(double time_s) {
  return 0.5e-3 * time_s;
}

ClockError jump_at(double when_s, double by_s) {
  return [=](double time_s) { return phone_drift(time_s) + (time_s > when_s ? by_s : 0); };
}

double largest_error_s(const std::vector<Followed>& all, double from_s) {
  double largest_s = 0;
  for (const Followed& one : all) {
    if (one.time_s >= from_s) largest_s = std::max(largest_s, std::abs(one.error_s));
  }
  return largest_s;
}

bool is_confidently_wrong(const Followed& one) {
  return one.is_known && std::abs(one.error_s) > 4 * one.sigma_s;
}

TEST(OffsetTracker, FollowsAPhonesDrift) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto all = follow(scenario_of(seed), phone_drift);
    EXPECT_LT(largest_error_s(all, 10), 1.5e-3) << "seed " << seed;
    EXPECT_TRUE(all.back().is_known) << "seed " << seed;
  }
}

TEST(OffsetTracker, FollowsItThoughAThirdOfTheCornersMoveOnTheirOwn) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    TrackScenario scenario = scenario_of(seed);
    scenario.moving_share = 0.3;
    EXPECT_LT(largest_error_s(follow(scenario, phone_drift), 10), 1.5e-3) << "seed " << seed;
  }
}

// As on a slow board, or where little of a core is allowed.
TEST(OffsetTracker, FollowsItWhereBurstsAreRare) {
  for (const std::size_t burst_every :
       {std::size_t{120}, std::size_t{240}}) {  // frames: four and eight seconds
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      TrackScenario scenario = scenario_of(seed);
      scenario.duration = std::chrono::seconds(90);
      const auto all = follow(scenario, jump_at(-1, -0.4), {.burst_every = burst_every});
      EXPECT_LT(largest_error_s(all, 40), 2e-3) << burst_every << " frames, seed " << seed;
      EXPECT_TRUE(all.back().is_known) << burst_every << " frames, seed " << seed;
      EXPECT_TRUE(std::ranges::none_of(all, is_confidently_wrong)) << "seed " << seed;
    }
  }
}

TEST(OffsetTracker, SaysHowUncertainItIs) {
  double sum = 0;
  int count = 0;
  for (std::uint64_t seed = 21; seed <= 32; ++seed) {
    for (const Followed& one : follow(scenario_of(seed), phone_drift)) {
      if (!one.is_known) continue;
      EXPECT_FALSE(is_confidently_wrong(one)) << "seed " << seed << ", " << one.time_s << " s";
      sum += std::pow(one.error_s / one.sigma_s, 2);
      ++count;
    }
  }
  const double normalised = sum / count;  // 1 where sigma is just right
  EXPECT_GT(normalised, 0.4);
  EXPECT_LT(normalised, 1.3);
}

TEST(OffsetTracker, FindsTheOffsetWhereverItIs) {
  for (const int wrong_ms : {-450, -33, 90, 430}) {
    const auto all = follow(scenario_of(3), [=](double /*time_s*/) { return 1e-3 * wrong_ms; });
    EXPECT_LT(largest_error_s(all, 10), 1.5e-3) << wrong_ms << " ms";
  }
}

TEST(OffsetTracker, ComesBackAfterAJump) {
  for (const double by_s : {1.0 / 30, -1.0 / 30, 0.1, -0.3}) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      TrackScenario scenario = scenario_of(seed);
      scenario.duration = std::chrono::seconds(35);
      const auto all = follow(scenario, jump_at(20, by_s));
      EXPECT_LT(largest_error_s(all, 25), 1.5e-3) << by_s << " s, seed " << seed;
      EXPECT_TRUE(all.back().is_known);
    }
  }
}

TEST(OffsetTracker, KeepsWhatItKnowsEverLessSurelyWhileNothingTurns) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const auto all =
        follow(scenario_of(seed), phone_drift, {[](double time_s) { return time_s < 20; }});
    const auto at = [&](double time_s) {
      return *std::ranges::lower_bound(all, time_s, {}, &Followed::time_s);
    };
    EXPECT_GT(at(40).sigma_s, 2 * at(19).sigma_s);
    EXPECT_GT(at(58).sigma_s, 1.3 * at(40).sigma_s);
    for (const Followed& one : all) {
      EXPECT_FALSE(is_confidently_wrong(one)) << "seed " << seed << ", " << one.time_s << " s";
    }
  }
}

TEST(OffsetTracker, FindsItAnewHoweverLongItWasLost) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    TrackScenario scenario = scenario_of(seed);
    scenario.duration = std::chrono::seconds(250);
    // A bump in long stillness is too little to find it by, but tells that it is lost.
    const auto all = follow(scenario, phone_drift, {[](double time_s) {
                              return time_s < 20 || (time_s > 140 && time_s < 141) || time_s > 230;
                            }});
    EXPECT_LT(largest_error_s(all, 240), 1.5e-3) << "seed " << seed;
    EXPECT_TRUE(all.back().is_known) << "seed " << seed;
  }
}

TEST(OffsetTracker, DoesNotKnowTheOffsetOfACameraOnATripod) {
  TrackScenario scenario = scenario_of(1);
  scenario.hand = tripod();
  scenario.hand_sway_m = 0;
  scenario.duration = std::chrono::seconds(20);
  for (const Followed& one : follow(scenario, [](double /*time_s*/) { return 0.02; })) {
    EXPECT_FALSE(one.is_known);
    EXPECT_DOUBLE_EQ(one.error_s, -0.02);  // that of the calibration
  }
}

TEST(OffsetTracker, FindsNothingIfTheAxesAreNotAsTheyAreSaidToBe) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    TrackScenario scenario = scenario_of(seed);
    scenario.M_camera_imu << 0, -1, 0, -1, 0, 0, 0, 0, -1;
    scenario.duration = std::chrono::seconds(40);
    for (const std::size_t burst_every : {kBurstEvery, std::size_t{120}}) {
      const auto all =
          follow(scenario, phone_drift, {always, Eigen::Matrix3d::Identity(), burst_every});
      EXPECT_TRUE(std::ranges::none_of(all, &Followed::is_known)) << "seed " << seed;
    }
  }
}

}  // namespace
}  // namespace gimbal
