#include <fmt/core.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "drivers/replay/import/gpmf.hpp"
#include "drivers/replay/import/importer.hpp"
#include "drivers/replay/import/mp4.hpp"

namespace gimbal {

namespace {

/// GoPro's axes are x left, y back, z up, seen from behind the camera (picture "IMU orientation" in
/// github.com/gopro/gpmf-parser).
Eigen::Matrix3d R_camera_gopro() {
  Eigen::Matrix3d R;
  R << -1, 0, 0,  //
      0, 0, -1,   //
      0, -1, 0;
  return R;
}

/// One stream over all payloads of a recording.
struct StreamBlock {
  GpmfStream stream;
  SensorDuration payload_start{};
  SensorDuration payload_duration{};
};

struct Telemetry {
  std::string device;
  std::string utc;
  std::vector<StreamBlock> gyro;
  std::vector<StreamBlock> accel;
  std::vector<StreamBlock> exposure;  ///< SHUT: one number a frame
  std::vector<StreamBlock> readout;   ///< SROT: one number a frame, milliseconds
};

const Mp4Track* find_track(const std::vector<Mp4Track>& tracks, FourCc handler, FourCc format) {
  const auto found = std::find_if(tracks.begin(), tracks.end(), [&](const Mp4Track& track) {
    return track.handler == handler && (format == 0 || track.format == format);
  });
  return found == tracks.end() ? nullptr : &*found;
}

void sort_stream(StreamBlock block, Telemetry& telemetry) {
  if (!block.stream.utc.empty() && telemetry.utc.empty()) telemetry.utc = block.stream.utc;
  const bool is_vector = block.stream.columns == 3 && block.stream.sample_count() > 0;
  const bool is_number = block.stream.columns == 1;
  switch (block.stream.key) {
    case four_cc("GYRO"):
      if (is_vector) telemetry.gyro.push_back(std::move(block));
      break;
    case four_cc("ACCL"):
      if (is_vector) telemetry.accel.push_back(std::move(block));
      break;
    case four_cc("SHUT"):
      if (is_number) telemetry.exposure.push_back(std::move(block));
      break;
    case four_cc("SROT"):
      if (is_number) telemetry.readout.push_back(std::move(block));
      break;
    default:
      break;
  }
}

/// Of several devices, such as a camera on a drone, the first one with a gyroscope counts.
void sort_device(GpmfDevice device, const Mp4Sample& sample, Telemetry& telemetry) {
  const bool has_gyro =
      std::any_of(device.streams.begin(), device.streams.end(),
                  [](const GpmfStream& stream) { return stream.key == four_cc("GYRO"); });
  if (!has_gyro) return;
  if (telemetry.device.empty()) telemetry.device = device.name;
  if (device.name != telemetry.device) return;
  for (GpmfStream& stream : device.streams) {
    sort_stream({std::move(stream), sample.time, sample.duration}, telemetry);
  }
}

Result<Telemetry> read_telemetry(const std::filesystem::path& path, const Mp4Track& track) {
  Telemetry telemetry;
  for (const Mp4Sample& sample : track.samples) {
    const Result<std::vector<std::uint8_t>> payload = read_mp4_sample(path, sample);
    if (!payload) return tl::unexpected(payload.error());
    for (GpmfDevice& device : parse_gpmf(ByteView(std::span(*payload)))) {
      sort_device(std::move(device), sample, telemetry);
    }
  }
  return telemetry;
}

/// Of the frame after the last: the end.
SensorDuration time_of_frame(const Mp4Track& video, std::size_t frame) {
  if (frame < video.samples.size()) return video.samples[frame].time;
  return video.samples.back().time + video.samples.back().duration;
}

/// When each block's first sample was taken, since the first frame. The camera's own stamps say it
/// best, the first frame's exposure having one too; then the number of frames that went into the
/// payloads so far, because a payload's time in the track can be 0.1 s off; then that time.
std::vector<SensorDuration> block_starts(const std::vector<StreamBlock>& blocks,
                                         const std::vector<StreamBlock>& exposure,
                                         const Mp4Track& video) {
  std::vector<SensorDuration> starts;
  const bool has_stamps = !exposure.empty() && exposure.front().stream.stamp &&
                          std::all_of(blocks.begin(), blocks.end(), [](const StreamBlock& block) {
                            return block.stream.stamp.has_value();
                          });
  std::size_t frames_before = 0;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (has_stamps) {
      starts.push_back(*blocks[i].stream.stamp - *exposure.front().stream.stamp);
    } else if (exposure.size() == blocks.size()) {
      starts.push_back(time_of_frame(video, frames_before));
      frames_before += exposure[i].stream.sample_count();
    } else {
      starts.push_back(blocks[i].payload_start);
    }
  }
  return starts;
}

struct TimedVector {
  SensorTime time;
  Eigen::Vector3d value;
};

/// Samples have no stamp of their own: they are spread evenly from one block's start to the next's.
std::vector<TimedVector> spread(const std::vector<StreamBlock>& blocks,
                                const std::vector<SensorDuration>& starts) {
  std::vector<TimedVector> out;
  SensorDuration span{};
  std::size_t span_samples = 1;
  for (std::size_t block = 0; block < blocks.size(); ++block) {
    const std::vector<double>& values = blocks[block].stream.values;
    const std::size_t count = blocks[block].stream.sample_count();
    const bool is_last = block + 1 == blocks.size();
    if (!is_last || blocks.size() == 1) {
      span = is_last ? blocks[block].payload_duration : starts[block + 1] - starts[block];
      span_samples = count;
    }
    for (std::size_t i = 0; i < count; ++i) {
      const double fraction = static_cast<double>(i) / static_cast<double>(span_samples);
      const SensorDuration since_start = duration_from_seconds(fraction * to_seconds(span));
      out.push_back(
          {SensorTime(starts[block] + since_start), Eigen::Vector3d(values.data() + 3 * i)});
    }
  }
  return out;
}

/// Order of axes in the stored columns of cameras that do not say it (ORIN), by the same source.
std::string default_orientation(const std::string& device) {
  return device.find('6') != std::string::npos ? "YxZ" : "ZXY";
}

/// Takes stored columns to GoPro's axes: "YxZ" stands for columns y, -x, z.
Result<Eigen::Matrix3d> axes_from_columns(const std::string& orientation) {
  Eigen::Matrix3d M = Eigen::Matrix3d::Zero();
  for (std::size_t column = 0; column < orientation.size() && column < 3; ++column) {
    const char letter = orientation[column];
    const int axis = std::tolower(static_cast<unsigned char>(letter)) - 'x';
    if (axis >= 0 && axis < 3) M(axis, static_cast<int>(column)) = letter < 'a' ? 1 : -1;
  }
  if (orientation.size() == 3 && std::abs(M.determinant()) == 1) return M;
  return bad_input(fmt::format("axis order \"{}\" (ORIN) is not three of x, y and z", orientation));
}

Result<std::vector<TimedVector>> vectors_of(const std::vector<StreamBlock>& blocks,
                                            const Telemetry& telemetry, const Mp4Track& video) {
  if (blocks.empty()) return std::vector<TimedVector>();
  const std::string& stored = blocks.front().stream.orientation_in;
  const Result<Eigen::Matrix3d> M =
      axes_from_columns(stored.empty() ? default_orientation(telemetry.device) : stored);
  if (!M) return tl::unexpected(M.error());
  std::vector<TimedVector> vectors =
      spread(blocks, block_starts(blocks, telemetry.exposure, video));
  for (TimedVector& vector : vectors) vector.value = *M * vector.value;
  return vectors;
}

std::vector<FrameStamp> frames_of(const Mp4Track& video, const Telemetry& telemetry) {
  std::vector<FrameStamp> frames;
  for (const Mp4Sample& sample : video.samples) {
    frames.push_back({std::ssize(frames), SensorTime(sample.time), std::nullopt});
  }
  std::size_t next = 0;
  for (const StreamBlock& block : telemetry.exposure) {
    for (const double exposure_s : block.stream.values) {
      if (next == frames.size()) return frames;
      if (exposure_s > 0 && exposure_s < 1)
        frames[next].exposure = duration_from_seconds(exposure_s);
      ++next;
    }
  }
  return frames;
}

CameraCalibration camera_of(const Mp4Track& video, const Telemetry& telemetry) {
  constexpr double kLongestReadout_ms = 1000;
  CameraCalibration camera;
  camera.size = video.size;
  const double duration_s = to_seconds(time_of_frame(video, video.samples.size()));
  if (duration_s > 0) camera.fps = static_cast<double>(video.samples.size()) / duration_s;
  if (telemetry.readout.empty() || telemetry.readout.front().stream.values.empty()) return camera;
  std::vector<double> readouts_ms = telemetry.readout.front().stream.values;
  std::sort(readouts_ms.begin(), readouts_ms.end());
  const double median_ms = readouts_ms[readouts_ms.size() / 2];
  if (median_ms > 0 && median_ms < kLongestReadout_ms) {
    camera.readout = duration_from_seconds(median_ms / 1000);
  }
  return camera;
}

/// "190506181507.395" is 2019-05-06T18:15:07.395Z.
std::string rfc3339(const std::string& utc) {
  const bool is_date = utc.size() >= 12 && std::all_of(utc.begin(), utc.begin() + 12,
                                                       [](char c) { return c >= '0' && c <= '9'; });
  if (!is_date) return "";
  return fmt::format("20{}-{}-{}T{}:{}:{}Z", utc.substr(0, 2), utc.substr(2, 2), utc.substr(4, 2),
                     utc.substr(6, 2), utc.substr(8, 2), utc.substr(10));
}

Result<Session> read_gopro(const std::filesystem::path& input) {
  const Result<std::vector<Mp4Track>> tracks = read_mp4_tracks(input);
  if (!tracks) return tl::unexpected(tracks.error());
  const Mp4Track* const video = find_track(*tracks, four_cc("vide"), 0);
  const Mp4Track* const metadata = find_track(*tracks, four_cc("meta"), four_cc("gpmd"));
  if (video == nullptr || video->samples.empty() || metadata == nullptr) {
    return bad_input(fmt::format("{}: no pictures beside the telemetry", input.string()));
  }
  const Result<Telemetry> telemetry = read_telemetry(input, *metadata);
  if (!telemetry) return tl::unexpected(telemetry.error());
  const auto gyro = vectors_of(telemetry->gyro, *telemetry, *video);
  const auto accel = vectors_of(telemetry->accel, *telemetry, *video);
  if (!gyro || !accel) {
    return bad_input(fmt::format("{}: {}", input.string(), (gyro ? accel : gyro).error().message));
  }
  Session session;
  session.device =
      telemetry->device.starts_with("GoPro") ? telemetry->device : "GoPro " + telemetry->device;
  session.recorded_at = rfc3339(telemetry->utc);
  session.camera_without_lens = camera_of(*video, *telemetry);
  session.imu.R_camera_imu = R_camera_gopro();
  session.imu_clock = "video";
  session.video = input;
  session.frames = frames_of(*video, *telemetry);
  for (const TimedVector& v : *gyro) session.gyro.push_back({v.time, v.value});
  for (const TimedVector& v : *accel) session.accel.push_back({v.time, v.value});
  session.notes = {
      "From a GoPro's GPMF track. Its samples have no stamps: they are spread evenly over each "
      "payload.",
      "IMU axes are GoPro's: x left, y back, z up. Frame times are the video track's.",
      "The lens is not known: K has to be given under [camera]. Nor is time_offset_s, which stands "
      "at 0."};
  return session;
}

bool is_gopro(const std::filesystem::path& input) {
  if (!looks_like_mp4(input)) return false;
  const Result<std::vector<Mp4Track>> tracks = read_mp4_tracks(input);
  return tracks && find_track(*tracks, four_cc("meta"), four_cc("gpmd")) != nullptr;
}

}  // namespace

const Importer kGoProImporter{"GoPro MP4 with GPMF telemetry", is_gopro, read_gopro};

}  // namespace gimbal
