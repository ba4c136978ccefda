// Whether an orientation's covariance says how wrong it is where samples are missing or clipped: on
// spoilt recordings of a laboratory, whose true orientation is known.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "pipeline/smoother/attitude_stream.hpp"
#include "tests/support/orientation_trial.hpp"

namespace gimbal {
namespace {

using Eigen::Quaterniond;
using Samples = std::vector<ImuSample>;

constexpr double kDegree = std::numbers::pi / 180;

struct Damage {
  std::string name;
  std::function<Samples(const Samples&)> spoil;
};

void PrintTo(const Damage& damage, std::ostream* stream) {
  *stream << damage.name;
}

Samples with_holes(const Samples& samples) {
  Samples left;
  for (const ImuSample& sample : samples) {
    if (std::fmod(seconds_since_epoch(sample.time), 10) >= 0.5) left.push_back(sample);
  }
  return left;
}

Samples clipped(const Samples& samples) {
  Samples left = samples;
  for (ImuSample& sample : left) {
    sample.gyro_rad_s = sample.gyro_rad_s.cwiseMax(-250 * kDegree).cwiseMin(250 * kDegree);
  }
  return left;
}

/// Of the tilt, over all judged answers of a recording.
struct Tilt {
  double error_deg = 0;  ///< root mean square
  double sigma_deg = 0;  ///< what the covariance expects that to be
  /// sqrt(NEES / 2). Of normal errors with that covariance the quantiles are .83, 1.52 and 2.15.
  double median = 0;
  double nine_of_ten = 0;
  double all_but_a_hundredth = 0;
};

double quantile(const std::vector<double>& sorted, double share) {
  return sorted.at(static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1)));
}

class Judge {
 public:
  explicit Judge(const test::OrientationTrial& trial) : trial_(trial) {}

  /// Answers come in the order of samples, some of which are missing.
  void take(const AttitudeEstimate& answer) {
    while (trial_.samples.at(next_).time < answer.attitude.time) ++next_;
    const auto& truth = trial_.truth[next_];
    if (!truth || !truth->moves) return;
    const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
    const Eigen::Vector2d error =
        (answer.attitude.q_world_imu * (truth->q_world_imu.conjugate() * z)).cross(z).head<2>();
    const Eigen::Matrix2d covariance = answer.covariance_rad2.topLeftCorner<2, 2>();
    normalized_.push_back(std::sqrt(error.dot(covariance.inverse() * error) / 2));
    squared_error_ += error.squaredNorm();
    variance_ += covariance.trace();
  }

  [[nodiscard]] Tilt tilt() {
    std::ranges::sort(normalized_);
    const auto count = static_cast<double>(normalized_.size());
    return {std::sqrt(squared_error_ / count) / kDegree, std::sqrt(variance_ / count) / kDegree,
            quantile(normalized_, 0.5), quantile(normalized_, 0.9), quantile(normalized_, 0.99)};
  }

 private:
  const test::OrientationTrial& trial_;
  std::size_t next_ = 0;
  std::vector<double> normalized_;
  double squared_error_ = 0;
  double variance_ = 0;
};

Tilt judged(const test::OrientationTrial& trial, const Samples& samples) {
  const auto stream = make_causal_stream(AttitudeEkfParameters{});
  Judge judge(trial);
  const auto take = [&] {
    while (const auto answer = stream->pop()) judge.take(*answer);
  };
  for (const ImuSample& sample : samples) {
    stream->push(sample);
    take();
  }
  stream->finish();
  take();
  return judge.tilt();
}

class TrialCovariance : public ::testing::TestWithParam<Damage> {};

void expect_honest(const Tilt& tilt, const std::string& trial) {
  fmt::print("{:52} error {:5.2f} sigma {:5.2f} deg, normalized {:.2f} {:.2f} {:.2f}\n", trial,
             tilt.error_deg, tilt.sigma_deg, tilt.median, tilt.nine_of_ten,
             tilt.all_but_a_hundredth);
  // Errors of one recording go together, so that their quantiles scatter.
  EXPECT_LT(tilt.nine_of_ten, 1.52 * 1.25) << trial;
  EXPECT_LT(tilt.all_but_a_hundredth, 2.15 * 1.25) << trial;
}

TEST_P(TrialCovariance, SaysHowWrongTheTiltIs) {
  const auto folders = test::orientation_trials(GIMBALD_SHARED, "broad-");
  if (folders.empty()) GTEST_SKIP() << "no recordings in GIMBALD_SHARED_DIR";
  const auto count = static_cast<double>(folders.size());
  double error_deg = 0;
  double sigma_deg = 0;
  double whole_sigma_deg = 0;
  for (const auto& folder : folders) {
    const auto trial = test::read_orientation_trial(folder);
    const Tilt tilt = judged(trial, GetParam().spoil(trial.samples));
    expect_honest(tilt, trial.name);
    error_deg += tilt.error_deg / count;
    sigma_deg += tilt.sigma_deg / count;
    whole_sigma_deg += judged(trial, trial.samples).sigma_deg / count;
  }
  EXPECT_LT(error_deg, 12);
  // Neither too sure nor so unsure that it says nothing.
  EXPECT_GT(sigma_deg, error_deg / 1.5);
  EXPECT_LT(sigma_deg, error_deg * 2.5);
  EXPECT_GT(sigma_deg, 3 * whole_sigma_deg);
}

INSTANTIATE_TEST_SUITE_P(Damages, TrialCovariance,
                         ::testing::Values(Damage{"holes", with_holes}, Damage{"clipped", clipped}),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace gimbal
