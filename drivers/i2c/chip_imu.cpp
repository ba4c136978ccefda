#include "drivers/i2c/chip_imu.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <utility>

#include "drivers/clock/monotonic_now.hpp"
#include "drivers/i2c/edge_matcher.hpp"
#include "drivers/i2c/fifo_clock.hpp"
#include "drivers/stop_event.hpp"

namespace gimbal {
namespace {

using std::chrono::milliseconds;

/// A FIFO that is empty for so long after the start never fills.
constexpr SensorDuration kEmptyLimit = milliseconds(300);

/// So many reads of a FIFO may fail one after the other.
constexpr int kMostBadReads = 3;

class ChipImu final : public ImuSource {
 public:
  ChipImu(std::unique_ptr<ImuChip> chip, const I2cImuSettings& settings,
          std::unique_ptr<EdgeSource> data_ready)
      : chip_(std::move(chip)),
        settings_(settings),
        data_ready_(std::move(data_ready)),
        delivery_(settings.delivery),
        clock_(chip_->nominal_period()) {}

  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] Result<std::optional<ImuReading>> read() override;
  void stop() override;
  [[nodiscard]] std::uint64_t lost() const override { return lost_; }
  [[nodiscard]] std::vector<std::string> remarks() const override;

 private:
  [[nodiscard]] Result<void> wait_until(SensorTime time);
  [[nodiscard]] Result<void> wait_for_edge();
  void take_edge(const Edge& edge);

  [[nodiscard]] Result<void> drain_fifo();
  [[nodiscard]] Result<void> take_from_fifo(std::size_t samples);
  [[nodiscard]] Result<void> give_up_fifo(std::size_t samples);
  [[nodiscard]] SensorTime next_drain();
  void fall_back_to_polling(SensorTime now);

  [[nodiscard]] Result<void> poll_once();
  [[nodiscard]] Result<SensorTime> poll_time();

  [[nodiscard]] Result<void> check_silence(SensorTime now) const;
  void deliver(SensorTime time, const ChipReading& reading);

  std::unique_ptr<ImuChip> chip_;
  I2cImuSettings settings_;
  std::unique_ptr<EdgeSource> data_ready_;  ///< may be null
  StopEvent stop_;

  SampleDelivery delivery_;
  FifoClock clock_;
  EdgeMatcher edges_;
  std::optional<SensorTime> newest_edge_;
  std::uint64_t edges_since_poll_ = 0;
  std::deque<ImuReading> ready_;

  SensorTime started_;
  SensorTime last_sample_;  ///< or the start
  SensorTime next_look_;
  double dither_ = 0;
  std::optional<SensorTime> last_stamp_;
  bool has_delivered_ = false;
  int bad_reads_ = 0;
  std::uint64_t lost_ = 0;
  std::uint64_t overflows_ = 0;
  std::uint64_t bus_faults_ = 0;
};

Result<void> ChipImu::start() {
  stop_.clear();
  ready_.clear();
  edges_.clear();
  newest_edge_.reset();
  last_stamp_.reset();
  edges_since_poll_ = lost_ = overflows_ = bus_faults_ = 0;
  bad_reads_ = 0;
  has_delivered_ = false;
  delivery_ = settings_.delivery;
  clock_ = FifoClock(chip_->nominal_period());
  if (auto configured = chip_->configure(); !configured) return configured;
  if (data_ready_) {
    if (auto started = data_ready_->start(); !started) return started;
  }
  if (auto restarted = chip_->restart_fifo(); !restarted) return restarted;
  started_ = last_sample_ = next_look_ = monotonic_now();
  return {};
}

void ChipImu::stop() {
  stop_.set();
  if (data_ready_) data_ready_->stop();
}

Result<std::optional<ImuReading>> ChipImu::read() {
  while (!stop_.is_set()) {
    if (!ready_.empty()) {
      const ImuReading reading = ready_.front();
      ready_.pop_front();
      return reading;
    }
    auto done = delivery_ == SampleDelivery::fifo ? drain_fifo() : poll_once();
    if (done) done = check_silence(monotonic_now());
    if (!done) return tl::unexpected(done.error());
  }
  return std::optional<ImuReading>();
}

/// Collects edges meanwhile.
Result<void> ChipImu::wait_until(SensorTime time) {
  if (!data_ready_) {
    [[maybe_unused]] const bool is_stopped =
        stop_.wait_for(std::max(time - monotonic_now(), SensorDuration::zero()));
    return {};
  }
  while (true) {
    const auto edge = data_ready_->read_until(time);
    if (!edge) return tl::unexpected(edge.error());
    if (!*edge) return {};
    take_edge(**edge);
  }
}

void ChipImu::take_edge(const Edge& edge) {
  if (edge.direction != EdgeDirection::rising) return;
  edges_.take(edge.time);
  newest_edge_ = edge.time;
  ++edges_since_poll_;
}

Result<void> ChipImu::drain_fifo() {
  if (auto waited = wait_until(next_drain()); !waited) return waited;
  if (stop_.is_set()) return {};
  const SensorTime asked = monotonic_now();
  const auto level = chip_->fifo_level();
  const SensorTime answered = monotonic_now();
  if (!level) return tl::unexpected(level.error());
  if (level->has_overflowed) {
    ++overflows_;
    return give_up_fifo(level->samples);
  }
  clock_.observe(asked, answered, level->samples);
  if (level->samples > 0) return take_from_fifo(level->samples);
  fall_back_to_polling(answered);
  return {};
}

/// The moments of asking go through all phases of the chip's period, golden section by golden
/// section, which the clock needs.
SensorTime ChipImu::next_drain() {
  constexpr double kGoldenSection = 0.6180339887498949;
  dither_ = std::fmod(dither_ + kGoldenSection, 1.0);
  next_look_ = std::max(next_look_ + settings_.drain_period, monotonic_now());
  return next_look_ + duration_from_seconds(dither_ * clock_.period_s());
}

Result<void> ChipImu::take_from_fifo(std::size_t samples) {
  const auto readings = chip_->read_fifo(samples);
  if (!readings) {
    ++bus_faults_;
    if (++bad_reads_ >= kMostBadReads) return tl::unexpected(readings.error());
    return give_up_fifo(samples);
  }
  bad_reads_ = 0;
  const SensorDuration period = duration_from_seconds(clock_.period_s());
  for (const auto& reading : *readings) {
    const SensorTime time = edges_.match(clock_.take(), period);
    if (reading) {
      deliver(time, *reading);
    } else {
      ++lost_;
    }
  }
  return {};
}

/// What is in the FIFO cannot be told apart any more, and is lost: the samples that it holds, and
/// those that it no longer holds.
Result<void> ChipImu::give_up_fifo(std::size_t samples) {
  lost_ += std::max<std::uint64_t>(samples, clock_.waiting_at(monotonic_now()));
  clock_.restart();
  edges_.clear();
  return chip_->restart_fifo();
}

void ChipImu::fall_back_to_polling(SensorTime now) {
  if (has_delivered_ || now - started_ < kEmptyLimit) return;
  delivery_ = SampleDelivery::polling;
  last_sample_ = next_look_ = now;
}

Result<void> ChipImu::poll_once() {
  const auto time = poll_time();
  if (!time) return tl::unexpected(time.error());
  if (stop_.is_set()) return {};
  const SensorTime asked = monotonic_now();
  const auto reading = chip_->read_latest();
  if (!reading) return tl::unexpected(reading.error());
  if (data_ready_) {
    if (*time != SensorTime::min()) deliver(*time, *reading);
    return {};
  }
  const SensorTime answered = monotonic_now();
  deliver(asked + (answered - asked) / 2 - chip_->nominal_period() / 2, *reading);
  return {};
}

/// Waits for the next sample; its edge's stamp, or the earliest time where no edge tells it.
Result<SensorTime> ChipImu::poll_time() {
  if (data_ready_) {
    if (auto waited = wait_for_edge(); !waited) return tl::unexpected(waited.error());
    return newest_edge_.value_or(SensorTime::min());
  }
  const SensorDuration period = chip_->nominal_period();
  next_look_ += period;
  const SensorDuration late = monotonic_now() - next_look_;
  if (late > period) {
    lost_ += static_cast<std::uint64_t>(late / period);
    next_look_ += (late / period) * period;
  }
  if (auto waited = wait_until(next_look_); !waited) return tl::unexpected(waited.error());
  return SensorTime::min();
}

/// The newest of those that wait; samples of the others have been overwritten.
Result<void> ChipImu::wait_for_edge() {
  edges_since_poll_ = 0;
  newest_edge_.reset();
  const auto edge = data_ready_->read_until(last_sample_ + settings_.silence_limit);
  if (!edge) return tl::unexpected(edge.error());
  if (*edge) take_edge(**edge);
  if (auto waited = wait_until(monotonic_now()); !waited) return waited;
  lost_ += std::max<std::uint64_t>(edges_since_poll_, 1) - 1;
  edges_.clear();
  return {};
}

Result<void> ChipImu::check_silence(SensorTime now) const {
  if (now - last_sample_ < settings_.silence_limit) return {};
  return failed(fmt::format("{}: no sample for {:.1f} s{}", chip_->title(),
                            to_seconds(now - last_sample_),
                            data_ready_ ? "; is its interrupt line connected?" : ""));
}

void ChipImu::deliver(SensorTime time, const ChipReading& reading) {
  last_sample_ = monotonic_now();
  if (last_stamp_ && time <= *last_stamp_) {
    ++lost_;
    return;
  }
  last_stamp_ = time;
  has_delivered_ = true;
  ready_.emplace_back(GyroSample{time, reading.gyro_rad_s});
  if (reading.accel_m_s2) ready_.emplace_back(AccelSample{time, *reading.accel_m_s2});
}

std::vector<std::string> ChipImu::remarks() const {
  std::vector<std::string> lines;
  if (delivery_ != settings_.delivery) {
    lines.push_back(
        fmt::format("{}: its FIFO stays empty, so it is polled; stamps are only as good as "
                    "half a period",
                    chip_->title()));
  }
  if (overflows_ > 0) {
    lines.push_back(fmt::format("{}: its FIFO ran over {} time(s)", chip_->title(), overflows_));
  }
  if (bus_faults_ > 0) {
    lines.push_back(fmt::format("{}: {} read(s) of its FIFO failed", chip_->title(), bus_faults_));
  }
  return lines;
}

}  // namespace

std::unique_ptr<ImuSource> make_chip_imu(std::unique_ptr<ImuChip> chip,
                                         const I2cImuSettings& settings,
                                         std::unique_ptr<EdgeSource> data_ready) {
  return std::make_unique<ChipImu>(std::move(chip), settings, std::move(data_ready));
}

Result<void> check_settings(const I2cImuSettings& settings) {
  const std::string where = to_string(settings.address);
  if (!(settings.rate_hz > 0)) return bad_input(where + ": rate_hz must be above 0");
  if (settings.drain_period <= SensorDuration::zero()) {
    return bad_input(where + ": the drain period must be above 0");
  }
  return {};
}

}  // namespace gimbal
