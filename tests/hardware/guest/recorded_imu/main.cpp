// Plays a session's gyro and accelerometer through the kernel, each sample when its stamp says,
// over and over until a signal ends it. Usage: recorded_imu SESSION

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <variant>
#include <vector>

#include "drivers/clock/monotonic_now.hpp"
#include "drivers/replay/session.hpp"
#include "tests/hardware/guest/recorded_imu/hid_sensor_hub.hpp"

namespace gimbal {
namespace {

using Sample = std::variant<GyroSample, AccelSample>;

SensorTime time_of(const Sample& sample) {
  return std::visit([](const auto& one) { return one.time; }, sample);
}

/// Both logs in order of time.
std::vector<Sample> samples_of(const Session& session) {
  std::vector<Sample> samples(session.gyro.begin(), session.gyro.end());
  samples.insert(samples.end(), session.accel.begin(), session.accel.end());
  std::ranges::stable_sort(samples, {}, time_of);
  return samples;
}

SensorDuration mean_interval(const std::vector<GyroSample>& gyro) {
  const auto intervals = static_cast<SensorDuration::rep>(gyro.size() - 1);
  return (gyro.back().time - gyro.front().time) / intervals;
}

Result<void> send(HidSensorHub& hub, const Sample& sample) {
  if (const auto* gyro = std::get_if<GyroSample>(&sample)) return hub.send_gyro(gyro->gyro_rad_s);
  return hub.send_accel(std::get<AccelSample>(sample).accel_m_s2);
}

Result<void> play(HidSensorHub& hub, const std::vector<Sample>& samples, SensorTime start) {
  const SensorTime first = time_of(samples.front());
  for (const Sample& sample : samples) {
    auto sent = hub.answer_until(start + (time_of(sample) - first)).and_then([&] {
      return send(hub, sample);
    });
    if (!sent) return sent;
  }
  return {};
}

Result<void> play_forever(const char* folder) {
  const auto session = open_session(folder);
  if (!session) return tl::unexpected(session.error());
  if (session->gyro.size() < 2) return bad_input(fmt::format("{}: no gyro samples", folder));
  const SensorDuration interval = mean_interval(session->gyro);
  const std::vector<Sample> samples = samples_of(*session);
  const SensorDuration length = time_of(samples.back()) - time_of(samples.front()) + interval;
  auto hub = HidSensorHub::plug_in(interval);
  if (!hub) return tl::unexpected(hub.error());
  for (SensorTime start = monotonic_now();; start += length) {
    if (auto played = play(*hub, samples, start); !played) return played;
  }
}

}  // namespace
}  // namespace gimbal

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: recorded_imu SESSION\n");
    return 2;
  }
  const auto played = gimbal::play_forever(argv[1]);
  if (!played) fmt::print(stderr, "recorded_imu: {}\n", played.error().message);
  return played ? 0 : 1;
}
