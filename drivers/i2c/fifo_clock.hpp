#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

/// Finds when a chip took each sample of its FIFO from nothing but how many samples there were, and
/// when that was asked. The chip's oscillator is off by up to some percent, and the asking thread
/// is late by milliseconds now and then; the stamps suffer from neither.
///
/// Each count bounds two instants: what was counted had been taken when the answer was there, and
/// what was not had not been taken when the question went out. A straight line, sample by sample,
/// that keeps within all bounds of the last seconds has the chip's period as its slope. Late
/// questions only give loose bounds. Bounds become tight as the questions fall on all phases of the
/// period, so whoever asks should vary when.
class FifoClock {
 public:
  explicit FifoClock(SensorDuration nominal_period);

  /// `waiting` samples were in the FIFO at some instant between the two.
  void observe(SensorTime asked, SensorTime answered, std::uint64_t waiting);

  /// The instant of the next sample, in the order of the FIFO; strictly rising.
  [[nodiscard]] SensorTime take();

  /// Samples that the chip must have taken until `time`, beyond those that `take` has stamped.
  [[nodiscard]] std::uint64_t waiting_at(SensorTime time) const;

  /// The FIFO was emptied unread: the next sample is one that is yet to come. What is known of the
  /// period stays.
  void restart();

  [[nodiscard]] double period_s() const { return period_s_; }

 private:
  /// Before or after an instant, for a sample; seconds after `origin_`.
  struct Bound {
    double index;
    double time_s;
  };
  /// The tightest bounds of a short time.
  struct Bucket {
    double begin_s = 0;
    std::optional<Bound> upper;
    std::optional<Bound> lower;
  };

  [[nodiscard]] double seconds_of(SensorTime time) const { return to_seconds(time - origin_); }
  Bucket& bucket_at(double time_s);
  void fit();
  [[nodiscard]] double lowest_upper(double period_s) const;
  [[nodiscard]] double highest_lower(double period_s) const;
  [[nodiscard]] double room(double period_s) const;
  [[nodiscard]] double roomiest_period() const;
  [[nodiscard]] double edge_of_room(double inside_s, double outside_s) const;

  double prior_period_s_;
  double prior_spread_;  ///< how far off the prior may be, as a part of it
  double period_s_;
  double half_width_s_;  ///< of the periods that the bounds allow
  double phase_s_ = 0;   ///< of sample 0
  SensorTime origin_;
  std::deque<Bucket> buckets_;
  std::uint64_t taken_ = 0;
  std::optional<SensorTime> last_;
};

}  // namespace gimbal
