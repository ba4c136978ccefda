#pragma once

#include <cstdint>
#include <string>

namespace gimbal {

enum class ProgressStyle : std::uint8_t {
  automatic,  ///< drawn when standard error is a terminal
  quiet,
};

/// A line on standard error that shows how far a job is. Nothing is written into a pipe or file.
class ProgressBar {
 public:
  /// `total`: how many steps make the whole; 0 if unknown.
  ProgressBar(std::string label, std::int64_t total, ProgressStyle style);
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  ~ProgressBar();

  void advance();

 private:
  void draw() const;

  std::string label_;
  std::int64_t total_;
  std::int64_t done_ = 0;
  int drawn_percent_ = -1;
  bool visible_;
};

}  // namespace gimbal
