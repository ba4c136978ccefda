// Plays a session's gyro and accelerometer through the kernel, each sample when its stamp says,
// over and over until a signal ends it. Before each pass the IMU lies still for a while, as it does
// when the recording begins; when that is over, the time is printed, in ns on CLOCK_MONOTONIC.
// Usage: recorded_imu SESSION REST_S
// The kernel stamps the samples. SIGUSR1 makes the IMU's own clock say so from then on, five
// seconds ahead; a second one ends that.

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <variant>
#include <vector>

#include "drivers/clock/monotonic_now.hpp"
#include "drivers/replay/session.hpp"
#include "tests/hardware/guest/recorded_imu/hid_sensor_hub.hpp"

namespace gimbal {
namespace {

constexpr std::chrono::seconds kAhead{5};

/// A signal's handler has nothing else that it may write to.
volatile std::sig_atomic_t is_ahead = 0;

void change_clock(int) {
  is_ahead = is_ahead == 0 ? 1 : 0;
}

HidSensorHub::Stamp stamp_for_now() {
  if (is_ahead == 0) return std::nullopt;
  return monotonic_now() + kAhead;
}

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
  const HidSensorHub::Stamp stamp = stamp_for_now();
  if (const auto* gyro = std::get_if<GyroSample>(&sample)) {
    return hub.send_gyro(gyro->gyro_rad_s, stamp);
  }
  return hub.send_accel(std::get<AccelSample>(sample).accel_m_s2, stamp);
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

/// Lies still at the first sample's place.
Result<void> rest(HidSensorHub& hub, const Session& session, SensorTime start, SensorTime end) {
  const SensorDuration interval = mean_interval(session.gyro);
  for (SensorTime time = start; time < end; time += interval) {
    auto sent = hub.answer_until(time)
                    .and_then([&] {
                      return hub.send_gyro({0, 0, 0}, stamp_for_now());
                    })
                    .and_then([&] {
                      return hub.send_accel(session.accel.front().accel_m_s2, stamp_for_now());
                    });
    if (!sent) return sent;
  }
  return {};
}

Result<void> play_forever(const char* folder, SensorDuration rest_time) {
  const auto session = open_session(folder);
  if (!session) return tl::unexpected(session.error());
  if (session->gyro.size() < 2 || session->accel.empty()) {
    return bad_input(fmt::format("{}: no samples", folder));
  }
  const SensorDuration interval = mean_interval(session->gyro);
  const std::vector<Sample> samples = samples_of(*session);
  const SensorDuration length = time_of(samples.back()) - time_of(samples.front()) + interval;
  auto hub = HidSensorHub::plug_in(interval);
  if (!hub) return tl::unexpected(hub.error());
  for (SensorTime start = monotonic_now() + rest_time;; start += length + rest_time) {
    if (auto rested = rest(*hub, *session, start - rest_time, start); !rested) return rested;
    fmt::print("{}\n", start.time_since_epoch().count());
    std::fflush(stdout);
    if (auto played = play(*hub, samples, start); !played) return played;
  }
}

}  // namespace
}  // namespace gimbal

int main(int argc, char** argv) {
  if (argc != 3) {
    fmt::print(stderr, "usage: recorded_imu SESSION REST_S\n");
    return 2;
  }
  std::signal(SIGUSR1, gimbal::change_clock);
  const auto played = gimbal::play_forever(argv[1], std::chrono::seconds(std::atoi(argv[2])));
  if (!played) fmt::print(stderr, "recorded_imu: {}\n", played.error().message);
  return played ? 0 : 1;
}
