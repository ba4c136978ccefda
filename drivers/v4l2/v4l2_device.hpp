#pragma once

#include <linux/videodev2.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/clock/kernel_clock.hpp"
#include "pipeline/sample/result.hpp"
#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

/// An open node, as the kernel shows it. All errors are values of errno. Only `cancel` may be
/// called while another thread is in `wait`; the caller sees to the rest.
class V4l2Device {
 public:
  V4l2Device() = default;
  V4l2Device(const V4l2Device&) = delete;
  V4l2Device& operator=(const V4l2Device&) = delete;
  virtual ~V4l2Device() = default;

  /// ioctl(2), again where a signal interrupts it: 0, or the error.
  [[nodiscard]] virtual int request(unsigned long code, void* argument) = 0;

  /// A buffer's memory, to be read; nullptr if that fails.
  [[nodiscard]] virtual std::uint8_t* map(std::size_t bytes, std::int64_t offset) = 0;
  virtual void unmap(std::uint8_t* memory, std::size_t bytes) = 0;

  enum class Wakeup : std::uint8_t { picture, timeout, cancelled, error };
  [[nodiscard]] virtual Wakeup wait(SensorDuration limit) = 0;

  /// Ends this wait and every later one. Any thread.
  virtual void cancel() = 0;

  /// What a clock says now; nothing where there is no such clock.
  [[nodiscard]] virtual std::optional<SensorDuration> read_clock(KernelClock clock) const = 0;
};

/// The nodes of a machine.
class V4l2System {
 public:
  V4l2System() = default;
  V4l2System(const V4l2System&) = delete;
  V4l2System& operator=(const V4l2System&) = delete;
  virtual ~V4l2System() = default;

  /// Paths of all video nodes, in the order of their numbers.
  [[nodiscard]] virtual std::vector<std::string> nodes() const = 0;

  /// The error says why not, and what to do.
  [[nodiscard]] virtual Result<std::unique_ptr<V4l2Device>> open(const std::string& path) const = 0;

  /// The image sensor whose pictures come out of a node, where that is a device of its own and
  /// the only one; else nullptr.
  [[nodiscard]] virtual std::unique_ptr<V4l2Device> open_sensor(const std::string& path) const = 0;

  /// Other programs that hold a node open, such as "cheese (pid 812)"; empty where none is seen.
  [[nodiscard]] virtual std::string users_of(const std::string& path) const = 0;
};

[[nodiscard]] std::shared_ptr<const V4l2System> kernel_v4l2();

}  // namespace gimbal
