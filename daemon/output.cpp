#include "daemon/output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "daemon/journal.hpp"

namespace gimbal {
namespace {

/// A hiccup of a consumer shorter than this many frames costs nothing.
constexpr std::size_t kHeldFrames = 8;
constexpr std::chrono::seconds kFirstBackoff{1};
constexpr std::chrono::seconds kLongestBackoff{30};

}  // namespace

Output::Output(std::string to, double fps)
    : to_(std::move(to)), fps_(fps), frames_(kHeldFrames), backoff_(kFirstBackoff) {
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
    if (write(*frame)) {
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
  return true;
}

Result<void> Output::open_for(const VideoFrame& frame) {
  if (sink_) return {};
  auto sink = open_sink(to_, {frame.size, fps_, frame.color}, std::nullopt);
  if (!sink) return tl::unexpected(sink.error());
  sink_ = std::move(*sink);
  return {};
}

void Output::fail(const Error& error) {
  sink_.reset();
  // Standard output cannot be opened again, and a file would lose what it holds.
  is_gone_ = to_.find(" ! ") == std::string::npos;
  if (is_gone_) {
    log_line(LogLevel::error, fmt::format("output {}: {}", to_, error.message));
    return;
  }
  log_line(LogLevel::error, fmt::format("output {}: {}; trying again in {} s", to_, error.message,
                                        backoff_.count()));
  next_try_ = std::chrono::steady_clock::now() + backoff_;
  backoff_ = std::min(2 * backoff_, kLongestBackoff);
}

void Output::close() {
  if (!sink_) return;
  if (const auto finished = sink_->finish(); !finished) {
    log_line(LogLevel::error, fmt::format("output {}: {}", to_, finished.error().message));
  }
  for (const std::string& warning : sink_->warnings()) log_line(LogLevel::warning, warning);
  sink_.reset();
}

}  // namespace gimbal
