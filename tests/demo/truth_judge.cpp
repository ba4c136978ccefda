// Judges a stabilized synthetic recording by the files that anyone has: the session with its truth,
// the orientation that was estimated, and the path log. Prints a table of what improved and writes
// the curves for the plots.
//
//   truth_judge SESSION ORIENTATION.csv PATH_LOG.csv OUTPUT_FOLDER

#include <fmt/core.h>
#include <fmt/os.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "drivers/replay/csv.hpp"
#include "drivers/replay/session.hpp"
#include "pipeline/path/steadiness.hpp"
#include "pipeline/smoother/attitude_history.hpp"
#include "pipeline/timing/row_timing.hpp"
#include "pipeline/warp/warp_mesh.hpp"
#include "tests/support/truth_error.hpp"

namespace gimbal {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr int kGridColumns = 9;
constexpr int kGridRows = 36;

/// This program has one reader, who wants the line.
template <typename T>
T value_or_exit(Result<T> result) {
  if (result) return *std::move(result);
  fmt::print(stderr, "truth_judge: {}\n", result.error().message);
  std::exit(1);
}

struct TrueLine {
  double line;
  Quaterniond q_world_camera;
};

using Truth = std::map<std::int64_t, std::vector<TrueLine>>;  ///< by frame index, lines rising

Quaterniond quaternion_at(const CsvReader& csv, const CsvRow& row, std::size_t first) {
  const auto at = [&](std::size_t i) { return value_or_exit(csv.number(row, first + i)); };
  return Quaterniond(at(0), at(1), at(2), at(3)).normalized();
}

template <typename Take>
void for_each_row(const std::filesystem::path& file, std::vector<std::string> columns, Take take) {
  CsvReader csv = value_or_exit(CsvReader::open(file, {std::move(columns), {}}));
  while (const auto row = value_or_exit(csv.next())) take(csv, *row);
}

Truth read_truth(const std::filesystem::path& file) {
  Truth truth;
  for_each_row(file, {"index", "row", "qw", "qx", "qy", "qz"},
               [&](const CsvReader& csv, const CsvRow& row) {
                 truth[value_or_exit(csv.integer(row, 0))].push_back(
                     {value_or_exit(csv.number(row, 1)), quaternion_at(csv, row, 2)});
               });
  return truth;
}

AttitudeHistory read_orientation(const std::filesystem::path& file) {
  AttitudeHistory history(std::chrono::milliseconds(100));
  for_each_row(file, {"t_s", "qw", "qx", "qy", "qz"}, [&](const CsvReader& csv, const CsvRow& row) {
    const auto time = value_or_exit(csv.time(row, 0, TimeUnit::seconds));
    if (time) history.append({{SensorTime(*time), quaternion_at(csv, row, 1)}});
  });
  return history;
}

std::vector<VirtualCamera> read_path_log(const std::filesystem::path& file) {
  std::vector<VirtualCamera> cameras;
  for_each_row(
      file, {"index", "t_s", "qw", "qx", "qy", "qz", "fx", "fy", "cx", "cy"},
      [&](const CsvReader& csv, const CsvRow& row) {
        const auto at = [&](std::size_t column) { return value_or_exit(csv.number(row, column)); };
        const auto time =
            value_or_exit(csv.time(row, 1, TimeUnit::seconds)).value_or(SensorDuration{});
        cameras.push_back({{value_or_exit(csv.integer(row, 0)), SensorTime(time), std::nullopt},
                           quaternion_at(csv, row, 2),
                           {at(6), at(7), at(8), at(9)}});
      });
  return cameras;
}

Quaterniond interpolate(const std::vector<TrueLine>& lines, double line) {
  const auto after =
      std::lower_bound(lines.begin() + 1, lines.end() - 1, line,
                       [](const TrueLine& l, double value) { return l.line < value; });
  const auto before = after - 1;
  const double part = (line - before->line) / (after->line - before->line);
  return before->q_world_camera.slerp(std::clamp(part, 0.0, 1.0), after->q_world_camera);
}

/// Errors of one kind of picture: by row of the grid, and the camera that would truly have seen it.
struct Picture {
  std::vector<double> row_sum_px = std::vector<double>(kGridRows, 0.0);
  std::vector<double> row_count = std::vector<double>(kGridRows, 0.0);
  std::vector<double> errors_px;
  std::vector<double> frame_error_px;
  std::vector<FramePose> seen_from;

  void add(const std::vector<test::ShownPoint>& points, const VirtualCamera& camera,
           ImageSize size) {
    const Quaterniond q_shown_true = test::common_rotation(points);
    seen_from.push_back({camera.stamp, camera.q_world_camera * q_shown_true.conjugate()});
    const auto errors = test::errors_px(test::without_common_rotation(points), camera.intrinsics);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto row = static_cast<std::size_t>(
          std::floor(points[i].output_px.y() / (size.height - 1.0) * kGridRows));
      row_sum_px[row] += errors[i];
      row_count[row] += 1;
    }
    errors_px.insert(errors_px.end(), errors.begin(), errors.end());
    frame_error_px.push_back(test::mean(errors));
  }
};

struct Judgement {
  Picture recorded;
  Picture written;
};

Judgement judge(const Session& session, const Truth& truth, const AttitudeHistory& history,
                const std::vector<VirtualCamera>& cameras) {
  const CameraCalibration& calibration = *session.camera;
  const Lens lens = value_or_exit(Lens::create(calibration.lens));
  const RowTiming timing(calibration);
  const Quaterniond q_imu_camera(Eigen::Matrix3d(session.imu.R_camera_imu.transpose()));
  const Eigen::Matrix3d& K = calibration.lens.K;
  const PinholeIntrinsics recorded_intrinsics{K(0, 0), K(1, 1), K(0, 2), K(1, 2)};
  Judgement judgement;
  for (const VirtualCamera& camera : cameras) {
    const auto lines = truth.find(camera.stamp.index);
    if (lines == truth.end() || lines->second.size() < 2) continue;
    const auto true_orientation = [&](double line) { return interpolate(lines->second, line); };
    const auto compare = [&](const test::SourceMap& map, const VirtualCamera& against) {
      return test::compare_with_truth(map, lens, calibration.readout_direction, true_orientation,
                                      against, calibration.size, kGridColumns, kGridRows);
    };
    const LineOrientation estimated = [&](double line) {
      return history.at(timing.time_of_line(camera.stamp, line)).q_world_imu * q_imu_camera;
    };
    const WarpMesh mesh =
        build_warp_mesh(lens, calibration.size, calibration.readout_direction, estimated, camera,
                        calibration.size, Border::crop, MeshDensity{});
    judgement.written.add(compare([&](const auto& p) { return source_of(mesh, p); }, camera),
                          camera, calibration.size);
    const VirtualCamera as_recorded{
        camera.stamp, true_orientation((calibration.size.height - 1) / 2.0), recorded_intrinsics};
    judgement.recorded.add(compare([](const auto& p) { return std::optional(p); }, as_recorded),
                           as_recorded, calibration.size);
  }
  return judgement;
}

void write_rows(const Judgement& judgement, int height, const std::filesystem::path& file) {
  auto out = fmt::output_file(file.string());
  out.print("# row, error before px, error after px\n");
  for (std::size_t row = 0; row < kGridRows; ++row) {
    const auto mean = [row](const Picture& p) { return p.row_sum_px[row] / p.row_count[row]; };
    out.print("{:.1f} {:.4f} {:.4f}\n", (static_cast<double>(row) + 0.5) * height / kGridRows,
              mean(judgement.recorded), mean(judgement.written));
  }
}

/// Turns about the camera's own axes since the first frame, in degrees.
Vector3d turn_deg(const std::vector<FramePose>& poses, std::size_t i) {
  const Eigen::AngleAxisd turn(poses.front().q_world_camera.conjugate() * poses[i].q_world_camera);
  return turn.angle() * kDegrees * turn.axis();
}

void write_path(const Judgement& judgement, const std::filesystem::path& file) {
  auto out = fmt::output_file(file.string());
  out.print("# t_s, pitch yaw roll before deg, pitch yaw roll after deg\n");
  const auto& before = judgement.recorded.seen_from;
  const auto& after = judgement.written.seen_from;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const Vector3d b = turn_deg(before, i);
    const Vector3d a = turn_deg(after, i);
    out.print("{:.4f} {:.5f} {:.5f} {:.5f} {:.5f} {:.5f} {:.5f}\n",
              to_seconds(before[i].stamp.time - before[0].stamp.time), b.x(), b.y(), b.z(), a.x(),
              a.y(), a.z());
  }
}

/// The frame that the rolling shutter bent most, for the picture.
std::int64_t most_bent_frame(const Judgement& judgement) {
  const Picture& recorded = judgement.recorded;
  const auto worst =
      std::max_element(recorded.frame_error_px.begin(), recorded.frame_error_px.end());
  const auto place = static_cast<std::size_t>(worst - recorded.frame_error_px.begin());
  return recorded.seen_from.at(place).stamp.index;
}

void print_table(const Judgement& judgement) {
  const auto shake = [](const Picture& picture, double cutoff_hz) {
    return rms_rate_above_rad_s(picture.seen_from, cutoff_hz) * kDegrees;
  };
  const auto line = [](const char* what, double before, double after) {
    fmt::print("{:<52} {:>9.3f} {:>9.3f} {:>8.1f}x\n", what, before, after, before / after);
  };
  const Picture& before = judgement.recorded;
  const Picture& after = judgement.written;
  fmt::print("{:<52} {:>9} {:>9} {:>9}\n", "against the truth", "before", "after", "better");
  line("rolling-shutter error, mean of all points, px", test::mean(before.errors_px),
       test::mean(after.errors_px));
  line("rolling-shutter error, worst point, px", test::maximum(before.errors_px),
       test::maximum(after.errors_px));
  line("swing: rms rate above 1 Hz of the true view, deg/s", shake(before, 1), shake(after, 1));
  line("shake: rms rate above 4 Hz of the true view, deg/s", shake(before, 4), shake(after, 4));
}

}  // namespace
}  // namespace gimbal

int main(int argc, char** argv) {
  using namespace gimbal;
  if (argc != 5) {
    fmt::print(stderr, "usage: truth_judge SESSION ORIENTATION.csv PATH_LOG.csv OUTPUT_FOLDER\n");
    return 2;
  }
  const std::filesystem::path folder(argv[4]);
  const Session session = value_or_exit(open_session(argv[1]));
  if (!session.camera) {
    fmt::print(stderr, "truth_judge: {}: no camera calibration\n", argv[1]);
    return 2;
  }
  const Judgement judgement = judge(session, read_truth(session.folder / "truth_rows.csv"),
                                    read_orientation(argv[2]), read_path_log(argv[3]));
  write_rows(judgement, session.camera->size.height, folder / "rows.dat");
  write_path(judgement, folder / "path.dat");
  fmt::output_file((folder / "most_bent_frame.txt").string())
      .print("{}\n", most_bent_frame(judgement));
  print_table(judgement);
}
