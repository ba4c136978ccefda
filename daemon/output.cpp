#include "daemon/output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <utility>

#include "daemon/journal.hpp"
#include "drivers/clock/monotonic_now.hpp"
#include "pipeline/queue/bounded_queue.hpp"
#include "pipeline/sink/frame_sink.hpp"

namespace gimbal {
namespace {

/// A hiccup of a consumer shorter than this many frames costs nothing.
constexpr std::size_t kHeldFrames = 8;
constexpr std::chrono::seconds kFirstBackoff{1};
constexpr std::chrono::seconds kLongestBackoff{30};
/// Of an output that shall end; a file's index may take its time.
constexpr std::chrono::milliseconds kLongestStep{1500};
constexpr std::chrono::milliseconds kLongestEnd{6000};

}  // namespace

class Output::Writer {
 public:
  Writer(OutputTarget target, double fps, SensorDuration delay)
      : target_(std::move(target)),
        fps_(fps),
        delay_(delay),
        frames_(kHeldFrames),
        backoff_(kFirstBackoff) {}

  void run();

  void offer(const VideoFrame& frame) { frames_.push(frame); }
  void end() { frames_.close(); }

  /// Steps of the work so far, and how long one may take at most.
  [[nodiscard]] std::uint64_t steps() const { return steps_; }
  [[nodiscard]] std::chrono::milliseconds patience() const {
    return is_ending_ ? kLongestEnd : kLongestStep;
  }

  [[nodiscard]] const std::string& name() const { return target_.name; }
  [[nodiscard]] std::uint64_t written() const { return written_; }
  [[nodiscard]] std::uint64_t dropped() const { return frames_.dropped() + lost_; }
  [[nodiscard]] Histogram::Counts writing_time() const { return writing_time_.counts(); }
  [[nodiscard]] Histogram::Counts written_age() const { return written_age_.counts(); }
  [[nodiscard]] std::size_t queued() const { return frames_.size(); }
  [[nodiscard]] OutputState state() const { return state_; }
  [[nodiscard]] bool is_gone() const { return is_gone_; }

 private:
  [[nodiscard]] bool write(const VideoFrame& frame);
  [[nodiscard]] Result<void> open_for(const VideoFrame& frame);
  void fail(const Error& error);
  void close();

  const OutputTarget target_;
  const double fps_;
  const SensorDuration delay_;
  BoundedQueue<VideoFrame, WhenFull::drop_oldest> frames_;
  std::unique_ptr<FrameSink> sink_;
  bool was_open_ = false;
  std::chrono::steady_clock::time_point opened_;
  std::chrono::steady_clock::time_point next_try_;
  std::chrono::seconds backoff_;
  std::atomic<std::uint64_t> written_ = 0;
  std::atomic<std::uint64_t> lost_ = 0;  ///< while there was no sink
  std::atomic<OutputState> state_ = OutputState::starting;
  std::atomic<bool> is_gone_ = false;
  std::atomic<std::uint64_t> steps_ = 0;
  std::atomic<bool> is_ending_ = false;
  Histogram writing_time_;
  Histogram written_age_;
};

void Output::Writer::run() {
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
    ++steps_;
  }
  is_ending_ = true;
  ++steps_;
  close();
}

bool Output::Writer::write(const VideoFrame& frame) {
  if (is_gone_) return false;
  if (!sink_ && std::chrono::steady_clock::now() < next_try_) return false;
  const auto written = open_for(frame).and_then([&] { return sink_->write(frame); });
  if (!written) {
    fail(written.error());
    return false;
  }
  // Some pipelines take a frame or two before they find that they cannot work.
  if (std::chrono::steady_clock::now() - opened_ > backoff_) backoff_ = kFirstBackoff;
  state_ = OutputState::working;
  return true;
}

Result<void> Output::Writer::open_for(const VideoFrame& frame) {
  if (sink_) return {};
  auto sink = target_.open({frame.size, fps_, frame.color, LiveTiming{frame.stamp.time, delay_}});
  if (!sink) return tl::unexpected(sink.error());
  sink_ = std::move(*sink);
  was_open_ = true;
  opened_ = std::chrono::steady_clock::now();
  return {};
}

void Output::Writer::fail(const Error& error) {
  sink_.reset();
  state_ = OutputState::failed;
  is_gone_ = target_.reopening == Reopening::impossible ||
             (target_.reopening == Reopening::until_open && was_open_);
  if (is_gone_) {
    log_line(LogLevel::error, fmt::format("output {}: {}", target_.name, error.message),
             {"output", target_.name});
    return;
  }
  log_line(LogLevel::error,
           fmt::format("output {}: {}; trying again in {} s", target_.name, error.message,
                       backoff_.count()),
           {"output", target_.name});
  next_try_ = std::chrono::steady_clock::now() + backoff_;
  backoff_ = std::min(2 * backoff_, kLongestBackoff);
}

void Output::Writer::close() {
  is_gone_ = is_gone_ || (target_.reopening == Reopening::until_open && !was_open_ && lost_ > 0);
  if (!sink_) return;
  if (const auto finished = sink_->finish(); !finished) {
    log_line(LogLevel::error, fmt::format("output {}: {}", target_.name, finished.error().message),
             {"output", target_.name});
  }
  for (const std::string& warning : sink_->warnings())
    log_line(LogLevel::warning, warning, {"output", target_.name});
  sink_.reset();
}

Output::Output(OutputTarget target, double fps, SensorDuration delay)
    : writer_(std::make_shared<Writer>(std::move(target), fps, delay)) {
  std::promise<void> ended;
  ended_ = ended.get_future();
  thread_ = std::thread([writer = writer_, ended = std::move(ended)]() mutable {
    writer->run();
    ended.set_value();
  });
}

Output::~Output() {
  finish();
}

void Output::end() {
  writer_->end();
}

void Output::finish() {
  if (!thread_.joinable()) return;
  end();
  using Clock = std::chrono::steady_clock;
  const auto deadline = Clock::now() + kLongestEnd;
  for (std::uint64_t steps = writer_->steps(); Clock::now() < deadline;) {
    const auto look = std::min(Clock::now() + writer_->patience(), deadline);
    if (ended_.wait_until(look) == std::future_status::ready) return thread_.join();
    if (writer_->steps() == steps) break;
    steps = writer_->steps();
  }
  log_line(
      LogLevel::error,
      fmt::format("output {}: does not end, as if nobody read it; it is left as it is", name()),
      {"output", name()});
  thread_.detach();
}

void Output::offer(const VideoFrame& frame) {
  writer_->offer(frame);
}

const std::string& Output::name() const {
  return writer_->name();
}

std::uint64_t Output::written() const {
  return writer_->written();
}

std::uint64_t Output::dropped() const {
  return writer_->dropped();
}

Histogram::Counts Output::writing_time() const {
  return writer_->writing_time();
}

Histogram::Counts Output::written_age() const {
  return writer_->written_age();
}

std::size_t Output::queued() const {
  return writer_->queued();
}

OutputState Output::state() const {
  return writer_->state();
}

bool Output::is_gone() const {
  return writer_->is_gone();
}

}  // namespace gimbal
