#include "pipeline/sink/y4m_sink.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <gst/video/video.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <iterator>
#include <utility>

namespace gimbal {
namespace {

/// Writing to a pipe without a reader then fails with EPIPE instead of ending the process. Only
/// this thread, and only for as long as the object lives: what the process does with SIGPIPE is its
/// own.
class PipeSignalBlock {
 public:
  PipeSignalBlock() {
    sigemptyset(&pipe_);
    sigaddset(&pipe_, SIGPIPE);
    sigset_t pending;
    sigpending(&pending);
    was_pending_ = sigismember(&pending, SIGPIPE) == 1;
    pthread_sigmask(SIG_BLOCK, &pipe_, &mask_before_);
  }
  PipeSignalBlock(const PipeSignalBlock&) = delete;
  PipeSignalBlock& operator=(const PipeSignalBlock&) = delete;
  ~PipeSignalBlock() {
    if (!was_pending_) {
      const timespec no_wait{};
      sigtimedwait(&pipe_, nullptr, &no_wait);
    }
    pthread_sigmask(SIG_SETMASK, &mask_before_, nullptr);
  }

 private:
  sigset_t pipe_{};
  sigset_t mask_before_{};
  bool was_pending_ = false;
};

/// 0, or the error number.
int write_all(int descriptor, const std::vector<std::uint8_t>& bytes) {
  const PipeSignalBlock block;
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = ::write(descriptor, bytes.data() + done, bytes.size() - done);
    if (count >= 0) {
      done += static_cast<std::size_t>(count);
    } else if (errno == EAGAIN) {
      pollfd writable{descriptor, POLLOUT, 0};
      poll(&writable, 1, -1);
    } else if (errno != EINTR) {
      return errno;
    }
  }
  return 0;
}

bool is_full_range(const ColorInfo& color) {
  GstVideoColorimetry colorimetry;
  return gst_video_colorimetry_from_string(&colorimetry, color.colorimetry.c_str()) != FALSE &&
         colorimetry.range == GST_VIDEO_COLOR_RANGE_0_255;
}

std::vector<std::uint8_t> stream_header(const SinkFormat& format) {
  gint numerator = 0;
  gint denominator = 0;  // 0:0 is "unknown"
  if (format.fps > 0) {
    gst_util_double_to_fraction(format.fps, &numerator, &denominator);
  }
  const bool is_left = format.color.chroma_siting == ChromaSiting::left;
  const std::string text =
      fmt::format("YUV4MPEG2 W{} H{} F{}:{} Ip A1:1 C420{} XCOLORRANGE={}\n", format.size.width,
                  format.size.height, numerator, denominator, is_left ? "mpeg2" : "jpeg",
                  is_full_range(format.color) ? "FULL" : "LIMITED");
  return {text.begin(), text.end()};
}

/// Grows by `count` bytes, to be written where the result points.
std::uint8_t* append(std::vector<std::uint8_t>& bytes, int count) {
  bytes.resize(bytes.size() + static_cast<std::size_t>(count));
  return bytes.data() + (std::ssize(bytes) - count);
}

void append_luma(std::vector<std::uint8_t>& bytes, const VideoFrame& frame) {
  const auto [data, stride] = frame.planes[0];
  std::uint8_t* to = append(bytes, frame.size.width * frame.size.height);
  for (int row = 0; row < frame.size.height; ++row) {
    to = std::copy_n(data + row * stride, frame.size.width, to);
  }
}

/// Every second byte of the interleaved plane: U with `offset` 0, V with 1.
void append_chroma(std::vector<std::uint8_t>& bytes, const VideoFrame& frame, int offset) {
  const auto [data, stride] = frame.planes[1];
  const ImageSize size = chroma_size(frame.size);
  std::uint8_t* to = append(bytes, size.width * size.height);
  for (int row = 0; row < size.height; ++row) {
    const std::uint8_t* from = data + row * stride + offset;
    for (int column = 0; column < size.width; ++column) {
      to[column] = from[std::ptrdiff_t{2} * column];
    }
    to += size.width;
  }
}

}  // namespace

Y4mSink::Y4mSink(int descriptor, std::string name, const SinkFormat& format,
                 std::vector<std::string> warnings)
    : descriptor_(descriptor),
      name_(std::move(name)),
      format_(format),
      warnings_(std::move(warnings)),
      bytes_(stream_header(format)) {}

Result<std::unique_ptr<FrameSink>> Y4mSink::open_file(const std::filesystem::path& path,
                                                      const SinkFormat& format,
                                                      std::vector<std::string> warnings) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    return bad_input(fmt::format("{} cannot be written: {}", path.string(), std::strerror(errno)));
  }
  return std::unique_ptr<FrameSink>(
      new Y4mSink(descriptor, path.string(), format, std::move(warnings)));
}

Result<std::unique_ptr<FrameSink>> Y4mSink::open_stdout(const SinkFormat& format,
                                                        std::vector<std::string> warnings) {
  return std::unique_ptr<FrameSink>(
      new Y4mSink(STDOUT_FILENO, "standard output", format, std::move(warnings)));
}

Y4mSink::~Y4mSink() {
  static_cast<void>(close_file());
}

Result<void> Y4mSink::write(const VideoFrame& frame) {
  if (frame.size != format_.size) {
    return failed(fmt::format("frame {} is {}x{}, but {} was opened for {}x{}", frame.stamp.index,
                              frame.size.width, frame.size.height, name_, format_.size.width,
                              format_.size.height));
  }
  constexpr std::string_view kFrameHeader = "FRAME\n";
  bytes_.insert(bytes_.end(), kFrameHeader.begin(), kFrameHeader.end());
  append_luma(bytes_, frame);
  append_chroma(bytes_, frame, 0);
  append_chroma(bytes_, frame, 1);
  bytes_copied_ += std::ssize(bytes_);
  if (auto written = write_bytes(); !written) {
    return written;
  }
  ++frames_written_;
  return {};
}

Result<void> Y4mSink::finish() {
  if (auto written = write_bytes(); !written) {  // the header, if there was no frame
    return written;
  }
  return close_file();
}

Result<void> Y4mSink::write_bytes() {
  const int error = write_all(descriptor_, bytes_);
  bytes_.clear();
  if (error == EPIPE) {
    return failed(fmt::format("{}: the reader is gone after {} frames", name_, frames_written_));
  }
  if (error != 0) {
    return failed(fmt::format("{}: {}; it ends after {} frames", name_, std::strerror(error),
                              frames_written_));
  }
  return {};
}

Result<void> Y4mSink::close_file() {
  const int descriptor = std::exchange(descriptor_, -1);
  const bool is_ours = descriptor >= 0 && descriptor != STDOUT_FILENO;
  if (is_ours && ::close(descriptor) != 0) {
    return failed(fmt::format("{}: {}; it may be incomplete", name_, std::strerror(errno)));
  }
  return {};
}

}  // namespace gimbal
