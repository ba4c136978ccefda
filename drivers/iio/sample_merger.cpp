#include "drivers/iio/sample_merger.hpp"

namespace gimbal {

SensorTime time_of(const ImuReading& reading) {
  return std::visit([](const auto& sample) { return sample.time; }, reading);
}

SampleMerger::SampleMerger(std::size_t devices, SensorDuration patience)
    : waiting_(devices), patience_(patience) {}

void SampleMerger::push(std::size_t device, const ImuReading& reading, SensorTime arrival) {
  if (last_out_ && time_of(reading) < *last_out_) {
    ++dropped_;
    return;
  }
  waiting_[device].push_back({reading, arrival});
}

std::optional<ImuReading> SampleMerger::pop(SensorTime now) {
  std::deque<Arrival>* earliest = nullptr;
  bool all_offer = true;
  for (auto& lane : waiting_) {
    if (lane.empty()) {
      all_offer = false;
    } else if (!earliest || time_of(lane.front().reading) < time_of(earliest->front().reading)) {
      earliest = &lane;
    }
  }
  if (!earliest) return std::nullopt;
  if (!all_offer && now - earliest->front().time < patience_) return std::nullopt;
  const ImuReading reading = earliest->front().reading;
  earliest->pop_front();
  last_out_ = time_of(reading);
  return reading;
}

}  // namespace gimbal
