#include "daemon/output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "daemon/journal.hpp"
#include "drivers/clock/monotonic_now.hpp"

namespace gimbal {
namespace {

/// A hiccup of a consumer shorter than this many frames costs nothing.
constexpr std::size_t kHeldFrames = 8;
constexpr std::chrono::seconds kFirstBackoff{1};
constexpr std::chrono::seconds kLongestBackoff{30};

}  // namespace

Output::Output(OutputTarget target, double fps, SensorDuration delay)
    : target_(std::move(target)),
      fps_(fps),
      delay_(delay),
      frames_(kHeldFrames),
      backoff_(kFirstBackoff) {
  thread_ = std::thread([this] { run(); });
}

Output::~Output() {
  finish();
}

void Output::finish() {
  frames_.close();
  if (thread_.joinable()) thread_.join();
}

void Output::run() {
  while (const auto frame = frames_.pop()) {
    const SensorTime begin = monotonic_now();
    if (write(*frame)) {
      const SensorTime end = monotonic_now();
      writing_time_.add(end - begin);
      written_age_.add(end - frame->stamp.time);
      ++written_;
    } else {
      ++lost_;
    }
  }
  close();
}

bool Output::write(const VideoFrame& frame) {
  if (is_gone_) return false;
  if (!sink_ && std::chrono::steady_clock::now() < next_try_) return false;
  const auto written = open_for(frame).and_then([&] { return sink_->write(frame); });
  if (!written) {
    fail(written.error());
    return false;
  }
  backoff_ = kFirstBackoff;
  works_ = true;
  return true;
}

Result<void> Output::open_for(const VideoFrame& frame) {
  if (sink_) return {};
  auto sink = target_.open({frame.size, fps_, frame.color, LiveTiming{frame.stamp.time, delay_}});
  if (!sink) return tl::unexpected(sink.error());
  sink_ = std::move(*sink);
  return {};
}

void Output::fail(const Error& error) {
  sink_.reset();
  works_ = false;
  is_gone_ = target_.reopening == Reopening::impossible;
  if (is_gone_) {
    log_line(LogLevel::error, fmt::format("output {}: {}", target_.name, error.message));
    return;
  }
  log_line(LogLevel::error, fmt::format("output {}: {}; trying again in {} s", target_.name,
                                        error.message, backoff_.count()));
  next_try_ = std::chrono::steady_clock::now() + backoff_;
  backoff_ = std::min(2 * backoff_, kLongestBackoff);
}

void Output::close() {
  if (!sink_) return;
  if (const auto finished = sink_->finish(); !finished) {
    log_line(LogLevel::error, fmt::format("output {}: {}", target_.name, finished.error().message));
  }
  for (const std::string& warning : sink_->warnings()) log_line(LogLevel::warning, warning);
  sink_.reset();
}

}  // namespace gimbal
