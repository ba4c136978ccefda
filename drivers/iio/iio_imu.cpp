#include "drivers/iio/iio_imu.hpp"

#include <fmt/format.h>
#include <poll.h>

#include <utility>

#include "drivers/clock/monotonic_now.hpp"
#include "drivers/clock/stamp_gate.hpp"
#include "drivers/iio/device_choice.hpp"
#include "drivers/iio/device_setup.hpp"
#include "drivers/iio/gap_counter.hpp"
#include "drivers/iio/iio_stream.hpp"
#include "drivers/iio/libiio.hpp"
#include "drivers/iio/sample_merger.hpp"
#include "drivers/iio/trigger.hpp"
#include "drivers/stop_event.hpp"

namespace gimbal {
namespace {

/// Some drivers wake a reader only when much is there, so it looks by itself now and then.
constexpr int kLookEvery_ms = 20;

/// A device that delivers, with what is known of its stamps.
struct Feed {
  std::string title;
  IioStream stream;
  StampGate gate;
  GapCounter gaps;
  SensorTime last_arrival;
  std::vector<std::string> remarks;
};

class IioImu final : public ImuSource {
 public:
  explicit IioImu(IioImuSettings settings)
      : settings_(std::move(settings)), merger_(0, settings_.merge_patience) {}
  ~IioImu() override { close(); }

  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] Result<std::optional<ImuReading>> read() override;
  void stop() override { stop_.set(); }
  [[nodiscard]] std::uint64_t lost() const override;
  [[nodiscard]] std::vector<std::string> remarks() const override;

 private:
  [[nodiscard]] Result<void> open_feeds();
  [[nodiscard]] Result<void> open_feed(const std::string& id, const std::vector<IioTriad>& sensors);
  void wait_for_samples() const;
  [[nodiscard]] Result<void> drain_feeds();
  [[nodiscard]] Result<void> take(std::size_t index, const IioScan& scan, SensorTime arrival);
  [[nodiscard]] Result<void> check_silence(SensorTime now) const;
  void close();

  const IioImuSettings settings_;
  StopEvent stop_;
  IioContext context_;
  std::vector<Feed> feeds_;
  SampleMerger merger_;
};

Result<void> IioImu::start() {
  close();
  stop_.clear();
  auto opened = open_feeds();
  if (!opened) close();
  return opened;
}

/// Buffers before the context that they belong to.
void IioImu::close() {
  feeds_.clear();
  context_.reset();
}

Result<void> IioImu::open_feeds() {
  auto context = scan_iio_devices();
  if (!context) return tl::unexpected(context.error());
  context_ = *std::move(context);
  const auto choice = choose_devices(find_candidates(*context_), settings_);
  if (!choice) return tl::unexpected(choice.error());
  std::vector<IioTriad> sensors{IioTriad::gyro};
  const bool is_one_device = choice->accel == choice->gyro;
  if (is_one_device) sensors.push_back(IioTriad::accel);
  if (auto opened = open_feed(choice->gyro, sensors); !opened) return opened;
  if (choice->accel && !is_one_device) {
    if (auto opened = open_feed(*choice->accel, {IioTriad::accel}); !opened) return opened;
  }
  merger_ = SampleMerger(feeds_.size(), settings_.merge_patience);
  return {};
}

Result<void> IioImu::open_feed(const std::string& id, const std::vector<IioTriad>& sensors) {
  const iio_device& device = *iio_context_find_device(context_.get(), id.c_str());
  const std::string title = title_of(device);
  if (auto set = set_monotonic_clock(device); !set) return set;
  std::vector<std::string> remarks;
  for (const IioTriad sensor : sensors) {
    const auto rate_hz = set_rate(device, sensor, settings_.rate_hz);
    if (!rate_hz) return tl::unexpected(rate_hz.error());
    if (*rate_hz && **rate_hz < 0.99 * settings_.rate_hz) {
      remarks.push_back(fmt::format("{}: runs at {:g} Hz, not at {:g}; it offers no more", title,
                                    **rate_hz, settings_.rate_hz));
    }
  }
  if (auto set = prepare_trigger({}, id, settings_.trigger, settings_.rate_hz); !set) return set;
  auto stream = IioStream::open(device, sensors, settings_.buffer_length);
  if (!stream) return tl::unexpected(stream.error());
  feeds_.push_back({title, *std::move(stream), StampGate(title, settings_.foreign_clock),
                    GapCounter(), monotonic_now(), std::move(remarks)});
  return {};
}

Result<std::optional<ImuReading>> IioImu::read() {
  while (!stop_.is_set()) {
    if (feeds_.empty()) return failed("iio: read before it was started");
    if (auto reading = merger_.pop(monotonic_now())) return reading;
    wait_for_samples();
    if (auto drained = drain_feeds(); !drained) return tl::unexpected(drained.error());
    if (auto heard = check_silence(monotonic_now()); !heard) return tl::unexpected(heard.error());
  }
  return std::optional<ImuReading>();
}

void IioImu::wait_for_samples() const {
  std::vector<pollfd> waiting{{.fd = stop_.fd(), .events = POLLIN, .revents = 0}};
  for (const Feed& feed : feeds_) {
    waiting.push_back({.fd = feed.stream.fd(), .events = POLLIN, .revents = 0});
  }
  poll(waiting.data(), waiting.size(), kLookEvery_ms);
}

Result<void> IioImu::drain_feeds() {
  for (std::size_t i = 0; i < feeds_.size(); ++i) {
    const auto scans = feeds_[i].stream.drain();
    if (!scans) return tl::unexpected(scans.error());
    const SensorTime arrival = monotonic_now();
    for (const IioScan& scan : *scans) {
      if (auto taken = take(i, scan, arrival); !taken) return taken;
    }
  }
  return {};
}

Result<void> IioImu::take(std::size_t index, const IioScan& scan, SensorTime arrival) {
  Feed& feed = feeds_[index];
  feed.last_arrival = arrival;
  const auto time = feed.gate.pass(scan.stamp, arrival);
  if (!time) return tl::unexpected(time.error());
  if (!*time) return {};
  feed.gaps.take(**time);
  if (scan.gyro_rad_s) merger_.push(index, GyroSample{**time, *scan.gyro_rad_s}, arrival);
  if (scan.accel_m_s2) merger_.push(index, AccelSample{**time, *scan.accel_m_s2}, arrival);
  return {};
}

Result<void> IioImu::check_silence(SensorTime now) const {
  for (const Feed& feed : feeds_) {
    if (now - feed.last_arrival < settings_.silence_limit) continue;
    return failed(fmt::format("{}: no sample for {:.1f} s; its trigger or interrupt does not fire",
                              feed.title, to_seconds(now - feed.last_arrival)));
  }
  return {};
}

std::uint64_t IioImu::lost() const {
  std::uint64_t lost = merger_.dropped();
  for (const Feed& feed : feeds_) lost += feed.gate.refused() + feed.gaps.missing();
  return lost;
}

std::vector<std::string> IioImu::remarks() const {
  std::vector<std::string> lines;
  for (const Feed& feed : feeds_) {
    lines.insert(lines.end(), feed.remarks.begin(), feed.remarks.end());
    const auto of_gate = feed.gate.remarks();
    lines.insert(lines.end(), of_gate.begin(), of_gate.end());
  }
  return lines;
}

}  // namespace

Result<std::unique_ptr<ImuSource>> open_iio_imu(const IioImuSettings& settings) {
  if (settings.rate_hz <= 0) return bad_input("iio: rate_hz must be above 0");
  if (settings.buffer_length < 1) return bad_input("iio: buffer_length must be at least 1");
  const auto context = scan_iio_devices();
  if (!context) return tl::unexpected(context.error());
  if (const auto choice = choose_devices(find_candidates(**context), settings); !choice) {
    return tl::unexpected(choice.error());
  }
  return std::make_unique<IioImu>(settings);
}

}  // namespace gimbal
