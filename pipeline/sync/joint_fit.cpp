#include "pipeline/sync/joint_fit.hpp"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>
#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "pipeline/sample/rotation.hpp"
#include "pipeline/sync/gyro_integral.hpp"
#include "pipeline/sync/median.hpp"
#include "pipeline/sync/pair_residual.hpp"

namespace gimbal {
namespace {

constexpr int kRounds = 6;
constexpr double kMargin_s = 0.1;   // how far an offset may move in a round
constexpr double kLossScale = 2.0;  // of the Cauchy loss, in standard deviations
constexpr double kStretch_s = 0.25;
constexpr std::size_t kStretchesTogether = 8;  // so long do errors last
constexpr double kFirstDispersion_px2 = 100;   // until it is known
constexpr double kSmallestNoise_px = 0.01;
constexpr std::size_t kFewestPairs = 100;

/// The problem about one point: everything that is linear there.
struct Linearised {
  JointParameters at;
  GyroIntegral gyro;
  std::vector<SightingPair> pairs;
};

Result<Linearised> linearise(const JointData& data, const JointParameters& at) {
  const SensorTime zero = data.gyro.front().time;
  const auto maker = SightingMaker::create(data.camera, at.focal_scale, zero);
  if (!maker) return tl::unexpected(maker.error());
  Linearised problem{at, GyroIntegral(data.gyro, zero, at.gyro_bias_rad_s),
                     make_pairs(*maker, data.frames, data.tracks, {})};
  std::erase_if(problem.pairs, [&](const SightingPair& pair) {
    const double from_s = pair.from.stamp_s + at.offset_s + at.readout_s * pair.from.line;
    const double to_s = pair.to.stamp_s + at.offset_s + at.readout_s * pair.to.line;
    return !problem.gyro.covers(from_s - kMargin_s, to_s + kMargin_s);
  });
  return problem;
}

JointParameters moved(const JointParameters& from, const JointStep& step) {
  JointParameters to = from;
  to.offset_s += step[JointIndex::offset_s];
  to.readout_s += step[JointIndex::readout_s];
  to.R_camera_imu = quaternion_exp(step.segment<3>(JointIndex::axes_rad)) * from.R_camera_imu;
  to.gyro_bias_rad_s += step.segment<3>(JointIndex::bias_rad_s);
  to.focal_scale *= std::exp(step[JointIndex::log_focal]);
  return to;
}

Eigen::Vector2d miss_px(const SightingPair& pair, const Linearised& problem) {
  const JointStep none = JointStep::Zero();
  const double* const parameters[] = {none.data()};
  Eigen::Vector2d miss = Eigen::Vector2d::Zero();
  PairResidual(pair, problem.gyro, problem.at).Evaluate(parameters, miss.data(), nullptr);
  return miss;
}

double noise_px(const Linearised& problem) {
  std::vector<double> distances;
  distances.reserve(problem.pairs.size());
  for (const SightingPair& pair : problem.pairs) distances.push_back(miss_px(pair, problem).norm());
  return std::max(kSmallestNoise_px, coordinate_sigma(std::move(distances)));
}

/// What is known before: gyroscopes are off by about a degree a second, and focal lengths as data
/// sheets and old calibrations have them by some per cent. Variances of a step's components; the
/// others are not known at all.
JointStep prior_weights() {
  constexpr double kBias_rad_s = 0.02;
  constexpr double kLogFocal = 0.05;
  JointStep weights = JointStep::Zero();
  weights.segment<3>(JointIndex::bias_rad_s).setConstant(1 / (kBias_rad_s * kBias_rad_s));
  weights[JointIndex::log_focal] = 1 / (kLogFocal * kLogFocal);
  return weights;
}

/// The step that leads to what the prior expects: no bias, the calibration's focal length.
JointStep prior_step(const JointParameters& at) {
  JointStep step = JointStep::Zero();
  step.segment<3>(JointIndex::bias_rad_s) = -at.gyro_bias_rad_s;
  step[JointIndex::log_focal] = -std::log(at.focal_scale);
  return step;
}

struct Loss {
  double scale_px = 0;
  /// What a square pixel of misses is worth: their variance, times how many of them err as one.
  double dispersion_px2 = 0;
};

Result<JointStep> solve(const Linearised& problem, const Loss& loss_of) {
  ceres::CauchyLoss loss(loss_of.scale_px);
  ceres::Problem::Options ownership;
  ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem ceres_problem(ownership);
  JointStep step = JointStep::Zero();
  for (const SightingPair& pair : problem.pairs) {
    ceres_problem.AddResidualBlock(new PairResidual(pair, problem.gyro, problem.at), &loss,
                                   step.data());
  }
  const JointStep prior = (loss_of.dispersion_px2 * prior_weights()).cwiseSqrt();
  ceres_problem.AddResidualBlock(
      new ceres::NormalPrior(prior.asDiagonal().toDenseMatrix(), prior_step(problem.at)), nullptr,
      step.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = 20;
  options.function_tolerance = 1e-9;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);
  if (!summary.IsSolutionUsable()) return failed("the fit did not converge: " + summary.message);
  return step;
}

/// What the loss says of the parameters at the solution.
struct LossShape {
  JointCovariance curvature = JointCovariance::Zero();
  std::vector<JointStep> scores;  ///< gradients, summed over each stretch of time
};

LossShape loss_shape(const Linearised& problem, double loss_scale_px) {
  const double scale_sq = loss_scale_px * loss_scale_px;
  const JointStep none = JointStep::Zero();
  const double* const parameters[] = {none.data()};
  const double begin_s = problem.pairs.front().from.stamp_s;
  LossShape shape;
  for (const SightingPair& pair : problem.pairs) {
    Eigen::Vector2d miss;
    Eigen::Matrix<double, 2, JointIndex::size, Eigen::RowMajor> rows;
    double* jacobians[] = {rows.data()};
    PairResidual(pair, problem.gyro, problem.at).Evaluate(parameters, miss.data(), jacobians);
    // Cauchy's loss and its derivatives: rho = c² log(1 + s/c²), s = |miss|².
    const double weight = 1 / (1 + miss.squaredNorm() / scale_sq);
    const JointStep along = rows.transpose() * miss;
    shape.curvature += weight * rows.transpose() * rows;
    shape.curvature -= 2 * weight * weight / scale_sq * along * along.transpose();
    const auto stretch = static_cast<std::size_t>((pair.from.stamp_s - begin_s) / kStretch_s);
    shape.scores.resize(std::max(shape.scores.size(), stretch + 1), JointStep::Zero());
    shape.scores[stretch] += weight * along;
  }
  return shape;
}

/// Of the sum of all scores, with what neighbouring stretches have in common (Newey and West).
JointCovariance score_covariance(const std::vector<JointStep>& scores) {
  const std::size_t count = scores.size();
  const std::size_t lags = std::min(kStretchesTogether, count / 8);
  JointCovariance sum = JointCovariance::Zero();
  for (std::size_t lag = 0; lag <= lags; ++lag) {
    const double weight = 1 - static_cast<double>(lag) / static_cast<double>(lags + 1);
    for (std::size_t i = 0; i + lag < count; ++i) {
      const JointCovariance common = weight * scores[i] * scores[i + lag].transpose();
      sum += common;
      if (lag > 0) sum += common.transpose();
    }
  }
  // As many independent stretches as there are parameters are spent on the fit; the weights above
  // leave so many of them.
  const double independent = 1.5 * static_cast<double>(count) / static_cast<double>(lags + 1);
  return sum * independent / std::max(1.0, independent - double{JointIndex::size});
}

/// How large scores are for the curvature that goes with them.
double dispersion_px2(const LossShape& shape) {
  return (shape.curvature.inverse() * score_covariance(shape.scores)).trace() /
         double{JointIndex::size};
}

JointCovariance covariance(const LossShape& shape, double dispersion) {
  const JointCovariance prior = prior_weights().asDiagonal();
  const JointCovariance inverse = (shape.curvature + dispersion * prior).inverse();
  return inverse * (score_covariance(shape.scores) + dispersion * dispersion * prior) * inverse;
}

double agreeing_share(const Linearised& problem, double noise) {
  const auto agreeing = std::count_if(
      problem.pairs.begin(), problem.pairs.end(),
      [&](const SightingPair& pair) { return miss_px(pair, problem).norm() < 3 * noise; });
  return static_cast<double>(agreeing) / static_cast<double>(problem.pairs.size());
}

}  // namespace

Result<JointFit> fit_jointly(const JointData& data, const JointParameters& start) {
  JointFit fit;
  fit.parameters = start;
  Loss loss{0, kFirstDispersion_px2};
  for (int round = 0;; ++round) {
    const Result<Linearised> problem = linearise(data, fit.parameters);
    if (!problem) return tl::unexpected(problem.error());
    if (problem->pairs.size() < kFewestPairs) {
      return bad_input(fmt::format("only {} pairs of corners fall into the gyroscope's log",
                                   problem->pairs.size()));
    }
    fit.noise_px = noise_px(*problem);
    loss.scale_px = kLossScale * fit.noise_px;
    if (round > 0) {
      const LossShape shape = loss_shape(*problem, loss.scale_px);
      loss.dispersion_px2 = dispersion_px2(shape);
      fit.covariance = covariance(shape, loss.dispersion_px2);
    }
    if (round == kRounds) {
      fit.pairs = problem->pairs.size();
      fit.agreeing = agreeing_share(*problem, fit.noise_px);
      return fit;
    }
    const auto step = solve(*problem, loss);
    if (!step) return tl::unexpected(step.error());
    fit.parameters = moved(fit.parameters, *step);
  }
}

}  // namespace gimbal
