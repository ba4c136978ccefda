#pragma once

#include <iio.h>

#include <memory>
#include <optional>
#include <string>

#include "drivers/iio/device_choice.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

struct IioContextDeleter {
  void operator()(iio_context* context) const { iio_context_destroy(context); }
};
using IioContext = std::unique_ptr<iio_context, IioContextDeleter>;

struct IioBufferDeleter {
  void operator()(iio_buffer* buffer) const { iio_buffer_destroy(buffer); }
};
using IioBuffer = std::unique_ptr<iio_buffer, IioBufferDeleter>;

/// A look at the devices that this computer has now.
[[nodiscard]] Result<IioContext> scan_iio_devices();

/// A sensor with three axes, as IIO names its channels.
enum class IioTriad : std::uint8_t { gyro, accel };

/// One axis's channel, 0 to 2; null if the device has none.
[[nodiscard]] iio_channel* find_axis(const iio_device& device, IioTriad triad, int axis);

/// Null if the device stamps nothing.
[[nodiscard]] iio_channel* find_timestamp(const iio_device& device);

/// "iio:device0 (bmi160)"
[[nodiscard]] std::string title_of(const iio_device& device);

/// Of all devices that measure angular rate or specific force.
[[nodiscard]] std::vector<IioCandidate> find_candidates(const iio_context& context);

/// An attribute of a channel or, where that has none, of its device. Nothing if neither has it.
[[nodiscard]] std::optional<std::string> read_attribute(const iio_channel& channel,
                                                        const std::string& name);

/// A negative error number, as libiio returns it, in words.
[[nodiscard]] std::string iio_error_text(long error);

}  // namespace gimbal
