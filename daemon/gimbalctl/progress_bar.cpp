#include "daemon/gimbalctl/progress_bar.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace gimbal {
namespace {

/// Unlike fmt::print this does not throw: a terminal that goes away must not end the work.
void show(const std::string& text) {
  static_cast<void>(std::fputs(text.c_str(), stderr));
}

}  // namespace

ProgressBar::ProgressBar(std::string label, std::int64_t total, ProgressStyle style)
    : label_(std::move(label)),
      total_(total),
      visible_(style == ProgressStyle::automatic && total > 0 && isatty(STDERR_FILENO) != 0) {}

ProgressBar::~ProgressBar() {
  if (visible_) show("\n");
}

void ProgressBar::advance() {
  ++done_;
  if (!visible_) return;
  const int percent = static_cast<int>(std::min<std::int64_t>(100, 100 * done_ / total_));
  if (percent == drawn_percent_) return;
  drawn_percent_ = percent;
  draw();
}

void ProgressBar::draw() const {
  constexpr int kWidth = 40;
  const auto filled = static_cast<std::size_t>(drawn_percent_ * kWidth / 100);
  show(
      fmt::format("\r{} [{:<{}}] {:3}%", label_, std::string(filled, '#'), kWidth, drawn_percent_));
}

}  // namespace gimbal
