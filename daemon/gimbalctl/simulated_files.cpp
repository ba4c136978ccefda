#include "daemon/gimbalctl/simulated_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <memory>
#include <numbers>
#include <string>

#include "daemon/gimbalctl/progress_bar.hpp"
#include "drivers/replay/decimal_time.hpp"
#include "drivers/replay/still.hpp"
#include "pipeline/sink/frame_sink.hpp"
#include "pipeline/sink/pipeline_text.hpp"

namespace gimbal {
namespace {

constexpr int kThumbnailWidth_px = 320;

/// H.264 that is hard to tell from the original, for displacements of 0.1 px are measured in it;
/// where x264 is not installed, what the sink takes for .mkv.
Result<std::unique_ptr<FrameSink>> open_video(const std::filesystem::path& path,
                                              const CameraFormat& format) {
  const SinkFormat sink_format{format.size, format.fps, format.color};
  const std::string pipeline = fmt::format(
      "x264enc pass=qual quantizer=12 speed-preset=superfast bframes=0 vbv-buf-capacity=0 "
      "! matroskamux ! filesink location={}",
      in_pipeline_quotes(path.string()));
  auto sink = open_sink(pipeline, sink_format, std::nullopt);
  return sink ? std::move(sink) : open_sink(path.string(), sink_format, std::nullopt);
}

void append_quaternion(fmt::memory_buffer& out, const Eigen::Quaterniond& q) {
  fmt::format_to(std::back_inserter(out), "{:.12f},{:.12f},{:.12f},{:.12f}", q.w(), q.x(), q.y(),
                 q.z());
}

Result<void> write_text(const std::filesystem::path& path, const fmt::memory_buffer& text) {
  std::ofstream file(path, std::ios::binary);
  file.write(text.data(), static_cast<std::streamsize>(text.size()));
  file.close();
  if (file) return {};
  return failed(fmt::format("{}: cannot be written; is the disk full?", path.string()));
}

}  // namespace

Result<void> write_video(SyntheticCamera& camera, const SimulationOptions& options) {
  auto sink = open_video(options.output / "video.mkv", camera.format());
  if (!sink) return tl::unexpected(sink.error());
  if (Result<void> started = camera.start(); !started) return started;
  ProgressBar progress("simulate", static_cast<std::int64_t>(camera.frame_count()),
                       options.quiet ? ProgressStyle::quiet : ProgressStyle::automatic);
  while (true) {
    const Result<std::optional<VideoFrame>> frame = camera.read();
    if (!frame) return tl::unexpected(frame.error());
    if (!*frame) return (*sink)->finish();
    if (Result<void> written = (*sink)->write(**frame); !written) return written;
    progress.advance();
    const bool middle =
        (*frame)->stamp.index == static_cast<std::int64_t>(camera.frame_count()) / 2;
    if (middle) {
      Result<void> still =
          write_still(**frame, options.output / "thumbnail.jpg", kThumbnailWidth_px);
      if (!still) return still;
    }
  }
}

Result<void> write_imu_truth(const SyntheticImu& imu, const Eigen::Matrix3d& R_camera_imu,
                             const Motion& motion, const std::filesystem::path& path) {
  constexpr double kMoving_rad_s = 2.0 * std::numbers::pi / 180.0;
  const Eigen::Quaterniond q_camera_imu(R_camera_imu);
  fmt::memory_buffer out;
  fmt::format_to(std::back_inserter(out), "t_s,qw,qx,qy,qz,movement\n");
  for (const GyroSample& sample : imu.gyro()) {
    const MotionState state = motion.at(sample.time);
    fmt::format_to(std::back_inserter(out), "{},", format_seconds(sample.time.time_since_epoch()));
    append_quaternion(out, state.q_world_camera * q_camera_imu);
    fmt::format_to(std::back_inserter(out), ",{}\n",
                   state.rate_rad_s.norm() > kMoving_rad_s ? 1 : 0);
  }
  return write_text(path, out);
}

Result<void> write_row_truth(const SyntheticCamera& camera, const Motion& motion,
                             const std::filesystem::path& path) {
  constexpr int kEvery = 8;
  fmt::memory_buffer out;
  fmt::format_to(std::back_inserter(out), "index,row,t_s,qw,qx,qy,qz\n");
  const int last = camera.line_count() - 1;
  for (std::size_t frame = 0; frame < camera.frame_count(); ++frame) {
    for (int line = 0; line <= last;
         line = line == last ? last + 1 : std::min(line + kEvery, last)) {
      const SensorTime time = camera.time_of_line(frame, line);
      fmt::format_to(std::back_inserter(out), "{},{},{},", frame, line,
                     format_seconds(time.time_since_epoch()));
      append_quaternion(out, motion.at(time).q_world_camera);
      out.push_back('\n');
    }
  }
  return write_text(path, out);
}

}  // namespace gimbal
