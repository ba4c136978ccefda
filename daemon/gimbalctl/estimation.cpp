#include "daemon/gimbalctl/estimation.hpp"

#include <utility>
#include <variant>

#include "drivers/replay/replay_imu.hpp"
#include "pipeline/estimator/thesis_ekf.hpp"
#include "pipeline/timing/imu_aligner.hpp"

namespace gimbal {

const std::map<std::string, EstimatorKind>& estimator_names() {
  static const std::map<std::string, EstimatorKind> names = {{"ekf", EstimatorKind::ekf},
                                                             {"thesis", EstimatorKind::thesis}};
  return names;
}

std::unique_ptr<AttitudeStream> make_attitudes(EstimatorKind kind, const Lookahead& lookahead) {
  if (kind == EstimatorKind::thesis) return make_causal_stream(std::make_unique<ThesisEkf>());
  if (lookahead.lag && *lookahead.lag <= SensorDuration::zero()) {
    return make_causal_stream(AttitudeEkfParameters{});
  }
  FixedLagSmootherParameters parameters;
  parameters.lag = lookahead.lag;
  return make_smoothed_stream(parameters);
}

Result<void> replay_samples(const Session& session,
                            const std::function<void(const ImuSample&)>& take) {
  ImuAligner aligner(session.accel.empty() ? Accelerometer::absent : Accelerometer::present);
  const auto take_aligned = [&] {
    while (const auto sample = aligner.pop()) take(*sample);
  };
  ReplayImu imu(session);
  if (auto started = imu.start(); !started) return started;
  while (true) {
    const auto reading = imu.read();
    if (!reading) return tl::unexpected(reading.error());
    if (!*reading) break;
    std::visit([&](const auto& sample) { aligner.push(sample); }, **reading);
    take_aligned();
  }
  aligner.finish();
  take_aligned();
  return {};
}

}  // namespace gimbal
