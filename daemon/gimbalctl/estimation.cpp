#include "daemon/gimbalctl/estimation.hpp"

#include <variant>

#include "drivers/replay/replay_imu.hpp"
#include "pipeline/timing/imu_aligner.hpp"

namespace gimbal {

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
