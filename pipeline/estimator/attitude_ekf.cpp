#include "pipeline/estimator/attitude_ekf.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pipeline/sample/upright.hpp"

namespace gimbal {
namespace {

using Index = ErrorIndex;

// Well beyond the ranges of inertial sensors (about 70 rad/s and 2000 m/s²): what lies outside is
// no measurement, and would overflow in the filter. Rates in deg/s come through, for the
// plausibility check to name.
constexpr double kLargestRate_rad_s = 1e3;
constexpr double kLargestAccel_m_s2 = 1e4;

constexpr double square(double x) {
  return x * x;
}

/// False also for what is not a number.
bool is_within(const Eigen::Vector3d& value, double limit) {
  return value.norm() <= limit;
}

/// Share of a new value in a mean that forgets with the given time constant.
double share(double interval_s, double memory_s) {
  return -std::expm1(-interval_s / memory_s);
}

Eigen::Quaterniond turn_about_vertical(double angle_rad) {
  return {std::cos(angle_rad / 2), 0, 0, std::sin(angle_rad / 2)};
}

/// Over the interval between two samples.
std::optional<Eigen::Vector3d> mean_accel(const AttitudeEkfState::LastSample& last,
                                          const ImuSample& sample) {
  if (!last.accel_m_s2 || !sample.accel_m_s2) return sample.accel_m_s2;
  return 0.5 * (*last.accel_m_s2 + *sample.accel_m_s2);
}

/// What is known of the bias at the start.
GyroBias start_bias(const AttitudeEkfParameters& p) {
  if (!p.remembered_bias) return p.gyro_bias;
  const Eigen::Array3d variance =
      p.remembered_bias->sigma_rad_s.array().square() + square(p.bias_change_between_runs_rad_s);
  return {p.remembered_bias->bias_rad_s, variance.sqrt().min(p.gyro_bias.sigma_rad_s.array())};
}

void set_variance(ErrorCovariance& P, int index, const Eigen::Vector3d& variance) {
  P.middleRows<3>(index).setZero();
  P.middleCols<3>(index).setZero();
  P.diagonal().segment<3>(index) = variance;
}

}  // namespace

AttitudeEkf::AttitudeEkf(const AttitudeEkfParameters& parameters) : parameters_(parameters) {
  const AttitudeEkfParameters& p = parameters_;
  state_.lost_gyro_axes = LostAxes(p.lost_gyro_axes);
  state_.lost_accel_axes = LostAxes(p.lost_accel_axes);
  state_.steadiness = Steadiness(p.steadiness);
  state_.vibration = MotorVibration(p.vibration);
  state_.tilt_watch = TiltWatch(p.tilt_watch);
  state_.rate_walk_rad2_s3 = square(p.start_rate_walk_rad_s_rts);
  state_.accel_mean_square_m2_s4 = 1;
  state_.rate_variance_rad2_s2 = 1;
  const GyroBias bias = start_bias(p);
  state_.filter.mean().gyro_bias_rad_s = bias.bias_rad_s;
  ErrorCovariance& P = state_.filter.covariance();
  set_variance(P, Index::gyro_bias, bias.sigma_rad_s.cwiseAbs2());
  set_variance(P, Index::accel_bias, Eigen::Vector3d::Constant(square(p.accel_bias_sigma_m_s2)));
  set_variance(P, Index::gyro_scale, Eigen::Vector3d::Constant(square(p.gyro_scale_sigma)));
  P(Index::accel_scale, Index::accel_scale) = square(p.accel_scale_sigma);
}

Attitude AttitudeEkf::update(const ImuSample& sample) {
  state_.plausibility.update(sample, state_.lost_gyro_axes.losses(),
                             state_.lost_accel_axes.losses());
  if (!is_within(sample.gyro_rad_s, kLargestRate_rad_s) ||
      (state_.last && sample.time <= state_.last->time) || leaps(sample.time)) {
    ++state_.counts.skipped_gyro;
    return predict(sample.time).attitude;
  }
  ImuSample usable = sample;
  if (sample.accel_m_s2 && !accel_is_usable(sample)) {
    ++state_.counts.skipped_accel;
    usable.accel_m_s2.reset();
  }
  if (state_.last) {
    continue_with(usable);
  } else {
    start(usable);
  }
  state_.last = {usable.time, usable.gyro_rad_s, usable.accel_m_s2};
  return {usable.time, shown_attitude()};
}

/// A stamp far ahead of the last one is believed once the next one bears it out: a single wrong one
/// would make all that follow too late.
bool AttitudeEkf::leaps(SensorTime time) {
  const SensorDuration near = parameters_.longest_bridge;
  if (!state_.last || time - state_.last->time <= near) {
    state_.leap.reset();
    return false;
  }
  const bool is_borne_out = state_.leap && time > *state_.leap && time - *state_.leap <= near;
  state_.leap = time;
  return !is_borne_out;
}

bool AttitudeEkf::accel_is_usable(const ImuSample& sample) {
  if (!is_within(*sample.accel_m_s2, kLargestAccel_m_s2)) return false;
  const double interval_s = state_.last ? to_seconds(sample.time - state_.last->time) : 0;
  const AxisLosses& losses = state_.lost_accel_axes.update(*sample.accel_m_s2, interval_s);
  return std::ranges::all_of(losses, [](AxisLoss loss) { return loss == AxisLoss::none; });
}

void AttitudeEkf::start(const ImuSample& sample) {
  state_.rate_mean_rad_s = sample.gyro_rad_s;
  state_.step_rate_rad_s = sample.gyro_rad_s;
  begin_step(sample.time);
  start_alignment(sample);
  end_step();
}

void AttitudeEkf::continue_with(const ImuSample& sample) {
  const SensorDuration interval = sample.time - state_.last->time;
  const double interval_s = to_seconds(interval);
  if (interval > parameters_.longest_bridge) {
    ++state_.counts.restarts;
    restart_tilt(sample);
    return;
  }
  bridge_or_advance(sample, interval_s);
  learn_intervals(interval_s);
  state_.vibration.add(sample.gyro_rad_s, sample.accel_m_s2, interval_s);
  if (!state_.tilt_is_known && !state_.alignment.has_started() && sample.accel_m_s2) {
    state_.alignment.start(state_.filter.mean().q_world_imu * *sample.accel_m_s2);
  }
  if (state_.filter.pending().interval_s + 0.5 * state_.usual_interval_s >=
      to_seconds(parameters_.step)) {
    learn_rate_walk(sample, state_.filter.pending().interval_s);
    if (state_.tilt_is_known) state_.tilt_watch.add(state_.filter.pending());
    if (state_.tilt_watch.is_wrong()) {
      realign(sample.time);
    } else {
      close_step(sample.time);
    }
  }
}

void AttitudeEkf::bridge_or_advance(const ImuSample& sample, double interval_s) {
  Eigen::Vector3d gyro_rad_s = 0.5 * (state_.last->gyro_rad_s + sample.gyro_rad_s);
  const std::optional<Eigen::Vector3d> accel_m_s2 = mean_accel(*state_.last, sample);
  const bool is_gap = state_.usual_interval_s > 0 &&
                      interval_s > parameters_.gap_intervals * state_.usual_interval_s;
  IntervalNoise noise = noise_of(gyro_rad_s, accel_m_s2, interval_s);
  if (is_gap) {
    ++state_.counts.gaps;
    // Between two known ends, a random walk's integral has a twelfth of T³ (Brownian bridge).
    noise.attitude_rad2.diagonal().array() +=
        state_.rate_walk_rad2_s3 * interval_s * interval_s * interval_s / 12;
    noise.velocity_m2_s2 +=
        (state_.accel_mean_square_m2_s4 + square(parameters_.unseen_accel_m_s2)) * interval_s *
        interval_s;
  }
  account_for_lost_axes(sample, interval_s, gyro_rad_s, noise);
  state_.filter.advance(gyro_rad_s, accel_m_s2, interval_s, noise);
}

IntervalNoise AttitudeEkf::noise_of(const Eigen::Vector3d& gyro_rad_s,
                                    const std::optional<Eigen::Vector3d>& accel_m_s2,
                                    double interval_s) const {
  const AttitudeEkfParameters& p = parameters_;
  IntervalNoise noise;
  noise.attitude_rad2.diagonal().setConstant(
      (square(p.gyro_noise_rad_s_rthz) + square(p.gyro_misfit_rts) * gyro_rad_s.squaredNorm()) *
      interval_s);
  if (!accel_m_s2) {
    noise.velocity_m2_s2 = square(p.unseen_accel_m_s2) * interval_s;
    return noise;
  }
  const Eigen::Vector3d beside_gravity =
      state_.filter.mean().q_world_imu * *accel_m_s2 - Eigen::Vector3d(0, 0, kGravity_m_s2);
  noise.velocity_m2_s2 = (square(p.accel_noise_m_s2_rthz) +
                          square(p.accel_misfit_rts) * beside_gravity.squaredNorm()) *
                         interval_s;
  return noise;
}

void AttitudeEkf::account_for_lost_axes(const ImuSample& sample, double interval_s,
                                        Eigen::Vector3d& gyro_rad_s, IntervalNoise& noise) {
  const AxisLosses& losses = state_.lost_gyro_axes.update(sample.gyro_rad_s, interval_s);
  bool any_is_lost = false;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const AxisLoss loss = losses[static_cast<std::size_t>(i)];
    if (loss == AxisLoss::none) continue;
    any_is_lost = true;
    if (loss == AxisLoss::clipped) gyro_rad_s[i] *= 1 + parameters_.clipped_excess;
    const Eigen::Vector3d axis = state_.filter.mean().q_world_imu * Eigen::Vector3d::Unit(i);
    noise.attitude_rad2 +=
        square(parameters_.lost_axis_density_rad_s_rthz) * interval_s * axis * axis.transpose();
  }
  if (any_is_lost) ++state_.counts.lost_samples;
}

void AttitudeEkf::learn_intervals(double interval_s) {
  // A single pause must not pass for the usual rate.
  constexpr double kShare = 0.02;
  double& usual = state_.usual_interval_s;
  usual = usual > 0 ? usual + kShare * (std::min(interval_s, 2 * usual) - usual) : interval_s;
}

void AttitudeEkf::learn_rate_walk(const ImuSample& sample, double interval_s) {
  const Eigen::Vector3d change = sample.gyro_rad_s - state_.step_rate_rad_s;
  state_.step_rate_rad_s = sample.gyro_rad_s;
  state_.rate_walk_rad2_s3 += share(interval_s, parameters_.rate_walk_memory_s) *
                              (change.squaredNorm() / interval_s - state_.rate_walk_rad2_s3);
}

void AttitudeEkf::start_alignment(const ImuSample& sample) {
  state_.tilt_is_known = false;
  state_.alignment = TiltAlignment(parameters_.alignment);
  if (!sample.accel_m_s2) return;
  // Upright as far as that goes: what is said of the vertical meanwhile is not far from it.
  Eigen::Quaterniond& q = state_.filter.mean().q_world_imu;
  state_.alignment.start(q * *sample.accel_m_s2);
  q = (state_.alignment.turn_upright({}) * q).normalized();
  state_.alignment = TiltAlignment(parameters_.alignment);
  state_.alignment.start(q * *sample.accel_m_s2);
}

void AttitudeEkf::restart_tilt(const ImuSample& sample) {
  begin_anew(sample.time);
  start_alignment(sample);
  // Nothing is known of the turn meanwhile: heading less than tilt, which the accelerometer shows.
  ErrorCovariance& P = state_.filter.covariance();
  set_variance(P, Index::attitude, {0, 0, kUnknownAngle_rad2});
  state_.heading_held_back_variance_rad2 = 0;
  const double interval_s = to_seconds(sample.time - state_.last->time);
  P.diagonal().segment<3>(Index::gyro_bias).array() +=
      square(parameters_.gyro_bias_walk_rad_s_rts) * interval_s;
  P.diagonal().segment<3>(Index::accel_bias).array() +=
      square(parameters_.accel_bias_walk_m_s2_rts) * interval_s;
  end_step();
}

/// Up is where the last forces come from. What led astray may have bent the bias too.
void AttitudeEkf::realign(SensorTime time) {
  ++state_.counts.realignments;
  begin_anew(time);
  const TiltWatch watch = std::exchange(state_.tilt_watch, TiltWatch(parameters_.tilt_watch));
  InertialState& mean = state_.filter.mean();
  mean.q_world_imu =
      (gimbal::turn_upright(watch.recent_force_m_s2()) * mean.q_world_imu).normalized();
  mean.velocity_m_s.setZero();
  state_.velocity_mean_m_s.setZero();
  ErrorCovariance& P = state_.filter.covariance();
  const double sigma_rad = parameters_.tilt_watch.realigned_sigma_rad;
  const double velocity_sigma_m_s =
      sigma_rad * kGravity_m_s2 * parameters_.tilt_watch.recent_s / std::numbers::sqrt2;
  const double heading_variance = P(Index::attitude + 2, Index::attitude + 2);
  set_variance(P, Index::attitude, {square(sigma_rad), square(sigma_rad), heading_variance});
  set_variance(P, Index::velocity, Eigen::Vector3d::Constant(square(velocity_sigma_m_s)));
  set_variance(P, Index::gyro_bias,
               P.diagonal()
                   .segment<3>(Index::gyro_bias)
                   .cwiseMax(square(parameters_.bias_change_between_runs_rad_s)));
  end_step();
}

/// The covariance of what the gyroscope alone said so far is much the same in all directions: it is
/// kept as it is.
void AttitudeEkf::become_upright() {
  const TiltAlignment& alignment = state_.alignment;
  WorldTurn& world = state_.step.world_turn.emplace();
  world.turn = alignment.turn_upright({});
  InertialState& mean = state_.filter.mean();
  mean.q_world_imu = (world.turn * mean.q_world_imu).normalized();
  mean.velocity_m_s.setZero();
  state_.velocity_mean_m_s.setZero();
  state_.seen_velocity_density_m2_s =
      std::max(parameters_.start_velocity_density_m2_s,
               parameters_.machine_density_s * square(machine_velocity_m_s()));
  state_.accel_mean_square_m2_s4 = alignment.accel_mean_square_m2_s4();

  ErrorCovariance& P = state_.filter.covariance();
  world.rows = -P.topRows<3>();
  ErrorTransition turned_unseen;
  turned_unseen.attitude_by_gyro_bias =
      world.turn.toRotationMatrix() * alignment.turn_by_gyro_bias_s();
  turned_unseen.attitude_by_gyro_bias.row(2).setZero();  // a heading is what it was
  turned_unseen.propagate(P);
  set_variance(P, Index::velocity, Eigen::Vector3d::Constant(alignment.velocity_variance_m2_s2()));
  P.diagonal().segment<2>(Index::attitude).array() += alignment.tilt_variance_rad2();
  const double with_velocity = alignment.velocity_tilt_covariance();
  P(Index::attitude + 1, Index::velocity) = P(Index::velocity, Index::attitude + 1) = with_velocity;
  P(Index::attitude, Index::velocity + 1) = P(Index::velocity + 1, Index::attitude) =
      -with_velocity;
  world.rows += P.topRows<3>();
  world.attitude_by_gyro_bias = turned_unseen.attitude_by_gyro_bias;
  state_.tilt_is_known = true;
  state_.tilt_watch = TiltWatch(parameters_.tilt_watch);
}

void AttitudeEkf::begin_step(SensorTime time) {
  state_.step = {};
  state_.step.time = time;
}

void AttitudeEkf::begin_anew(SensorTime time) {
  begin_step(time);
  state_.step.transition.is_continuous = false;
  state_.filter.discard_step();
}

void AttitudeEkf::end_step() {
  state_.step.attitude_rows = state_.filter.covariance().topRows<3>();
  ++state_.step_count;
}

void AttitudeEkf::close_step(SensorTime time) {
  const ErrorStateFilter::Pending pending = state_.filter.pending();
  begin_step(time);
  state_.step.transition = state_.filter.close_step(
      {parameters_.gyro_bias_walk_rad_s_rts, parameters_.accel_bias_walk_m_s2_rts});
  if (state_.tilt_is_known) {
    if (pending.accel_interval_s > 0) bound_motion(pending);
  } else {
    state_.alignment.add(pending, machine_velocity_m_s());
    // Before it is known what is up, forces show no velocity.
    state_.step.transition.keep_velocity();
    set_variance(state_.filter.covariance(), Index::velocity, Eigen::Vector3d::Zero());
  }
  watch_bias(pending);
  state_.heading_held_back_rad += state_.step.attitude_correction.z();
  const double bias_variance =
      state_.filter.covariance().diagonal().segment<3>(Index::gyro_bias).maxCoeff();
  if (!state_.tilt_is_known && state_.alignment.is_done(bias_variance)) become_upright();
  end_step();
}

void AttitudeEkf::bound_motion(const ErrorStateFilter::Pending& step) {
  const Eigen::Vector3d beside_gravity =
      step.velocity_m_s / step.accel_interval_s - Eigen::Vector3d(0, 0, kGravity_m_s2);
  state_.accel_mean_square_m2_s4 += share(step.accel_interval_s, parameters_.accel_memory_s) *
                                    (beside_gravity.squaredNorm() - state_.accel_mean_square_m2_s4);
  bound_velocity(step);
  bound_acceleration(step);
}

void AttitudeEkf::bound_velocity(const ErrorStateFilter::Pending& step) {
  learn_velocity_density(step.accel_interval_s);
  const double density =
      std::max(parameters_.velocity_density_m2_s +
                   parameters_.velocity_density_by_accel_s3 * state_.accel_mean_square_m2_s4,
               state_.seen_velocity_density_m2_s);
  for (int i = 0; i < 3; ++i) {
    measure(Index::velocity + i, -state_.filter.mean().velocity_m_s(i),
            density / step.accel_interval_s);
  }
}

void AttitudeEkf::learn_velocity_density(double interval_s) {
  const double mean_s = parameters_.velocity_mean_s;
  Eigen::Vector3d& mean = state_.velocity_mean_m_s;
  mean += share(interval_s, mean_s) * (state_.filter.mean().velocity_m_s - mean);
  // Of a white noise, such a mean has its density over twice the time constant as variance.
  const double seen = 2 * mean_s * mean.squaredNorm() / 3;
  state_.seen_velocity_density_m2_s +=
      share(interval_s, parameters_.velocity_memory_s) * (seen - state_.seen_velocity_density_m2_s);
}

void AttitudeEkf::bound_acceleration(const ErrorStateFilter::Pending& step) {
  const auto tilt_variance = state_.filter.covariance().diagonal().segment<2>(Index::attitude);
  if (tilt_variance.mean() < square(parameters_.coarse_tilt_sigma_rad)) return;
  const double fast_density_m2_s =
      std::max(state_.seen_velocity_density_m2_s - parameters_.start_velocity_density_m2_s, 0.0);
  const double density = parameters_.accel_density_m2_s3 +
                         parameters_.accel_density_by_accel_s * state_.accel_mean_square_m2_s4 +
                         parameters_.accel_density_by_velocity_s2 * fast_density_m2_s;
  const double variance = density / step.accel_interval_s / square(kGravity_m_s2);
  const Eigen::Vector3d force = step.velocity_m_s / step.accel_interval_s;
  // A small tilt by θ shows gravity's reaction along θ x (0, 0, g), with the opposite sign.
  measure(Index::attitude, force.y() / kGravity_m_s2, variance);
  measure(Index::attitude + 1, -force.x() / kGravity_m_s2, variance);
}

double AttitudeEkf::machine_velocity_m_s() const {
  const AttitudeEkfParameters& p = parameters_;
  if (state_.steadiness.rate_density_rad2_s() < p.parked_density_rad2_s) return 0;
  return p.machine_velocity_m_s * state_.vibration.machine_share();
}

void AttitudeEkf::watch_bias(const ErrorStateFilter::Pending& step) {
  const Eigen::Vector3d rate = step.turn_rad / step.interval_s;
  const Eigen::Vector3d change = rate - state_.rate_mean_rad_s;
  const double memory_s = parameters_.rate_memory_s;
  state_.rate_mean_rad_s += share(step.interval_s, memory_s) * change;
  // The variance remembers longer than the mean that it is taken about.
  state_.rate_variance_rad2_s2 += share(step.interval_s, 1.5 * memory_s) *
                                  (change.squaredNorm() - state_.rate_variance_rad2_s2);
  state_.steadiness.add(step.turn_rad, step.interval_s);
  if (state_.rate_mean_rad_s.cwiseAbs().maxCoeff() > parameters_.largest_bias_rad_s) return;
  const double variance = rate_density() / step.interval_s;
  const double newest = share(step.interval_s, memory_s);
  const double hold_variance =
      square(parameters_.hold_rate_rad_s) + state_.rate_variance_rad2_s2 * newest / (2 - newest);
  for (int i = 0; i < 3; ++i) {
    const double bias = state_.filter.mean().gyro_bias_rad_s(i);
    const int k = Index::gyro_bias + i;
    const double doubt = 1 + square(square(state_.rate_mean_rad_s(i) - bias) /
                                    (hold_variance + state_.filter.covariance()(k, k)));
    measure(Index::gyro_bias + i, rate(i) - bias, variance * doubt);
  }
}

/// As a measurement of the bias, rad²/s.
double AttitudeEkf::rate_density() const {
  const AttitudeEkfParameters& p = parameters_;
  const double by_variance =
      p.rate_density_s * (state_.rate_variance_rad2_s2 + square(p.steadiest_rate_rad_s));
  const double by_blocks =
      p.steady_doubt * state_.steadiness.rate_density_rad2_s() + p.steadiest_density_rad2_s;
  return std::min(by_variance, by_blocks);
}

void AttitudeEkf::measure(int index, double residual, double noise_variance) {
  FilterStep& step = state_.step;
  ScalarUpdate& update = step.updates[step.update_count++];
  update = state_.filter.measure(index, residual, noise_variance);
  step.attitude_correction += residual * update.gain.segment<3>(Index::attitude);
  // Residuals are independent of each other and of the error that is left: variances add up.
  const double heading_gain = update.gain(Index::attitude + 2);
  state_.heading_held_back_variance_rad2 += heading_gain * heading_gain * update.variance;
}

AttitudeEstimate AttitudeEkf::predict(SensorTime time) const {
  AttitudeEstimate estimate{
      {time, shown_attitude()}, state_.filter.attitude_covariance(), AttitudeOrigin::predicted};
  estimate.covariance_rad2(2, 2) += state_.heading_held_back_variance_rad2;
  if (!state_.tilt_is_known) {
    estimate.covariance_rad2.diagonal().head<2>().array() += state_.alignment.tilt_variance_rad2();
  }
  if (!state_.last || time < state_.last->time) return estimate;
  const double ahead_s = to_seconds(time - state_.last->time);
  if (ahead_s == 0) {
    estimate.origin = AttitudeOrigin::exact;
    return estimate;
  }
  const InertialState& mean = state_.filter.mean();
  const Eigen::Vector3d unbiased = state_.last->gyro_rad_s - mean.gyro_bias_rad_s;
  const Eigen::Vector3d rate = unbiased - mean.gyro_scale.cwiseProduct(unbiased);
  // Beyond the longest bridge the rate is worth nothing, and the orientation is held.
  if (ahead_s <= to_seconds(parameters_.longest_bridge)) {
    estimate.attitude.q_world_imu =
        (estimate.attitude.q_world_imu * rotation_from_vector(ahead_s * rate)).normalized();
  }
  // A random walk's integral away from its last known value, and what is not known of the bias.
  const double bias_variance =
      state_.filter.covariance().diagonal().segment<3>(Index::gyro_bias).maxCoeff();
  const double variance = state_.rate_walk_rad2_s3 * ahead_s * ahead_s * ahead_s / 3 +
                          square(parameters_.gyro_noise_rad_s_rthz) * ahead_s +
                          bias_variance * ahead_s * ahead_s;
  estimate.covariance_rad2.diagonal().array() += std::min(variance, kUnknownAngle_rad2);
  return estimate;
}

GyroBias AttitudeEkf::gyro_bias() const {
  return {state_.filter.mean().gyro_bias_rad_s,
          state_.filter.covariance().diagonal().segment<3>(Index::gyro_bias).cwiseSqrt()};
}

Eigen::Quaterniond AttitudeEkf::turn_upright() const {
  if (state_.tilt_is_known) return Eigen::Quaterniond::Identity();
  return state_.alignment.turn_upright(state_.filter.pending());
}

Eigen::Quaterniond AttitudeEkf::shown_attitude() const {
  const Eigen::Quaterniond upright = turn_upright() * state_.filter.mean().q_world_imu;
  return (turn_about_vertical(-state_.heading_held_back_rad) * upright).normalized();
}

}  // namespace gimbal
