#include "drivers/clock/sequence_counter.hpp"

#include <limits>

namespace gimbal {

SequenceCounter::Step SequenceCounter::next(std::uint32_t sequence) {
  const bool is_first = !last_.has_value();
  const std::uint32_t step = is_first ? 0 : sequence - *last_;
  last_ = sequence;
  if (is_first) return {index_, 0};
  const bool has_risen = step != 0 && step <= std::numeric_limits<std::uint32_t>::max() / 2;
  index_ += has_risen ? step : 1;
  return {index_, has_risen ? step - 1 : 0};
}

}  // namespace gimbal
