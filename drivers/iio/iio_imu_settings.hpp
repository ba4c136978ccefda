#pragma once

#include <chrono>
#include <string>

#include "drivers/clock/stamp_gate.hpp"
#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

/// How an IMU of the kernel's Industrial I/O subsystem is used.
struct IioImuSettings {
  /// The gyroscope: "auto", or a device's name ("bmi160"), id ("iio:device0") or label.
  std::string device = "auto";
  /// The accelerometer: as above, or "none". "auto" is the gyroscope's own device if it has one,
  /// else the one that goes with it.
  std::string accel_device = "auto";
  /// The nearest rate that the device offers at or above this is set.
  double rate_hz = 200;
  /// Name of the trigger that starts each sample. Empty: the one that is set is kept, else the
  /// device's own, else one by a timer is made.
  std::string trigger = {};
  /// Samples that the kernel may hold while the reader is away.
  unsigned buffer_length = 256;
  /// How long a device may deliver nothing until that is an error.
  SensorDuration silence_limit = std::chrono::seconds(2);
  /// How long one of two devices is waited for, to keep their samples in order of time.
  SensorDuration merge_patience = std::chrono::milliseconds(100);
  /// What is done with stamps that are not on CLOCK_MONOTONIC.
  ForeignClock foreign_clock = ForeignClock::map;

  bool operator==(const IioImuSettings&) const = default;
};

}  // namespace gimbal
