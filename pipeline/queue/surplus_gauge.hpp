#pragma once

#include <algorithm>
#include <cstddef>
#include <mutex>

namespace gimbal {

/// Tells a pool which of its things it need not keep: those that of late were never out at once
/// with all others. Without it a pool keeps for ever what a single hiccup made it grow to. For any
/// threads.
class SurplusGauge {
 public:
  /// `window`: how many things come back before a need that was not seen again is forgotten; if not
  /// told, some seconds of video.
  explicit SurplusGauge(std::size_t window = 300) : window_(window) {}

  void lent() {
    const std::scoped_lock lock(mutex_);
    ++out_;
    peak_ = std::max(peak_, out_);
    pooled_ = std::max(pooled_, out_);
  }

  /// Whether what comes back now is to be freed.
  [[nodiscard]] bool returned_for_good() {
    const std::scoped_lock lock(mutex_);
    --out_;
    if (++returned_ >= window_) begin_window();
    if (pooled_ <= std::max(needed_, peak_)) return false;
    --pooled_;
    return true;
  }

 private:
  void begin_window() {
    needed_ = peak_;
    peak_ = out_;
    returned_ = 0;
  }

  const std::size_t window_;
  std::mutex mutex_;
  std::size_t out_ = 0;
  std::size_t pooled_ = 0;  ///< out or waiting in the pool
  std::size_t peak_ = 0;    ///< most out at once in this window
  std::size_t needed_ =
      ~std::size_t{0};        ///< most out at once in the window before, once there was one
  std::size_t returned_ = 0;  ///< in this window
};

}  // namespace gimbal
