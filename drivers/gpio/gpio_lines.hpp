#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/edge_source.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// A line of a GPIO chip.
struct GpioAddress {
  std::string chip;  ///< "gpiochip0" or "/dev/gpiochip0"
  unsigned line = 0;
};

/// "gpiochip0:17"
[[nodiscard]] std::string to_string(const GpioAddress& address);

/// Reads "gpiochip0:17".
[[nodiscard]] Result<GpioAddress> parse_gpio_address(const std::string& text);

enum class GpioBias : std::uint8_t { as_is, pull_up, pull_down };
enum class GpioLevel : std::uint8_t { inactive, active };
enum class GpioPolarity : std::uint8_t { active_high, active_low };
enum class GpioEdges : std::uint8_t { rising, falling, both };

struct GpioInputSettings {
  GpioAddress address;
  GpioEdges edges = GpioEdges::both;
  GpioBias bias = GpioBias::as_is;
  GpioPolarity polarity = GpioPolarity::active_high;
};

struct GpioOutputSettings {
  GpioAddress address;
  GpioPolarity polarity = GpioPolarity::active_high;
};

/// An edge as the kernel gave it.
struct KernelEdge {
  SensorTime stamp;
  EdgeDirection direction = EdgeDirection::rising;
  /// Counts this line's edges from 1. The first uAPI for edges, which libgpiod 1.x uses, has none
  /// and loses edges unseen once more than 16 wait.
  std::optional<std::uint32_t> sequence;
};

/// A line that is watched for edges; the one place that libgpiod's versions differ in.
class GpioInput {
 public:
  /// bad_input where the line cannot be had.
  [[nodiscard]] static Result<std::unique_ptr<GpioInput>> open(const GpioInputSettings& settings);

  GpioInput() = default;
  GpioInput(const GpioInput&) = delete;
  GpioInput& operator=(const GpioInput&) = delete;
  virtual ~GpioInput() = default;

  /// Readable when edges wait.
  [[nodiscard]] virtual int fd() const = 0;

  /// The edges that wait; waits itself if there are none.
  [[nodiscard]] virtual Result<std::vector<KernelEdge>> read() = 0;
};

/// A line that is driven, such as a status LED or the flasher of a calibration.
class GpioOutput {
 public:
  /// The line begins inactive, and is given back when this goes. bad_input where it cannot be had.
  [[nodiscard]] static Result<std::unique_ptr<GpioOutput>> open(const GpioOutputSettings& settings);

  GpioOutput() = default;
  GpioOutput(const GpioOutput&) = delete;
  GpioOutput& operator=(const GpioOutput&) = delete;
  virtual ~GpioOutput() = default;

  /// Fails when the chip is gone.
  [[nodiscard]] virtual Result<void> set(GpioLevel level) = 0;
};

/// A chip as libgpiod shows it.
struct GpioChipInfo {
  std::string name;
  std::string label;
  unsigned lines = 0;
  std::vector<std::string> named_lines;  ///< "17 IMU_INT"
};

[[nodiscard]] Result<GpioChipInfo> read_gpio_chip(const std::string& path);

/// What stands in the way of opening a chip, by errno.
[[nodiscard]] std::string gpio_chip_obstacle(const std::string& path, int error);

/// What stands in the way of a line of a chip that is open, by errno.
[[nodiscard]] std::string gpio_line_obstacle(int error);

/// "/dev/gpiochip0"
[[nodiscard]] std::string gpio_chip_path(const std::string& chip);

}  // namespace gimbal
