#include "drivers/iio/iio_stream.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <string>

#include "drivers/iio/device_setup.hpp"

namespace gimbal {
namespace {

/// One number of a buffer, by the channel's byte order, shift, bits and sign.
template <typename Signed, typename Unsigned>
std::int64_t convert(const iio_channel& channel, const void* raw) {
  if (iio_channel_get_data_format(&channel)->is_signed) {
    Signed value = 0;
    iio_channel_convert(&channel, &value, raw);
    return value;
  }
  Unsigned value = 0;
  iio_channel_convert(&channel, &value, raw);
  return static_cast<std::int64_t>(value);
}

std::int64_t convert(const iio_channel& channel, const void* raw) {
  switch (iio_channel_get_data_format(&channel)->length) {
    case 8:
      return convert<std::int8_t, std::uint8_t>(channel, raw);
    case 16:
      return convert<std::int16_t, std::uint16_t>(channel, raw);
    case 32:
      return convert<std::int32_t, std::uint32_t>(channel, raw);
    default:
      return convert<std::int64_t, std::uint64_t>(channel, raw);
  }
}

bool is_plain_number(const iio_channel& channel) {
  const iio_data_format& format = *iio_channel_get_data_format(&channel);
  const bool is_word =
      format.length == 8 || format.length == 16 || format.length == 32 || format.length == 64;
  return is_word && format.repeat <= 1;
}

std::string open_error(const iio_device& device) {
  const int error = errno;
  const std::string title = title_of(device);
  if (error == EBUSY) return fmt::format("{}: another program reads it", title);
  return fmt::format("{}: cannot enable its buffer: {}", title, iio_error_text(-error));
}

}  // namespace

Result<IioStream> IioStream::open(const iio_device& device, const std::vector<IioTriad>& sensors,
                                  unsigned buffer_length) {
  IioStream stream(device);
  if (auto enabled = stream.enable(sensors); !enabled) return tl::unexpected(enabled.error());
  if (auto started = stream.start(buffer_length); !started) return tl::unexpected(started.error());
  return stream;
}

Result<void> IioStream::enable(const std::vector<IioTriad>& sensors) {
  for (unsigned i = 0; i < iio_device_get_channels_count(device_); ++i) {
    iio_channel_disable(iio_device_get_channel(device_, i));
  }
  std::vector<iio_channel*> channels{find_timestamp(*device_)};
  for (const IioTriad triad : sensors) {
    auto scaling = read_scaling(*device_, triad);
    if (!scaling) return tl::unexpected(scaling.error());
    sensors_.push_back({triad, *scaling});
    for (int axis = 0; axis < 3; ++axis) channels.push_back(find_axis(*device_, triad, axis));
  }
  for (iio_channel* channel : channels) {
    if (!is_plain_number(*channel)) {
      return failed(fmt::format("{}: {} has a format that is not understood", title_of(*device_),
                                iio_channel_get_id(channel)));
    }
    iio_channel_enable(channel);
  }
  return {};
}

/// Reading never blocks: libiio would wait for a full buffer, and throw away part of one when its
/// time is over.
Result<void> IioStream::start(unsigned buffer_length) {
  buffer_.reset(iio_device_create_buffer(device_, buffer_length, false));
  if (!buffer_) return failed(open_error(*device_));
  const int error = iio_buffer_set_blocking_mode(buffer_.get(), false);
  fd_ = iio_buffer_get_poll_fd(buffer_.get());
  if (error < 0 || fd_ < 0) {
    return failed(fmt::format("{}: its buffer cannot be read without waiting: {}",
                              title_of(*device_), iio_error_text(error < 0 ? error : fd_)));
  }
  return {};
}

Result<std::vector<IioScan>> IioStream::drain() {
  std::vector<IioScan> scans;
  while (true) {
    const auto bytes = iio_buffer_refill(buffer_.get());
    if (bytes == -EAGAIN) return scans;
    if (bytes == 0) {
      return failed(fmt::format("{}: its buffer has been put off", title_of(*device_)));
    }
    if (bytes < 0) {
      return failed(fmt::format("{}: cannot be read any more: {}", title_of(*device_),
                                iio_error_text(bytes)));
    }
    decode(scans);
  }
}

void IioStream::decode(std::vector<IioScan>& scans) const {
  const iio_channel& timestamp = *find_timestamp(*device_);
  const auto* begin = static_cast<const char*>(iio_buffer_start(buffer_.get()));
  const auto* end = static_cast<const char*>(iio_buffer_end(buffer_.get()));
  const std::ptrdiff_t step = iio_buffer_step(buffer_.get());
  for (std::ptrdiff_t offset = 0; offset + step <= end - begin; offset += step) {
    IioScan scan{.stamp = SensorTime(SensorDuration(read_raw(timestamp, offset))),
                 .gyro_rad_s = {},
                 .accel_m_s2 = {}};
    for (const Sensor& sensor : sensors_) {
      auto& reading = sensor.triad == IioTriad::gyro ? scan.gyro_rad_s : scan.accel_m_s2;
      reading = read_axes(sensor, offset);
    }
    scans.push_back(scan);
  }
}

Eigen::Vector3d IioStream::read_axes(const Sensor& sensor, std::ptrdiff_t offset) const {
  Eigen::Vector3d raw;
  for (int axis = 0; axis < 3; ++axis) {
    const iio_channel& channel = *find_axis(*device_, sensor.triad, axis);
    raw[axis] = static_cast<double>(read_raw(channel, offset));
  }
  return sensor.scaling.apply(raw);
}

/// `offset`: of the scan, from the buffer's first.
std::int64_t IioStream::read_raw(const iio_channel& channel, std::ptrdiff_t offset) const {
  return convert(channel,
                 static_cast<const char*>(iio_buffer_first(buffer_.get(), &channel)) + offset);
}

}  // namespace gimbal
