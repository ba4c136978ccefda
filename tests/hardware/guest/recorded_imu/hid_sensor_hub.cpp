#include "tests/hardware/guest/recorded_imu/hid_sensor_hub.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/uhid.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <utility>

#include "drivers/clock/monotonic_now.hpp"
#include "tests/hardware/guest/recorded_imu/hid_descriptor.hpp"

namespace gimbal {
namespace {

using Item = HidDescriptor::Item;

// Usages: the page in the upper half, as linux/hid-sensor-ids.h has them.
constexpr int kSensorHub = 0x200001;
constexpr int kAccelerometer3d = 0x200073;
constexpr int kGyrometer3d = 0x200076;
constexpr int kAccelerationX = 0x200453;  // Y and Z follow
constexpr int kAngularVelocityX = 0x200457;
constexpr int kTimestamp = 0x200529;
constexpr int kReportInterval = 0x20030e;
constexpr int kReportingState = 0x200316;
constexpr int kPowerState = 0x200319;
constexpr int kReportingStates = 0x200840;  // no events, all events, ...
constexpr int kPowerStates = 0x200850;      // undefined, full power, ...
constexpr int kStates = 6;

// Units, likewise.
constexpr int kMetresPerSecondSquared = 0x11e0;
constexpr int kRadiansPerSecond = 0x12f0;
constexpr int kMilliseconds = 0x19;

constexpr int kPhysical = 0;
constexpr int kApplication = 1;
constexpr int kLogical = 2;
constexpr int kArray = 0;
constexpr int kVariable = 2;

// Powers of ten, so that the IIO `scale` is exact in the nine decimals that it is printed with.
constexpr int kAccelExponent = -5;
constexpr int kGyroExponent = -6;
constexpr int kStampExponent = -3;

void add_states(HidDescriptor& descriptor, int property, int first_state) {
  descriptor.add(Item::usage, property);
  descriptor.add(Item::logical_minimum, 0);
  descriptor.add(Item::logical_maximum, kStates - 1);
  descriptor.add(Item::report_size, 8);
  descriptor.add(Item::report_count, 1);
  descriptor.add(Item::collection, kLogical);
  for (int state = 0; state < kStates; ++state) descriptor.add(Item::usage, first_state + state);
  descriptor.add(Item::feature, kArray);
  descriptor.end_collection();
}

void add_interval(HidDescriptor& descriptor) {
  descriptor.add(Item::usage, kReportInterval);
  descriptor.add(Item::logical_minimum, 0);
  descriptor.add(Item::logical_maximum, INT32_MAX);
  descriptor.add(Item::report_size, 32);
  descriptor.add(Item::report_count, 1);
  descriptor.add(Item::feature, kVariable);
}

void add_axes(HidDescriptor& descriptor, int first_axis, int unit, int exponent) {
  descriptor.add(Item::unit, unit);
  descriptor.add(Item::unit_exponent, exponent & 0xf);  // four bits, two's complement
  descriptor.add(Item::logical_minimum, INT32_MIN);
  descriptor.add(Item::logical_maximum, INT32_MAX);
  descriptor.add(Item::report_size, 32);
  for (int axis = 0; axis < 3; ++axis) {
    descriptor.add(Item::usage, first_axis + axis);
    descriptor.add(Item::input, kVariable);
  }
}

void add_stamp(HidDescriptor& descriptor) {
  descriptor.add(Item::unit, kMilliseconds);
  descriptor.add(Item::unit_exponent, kStampExponent & 0xf);
  descriptor.add(Item::logical_minimum, 0);
  descriptor.add(Item::report_size, 64);
  descriptor.add(Item::usage, kTimestamp);
  descriptor.add(Item::input, kVariable);
  descriptor.add(Item::unit, 0);
  descriptor.add(Item::unit_exponent, 0);
}

void add_sensor(HidDescriptor& descriptor, int report, int kind, int first_axis, int unit,
                int exponent) {
  descriptor.add(Item::usage, kind);
  descriptor.add(Item::collection, kPhysical);
  descriptor.add(Item::report_id, report);
  add_states(descriptor, kReportingState, kReportingStates);
  add_states(descriptor, kPowerState, kPowerStates);
  add_interval(descriptor);
  add_axes(descriptor, first_axis, unit, exponent);
  add_stamp(descriptor);
  descriptor.end_collection();
}

HidDescriptor describe_hub(int accel_report, int gyro_report) {
  HidDescriptor descriptor;
  descriptor.add(Item::usage_page, kSensorHub >> 16);  // by this the kernel tells a hub
  descriptor.add(Item::usage, kSensorHub);
  descriptor.add(Item::collection, kApplication);
  add_sensor(descriptor, accel_report, kAccelerometer3d, kAccelerationX, kMetresPerSecondSquared,
             kAccelExponent);
  add_sensor(descriptor, gyro_report, kGyrometer3d, kAngularVelocityX, kRadiansPerSecond,
             kGyroExponent);
  descriptor.end_collection();
  return descriptor;
}

std::int32_t quantized(double value, int exponent) {
  return static_cast<std::int32_t>(std::lround(value * std::pow(10.0, -exponent)));
}

std::int64_t in_microseconds(SensorTime stamp) {
  return std::chrono::floor<std::chrono::microseconds>(stamp.time_since_epoch()).count();
}

Result<void> write_event(int fd, const uhid_event& event) {
  if (::write(fd, &event, sizeof event) < 0) {
    return failed(fmt::format("/dev/uhid: {}", std::strerror(errno)));
  }
  return {};
}

/// One report: its number, then its content.
template <typename Content>
std::uint16_t put_report(std::uint8_t* data, std::uint8_t number, const Content& content) {
  data[0] = number;
  std::memcpy(data + 1, content.data(), sizeof content);
  return 1 + sizeof content;
}

}  // namespace

Result<HidSensorHub> HidSensorHub::plug_in(SensorDuration interval) {
  const int fd = ::open("/dev/uhid", O_RDWR | O_CLOEXEC);
  if (fd < 0) return failed(fmt::format("/dev/uhid: {}", std::strerror(errno)));
  HidSensorHub hub(fd, interval);

  const auto descriptor =
      describe_hub(static_cast<int>(Sensor::accel), static_cast<int>(Sensor::gyro));
  uhid_event event{};
  event.type = UHID_CREATE2;
  auto& create = event.u.create2;
  constexpr std::string_view kName = "recorded IMU";
  std::memcpy(create.name, kName.data(), kName.size());
  std::ranges::copy(descriptor.bytes(), create.rd_data);
  create.rd_size = static_cast<std::uint16_t>(descriptor.bytes().size());
  create.bus = 3;           // BUS_USB in linux/input.h: what hid-sensor-hub looks for
  create.vendor = 0x1209;   // pid.codes, a vendor for open projects
  create.product = 0x0001;  // its product number for tests
  if (auto created = write_event(fd, event); !created) return tl::unexpected(created.error());
  return hub;
}

HidSensorHub::HidSensorHub(int fd, SensorDuration interval) : fd_(fd) {
  const auto milliseconds =
      static_cast<std::uint32_t>(std::chrono::round<std::chrono::milliseconds>(interval).count());
  for (Feature& feature : features_) {
    std::memcpy(feature.data() + 2, &milliseconds, sizeof milliseconds);
  }
}

HidSensorHub::HidSensorHub(HidSensorHub&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)), features_(other.features_), inputs_(other.inputs_) {}

HidSensorHub::~HidSensorHub() {
  if (fd_ >= 0) ::close(fd_);
}

Result<void> HidSensorHub::send_gyro(const Eigen::Vector3d& gyro_rad_s, Stamp stamp) {
  return send(Sensor::gyro, gyro_rad_s, kGyroExponent, stamp);
}

Result<void> HidSensorHub::send_accel(const Eigen::Vector3d& accel_m_s2, Stamp stamp) {
  return send(Sensor::accel, accel_m_s2, kAccelExponent, stamp);
}

Result<void> HidSensorHub::send(Sensor sensor, const Eigen::Vector3d& value, int exponent,
                                Stamp stamp) {
  const auto report = static_cast<std::uint8_t>(sensor);
  const std::array axes = {quantized(value.x(), exponent), quantized(value.y(), exponent),
                           quantized(value.z(), exponent)};
  const std::int64_t stamp_us = stamp ? in_microseconds(*stamp) : 0;
  Input& input = inputs_.at(report);
  std::memcpy(input.data(), axes.data(), sizeof axes);
  std::memcpy(input.data() + sizeof axes, &stamp_us, sizeof stamp_us);
  uhid_event event{};
  event.type = UHID_INPUT2;
  event.u.input2.size = put_report(event.u.input2.data, report, input);
  return write_event(fd_, event);
}

Result<void> HidSensorHub::answer_until(SensorTime end) {
  for (SensorTime now = monotonic_now(); now < end; now = monotonic_now()) {
    const auto left = std::chrono::duration_cast<std::chrono::nanoseconds>(end - now).count();
    const timespec timeout{left / std::nano::den, left % std::nano::den};
    pollfd waiting{.fd = fd_, .events = POLLIN, .revents = 0};
    if (::ppoll(&waiting, 1, &timeout, nullptr) <= 0) continue;
    if (auto answered = answer_one(); !answered) return answered;
  }
  return {};
}

Result<void> HidSensorHub::answer_one() {
  uhid_event question{};
  if (::read(fd_, &question, sizeof question) <= 0) {
    return failed(fmt::format("/dev/uhid: {}", std::strerror(errno)));
  }
  uhid_event answer{};
  if (question.type == UHID_GET_REPORT) {
    const auto& asked = question.u.get_report;
    const std::uint8_t report = asked.rnum < features_.size() ? asked.rnum : std::uint8_t{0};
    auto& reply = answer.u.get_report_reply;
    answer.type = UHID_GET_REPORT_REPLY;
    reply.id = asked.id;
    reply.size = asked.rtype == UHID_FEATURE_REPORT
                     ? put_report(reply.data, report, features_.at(report))
                     : put_report(reply.data, report, inputs_.at(report));
    return write_event(fd_, answer);
  }
  if (question.type == UHID_SET_REPORT) {
    const auto& asked = question.u.set_report;
    if (asked.rnum < features_.size() && asked.size > sizeof(Feature)) {
      std::memcpy(features_.at(asked.rnum).data(), asked.data + 1, sizeof(Feature));
    }
    answer.type = UHID_SET_REPORT_REPLY;
    answer.u.set_report_reply.id = asked.id;
    return write_event(fd_, answer);
  }
  return {};
}

}  // namespace gimbal
