#include "pipeline/smoother/fixed_lag_smoother.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace gimbal {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Index = ErrorIndex;

constexpr double kDegree = std::numbers::pi / 180;
const Eigen::Vector3d kUp(0, 0, kGravity_m_s2);

struct Recording {
  std::vector<ImuSample> samples;
  std::vector<Eigen::Quaterniond> truth;  ///< an orientation a sample
};

/// A hand that turns and moves, with the noise and the bias of a phone; 100 Hz.
Recording record(double duration_s) {
  const auto attitude = [](double t) {
    return rotation_from_vector({0.5 * std::sin(2.1 * t), 0, 0}) *
           rotation_from_vector({0, 0.7 * std::sin(1.4 * t + 1), 0}) *
           rotation_from_vector({0, 0, 0.6 * std::sin(0.9 * t + 2)});
  };
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  const auto draw = [&](double sigma) -> Eigen::Vector3d {
    return {sigma * normal(random), sigma * normal(random), sigma * normal(random)};
  };
  constexpr double kInterval_s = 0.01;
  constexpr double kInstant_s = 1e-4;
  const Eigen::Vector3d bias(0.02, -0.01, 0.015);
  Recording recording;
  for (int i = 1; i * kInterval_s <= duration_s; ++i) {
    const double t = i * kInterval_s;
    const Eigen::Quaterniond q = attitude(t);
    const Eigen::Vector3d turn = vector_from_rotation(attitude(t - kInstant_s / 2).conjugate() *
                                                      attitude(t + kInstant_s / 2));
    const Eigen::Vector3d push(1.2 * std::sin(7 * t), 0.8 * std::sin(5 * t), 0.5);
    recording.samples.push_back({time_from_seconds(t), turn / kInstant_s + bias + draw(0.005),
                                 q.conjugate() * (kUp + push) + draw(0.05)});
    recording.truth.push_back(q);
  }
  return recording;
}

std::vector<AttitudeEstimate> smooth(const std::vector<ImuSample>& samples, SmootherLag lag) {
  FixedLagSmootherParameters parameters;
  parameters.lag = lag;
  FixedLagSmoother smoother(parameters);
  std::vector<AttitudeEstimate> answers;
  for (const ImuSample& sample : samples) {
    smoother.push(sample);
    while (const auto answer = smoother.pop()) answers.push_back(*answer);
  }
  smoother.finish();
  while (const auto answer = smoother.pop()) answers.push_back(*answer);
  return answers;
}

double tilt_between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  return std::acos(std::clamp((a.conjugate() * z).dot(b.conjugate() * z), -1.0, 1.0));
}

double rms_tilt_error(const Recording& recording, const std::vector<AttitudeEstimate>& answers) {
  double sum = 0;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const double error = tilt_between(answers[i].attitude.q_world_imu, recording.truth[i]);
    sum += error * error;
  }
  return std::sqrt(sum / static_cast<double>(answers.size()));
}

/// Rauch, Tung and Striebel (1965), with dense matrices and inverses, from the filter's own
/// numbers, from where the tilt is known.
struct DenseStep {
  ErrorCovariance F;
  ErrorCovariance P_predicted;
  ErrorCovariance P_updated;
  ErrorState correction;  ///< by the step's updates
  Eigen::Quaterniond q;
  std::size_t sample;
};

DenseStep dense_step(const AttitudeEkfState& state, std::size_t sample) {
  DenseStep dense;
  const MovingColumns back = state.step.transition.back_from_attitude_and_velocity();
  dense.F.setIdentity();
  dense.F.middleRows<3>(Index::attitude) += back.leftCols<3>().transpose();
  dense.F.middleRows<3>(Index::velocity) += back.rightCols<3>().transpose();
  dense.P_updated = state.filter.covariance();
  dense.P_predicted = dense.P_updated;
  dense.correction.setZero();
  for (std::size_t i = 0; i < state.step.update_count; ++i) {
    const ScalarUpdate& update = state.step.updates[i];
    dense.P_predicted += update.variance * update.gain * update.gain.transpose();
    dense.correction += update.residual * update.gain;
  }
  dense.q = state.filter.mean().q_world_imu;
  dense.sample = sample;
  return dense;
}

TEST(FixedLagSmoother, TheWholeRecordingIsRauchTungAndStriebels) {
  const Recording recording = record(10);
  AttitudeEkf ekf;
  std::vector<DenseStep> steps;
  for (std::size_t i = 0; i < recording.samples.size(); ++i) {
    const std::size_t count = ekf.state().step_count;
    ekf.update(recording.samples[i]);
    if (ekf.state().step_count == count || !ekf.state().tilt_is_known) continue;
    steps.push_back(dense_step(ekf.state(), i));
  }
  ASSERT_GT(steps.size(), 350U);
  const std::vector<AttitudeEstimate> answers = smooth(recording.samples, std::nullopt);
  ASSERT_EQ(answers.size(), recording.samples.size());

  ErrorState error = ErrorState::Zero();
  ErrorCovariance P = steps.back().P_updated;
  for (std::size_t k = steps.size() - 1; k-- > 0;) {
    const DenseStep& next = steps[k + 1];
    const ErrorCovariance G =
        next.P_predicted.fullPivLu().solve(next.F * steps[k].P_updated).transpose();
    error = (G * (error + next.correction)).eval();
    P = (steps[k].P_updated + G * (P - next.P_predicted) * G.transpose()).eval();
    const auto turn = error.segment<3>(Index::attitude);  // tilt first, then heading
    const Eigen::Quaterniond expected = rotation_from_vector({0, 0, turn.z()}) *
                                        rotation_from_vector({turn.x(), turn.y(), 0}) * steps[k].q;
    const AttitudeEstimate& answer = answers[steps[k].sample];
    EXPECT_LT(answer.attitude.q_world_imu.angularDistance(expected), 1e-6);
    const Eigen::Matrix3d covariance = P.block<3, 3>(Index::attitude, Index::attitude);
    EXPECT_LT((answer.covariance_rad2 - covariance).norm(), 1e-4 * covariance.norm());
  }
}

// What came before the tilt was known is as good as what comes after, with no seam between.
TEST(FixedLagSmoother, LooksBackOverTheFirstMomentsToo) {
  const Recording recording = record(10);
  AttitudeEkf ekf;
  double causal = 0;
  std::size_t first = 0;
  for (; !ekf.state().tilt_is_known; ++first) {
    const double error =
        tilt_between(ekf.update(recording.samples[first]).q_world_imu, recording.truth[first]);
    causal += error * error;
  }
  ASSERT_GT(first, 20U);
  const std::vector<AttitudeEstimate> answers = smooth(recording.samples, std::nullopt);
  double smoothed = 0;
  for (std::size_t i = 0; i < first; ++i) {
    const double error = tilt_between(answers[i].attitude.q_world_imu, recording.truth[i]);
    smoothed += error * error;
  }
  EXPECT_LT(smoothed, causal / 16);
  for (std::size_t i = 1; i < 2 * first; ++i) {
    const Eigen::Quaterniond true_turn = recording.truth[i - 1].conjugate() * recording.truth[i];
    const Eigen::Quaterniond turn =
        answers[i - 1].attitude.q_world_imu.conjugate() * answers[i].attitude.q_world_imu;
    EXPECT_LT(turn.angularDistance(true_turn), 0.05 * kDegree) << i;
  }
}

TEST(FixedLagSmoother, AnswersOnceASampleInOrderAtTheSamplesStamps) {
  const Recording recording = record(5);
  for (const SmootherLag lag : {SmootherLag(seconds(0)), SmootherLag(milliseconds(333)),
                                SmootherLag(seconds(60)), SmootherLag()}) {
    const std::vector<AttitudeEstimate> answers = smooth(recording.samples, lag);
    ASSERT_EQ(answers.size(), recording.samples.size());
    for (std::size_t i = 0; i < answers.size(); ++i) {
      ASSERT_EQ(answers[i].attitude.time, recording.samples[i].time);
    }
  }
}

TEST(FixedLagSmoother, ReleasesAsSoonAsTheLagAndABlockHavePassed) {
  const Recording recording = record(5);
  FixedLagSmootherParameters parameters;
  parameters.lag = milliseconds(500);
  FixedLagSmoother smoother(parameters);
  SensorTime released = recording.samples.front().time;
  for (const ImuSample& sample : recording.samples) {
    smoother.push(sample);
    while (const auto answer = smoother.pop()) released = answer->attitude.time;
    EXPECT_LE(sample.time - released, milliseconds(500 + 2 * 20 + 10));
  }
}

TEST(FixedLagSmoother, TheMoreFutureTheBetterTheTilt) {
  const Recording recording = record(60);
  const double causal = rms_tilt_error(recording, smooth(recording.samples, seconds(0)));
  const double one_second = rms_tilt_error(recording, smooth(recording.samples, seconds(1)));
  const double three_seconds = rms_tilt_error(recording, smooth(recording.samples, seconds(3)));
  const double whole = rms_tilt_error(recording, smooth(recording.samples, std::nullopt));
  EXPECT_LT(one_second, causal);
  EXPECT_LT(three_seconds, one_second);
  EXPECT_LT(whole, three_seconds);
}

TEST(FixedLagSmoother, LeavesNoSeams) {
  const Recording recording = record(20);
  for (const SmootherLag lag : {SmootherLag(seconds(1)), SmootherLag()}) {
    const std::vector<AttitudeEstimate> answers = smooth(recording.samples, lag);
    double worst = 0;
    for (std::size_t i = 1; i < answers.size(); ++i) {
      const Eigen::Quaterniond by_gyro =
          answers[i - 1].attitude.q_world_imu *
          rotation_from_vector(0.01 * recording.samples[i].gyro_rad_s);
      worst = std::max(worst, by_gyro.angularDistance(answers[i].attitude.q_world_imu));
    }
    // A bias of 1.6 deg/s is 0.016 degrees a sample.
    EXPECT_LT(worst, 0.12 * kDegree);
  }
}

TEST(FixedLagSmoother, AnAccelerometerThatStartsLateTurnsWhatCameBeforeAlong) {
  Recording recording = record(10);
  for (std::size_t i = 0; i < 70; ++i) recording.samples[i].accel_m_s2.reset();
  for (const SmootherLag lag : {SmootherLag(seconds(1)), SmootherLag()}) {
    const std::vector<AttitudeEstimate> answers = smooth(recording.samples, lag);
    for (std::size_t i = 1; i < answers.size(); ++i) {
      const Eigen::Quaterniond by_gyro =
          answers[i - 1].attitude.q_world_imu *
          rotation_from_vector(0.01 * recording.samples[i].gyro_rad_s);
      EXPECT_LT(by_gyro.angularDistance(answers[i].attitude.q_world_imu), 0.5 * kDegree) << i;
    }
    EXPECT_LT(tilt_between(answers.front().attitude.q_world_imu, recording.truth.front()),
              12 * kDegree);
  }
}

TEST(FixedLagSmoother, AForceThatComesLateAfterAHoleTurnsNothingBeforeIt) {
  for (const SmootherLag lag : {SmootherLag(), SmootherLag(seconds(1))}) {
    const Recording recording = record(60);
    std::vector<ImuSample> samples;
    for (ImuSample sample : recording.samples) {
      const double t = seconds_since_epoch(sample.time);
      if (t > 20 && t < 30) continue;
      if (t > 29 && t < 30.1) sample.accel_m_s2.reset();
      samples.push_back(sample);
    }
    double worst = 0;
    for (const AttitudeEstimate& answer : smooth(samples, lag)) {
      const double t = seconds_since_epoch(answer.attitude.time);
      if (t < 10 || (t > 19 && t < 40)) continue;
      const auto index = static_cast<std::size_t>(std::lround(t / 0.01)) - 1;
      worst = std::max(worst, tilt_between(answer.attitude.q_world_imu, recording.truth[index]));
    }
    EXPECT_LT(worst, 0.1);
  }
}

TEST(FixedLagSmoother, ALargeBiasThatIsKnownLateSpinsNothing) {
  // A hand turns for a minute, then rests: only then the bias about the vertical is known.
  std::vector<ImuSample> samples;
  for (int i = 0; i < 8000; ++i) {
    const double t = 0.01 * i;
    const double turning = t < 60 ? 1 : 0;
    const Eigen::Vector3d rate(0, 0, turning * 0.6 * std::sin(2 * t) + 0.08);
    samples.push_back({time_from_seconds(t), rate, kUp});
  }
  for (const SmootherLag lag : {SmootherLag(), SmootherLag(seconds(3)), SmootherLag(seconds(1))}) {
    const auto answers = smooth(samples, lag);
    for (std::size_t i = 1; i < answers.size(); ++i) {
      const double step =
          answers[i].attitude.q_world_imu.angularDistance(answers[i - 1].attitude.q_world_imu);
      ASSERT_LT(step, 0.02) << "at " << seconds_since_epoch(answers[i].attitude.time) << " s";
    }
  }
}

TEST(FixedLagSmoother, ATiltThatIsFoundAnewChangesNothingBefore) {
  Recording recording = record(60);
  const Eigen::Quaterniond turn = rotation_from_vector({1.5, 0, 0});
  for (std::size_t i = 2500; i < recording.samples.size(); ++i) {  // the rates miss it
    Eigen::Quaterniond& q = recording.truth[i];
    *recording.samples[i].accel_m_s2 += q.conjugate() * (turn.conjugate() * kUp - kUp);
    q = turn * q;
  }
  for (const SmootherLag lag : {SmootherLag(seconds(1)), SmootherLag()}) {
    const auto answers = smooth(recording.samples, lag);
    ASSERT_EQ(answers.size(), recording.samples.size());
    for (std::size_t i = 0; i < answers.size(); ++i) {
      if (i >= 2300 && i < 3500) continue;
      ASSERT_LT(tilt_between(answers[i].attitude.q_world_imu, recording.truth[i]),
                (i < 1000 ? 10 : 3) * kDegree)
          << i;
    }
  }
}

TEST(FixedLagSmoother, BadSamplesAndHolesLeaveFiniteAnswersInOrder) {
  Recording recording = record(10);
  std::vector<ImuSample> samples;
  for (std::size_t i = 0; i < recording.samples.size(); ++i) {
    ImuSample sample = recording.samples[i];
    if (i > 300) sample.time += seconds(10);
    if (i > 600) sample.time += milliseconds(235);
    samples.push_back(sample);
    if (i % 50 == 0) {
      samples.push_back({sample.time, Eigen::Vector3d::Ones(), kUp});
      samples.push_back(
          {sample.time + milliseconds(1), Eigen::Vector3d::Constant(std::nan("")), kUp});
    }
  }
  for (const SmootherLag lag : {SmootherLag(seconds(1)), SmootherLag()}) {
    const std::vector<AttitudeEstimate> answers = smooth(samples, lag);
    // The first one after the hole could be a wrong stamp.
    ASSERT_EQ(answers.size(), recording.samples.size() - 1);
    for (std::size_t i = 0; i < answers.size(); ++i) {
      ASSERT_TRUE(answers[i].attitude.q_world_imu.coeffs().allFinite());
      ASSERT_TRUE(answers[i].covariance_rad2.allFinite());
      if (i > 0) {
        ASSERT_LT(answers[i - 1].attitude.time, answers[i].attitude.time);
      }
    }
  }
}

}  // namespace
}  // namespace gimbal
