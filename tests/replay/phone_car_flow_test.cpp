// The gyro must explain how the picture of a real recording moves: corners tracked from frame to
// frame, less the motion that the orientation of their rows predicts. The reference is the picture
// itself; OpenCV tracks.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <string>
#include <vector>

#include "drivers/replay/import/importer.hpp"
#include "drivers/replay/replay_camera.hpp"
#include "pipeline/estimator/thesis_ekf.hpp"
#include "pipeline/lens/lens.hpp"
#include "pipeline/smoother/attitude_history.hpp"
#include "pipeline/timing/row_timing.hpp"
#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

struct Track {
  FrameStamp from;
  FrameStamp to;
  Vector2d from_px;
  Vector2d to_px;
};

cv::Mat luma_of(const VideoFrame& frame) {
  const cv::Mat view(frame.size.height, frame.size.width, CV_8UC1,
                     const_cast<std::uint8_t*>(frame.planes[0].data),
                     static_cast<std::size_t>(frame.planes[0].stride_bytes));
  return view.clone();
}

/// Shi-Tomasi corners in the upper two thirds: below lies the dashboard of the car.
std::vector<cv::Point2f> find_corners(const cv::Mat& picture) {
  cv::Mat mask = cv::Mat::zeros(picture.size(), CV_8UC1);
  mask.rowRange(0, picture.rows * 2 / 3) = 255;
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(picture, corners, 400, 0.01, 8, mask);
  return corners;
}

/// A corner followed from one frame to the next and back to where it began (thesis 2.4).
struct Step {
  cv::Point2f from;
  cv::Point2f to;
};

std::vector<Step> follow(const cv::Mat& from, const cv::Mat& to,
                         const std::vector<cv::Point2f>& corners) {
  if (corners.empty()) return {};
  std::vector<cv::Point2f> forth;
  std::vector<cv::Point2f> back;
  std::vector<unsigned char> found_forth;
  std::vector<unsigned char> found_back;
  std::vector<float> error;
  cv::calcOpticalFlowPyrLK(from, to, corners, forth, found_forth, error);
  cv::calcOpticalFlowPyrLK(to, from, forth, back, found_back, error);
  std::vector<Step> steps;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const bool returned =
        found_forth[i] != 0 && found_back[i] != 0 && cv::norm(back[i] - corners[i]) < 0.3;
    if (returned) steps.push_back({corners[i], forth[i]});
  }
  return steps;
}

/// Those that move as the most of the picture does: not the traffic, nor what is near. The picture
/// alone decides, the gyro is not asked; the tolerance is the usual one.
std::vector<Step> with_the_picture(const std::vector<Step>& steps) {
  constexpr std::size_t kFewest = 8;
  constexpr double kTolerance_px = 3;
  if (steps.size() < kFewest) return {};
  std::vector<cv::Point2f> from;
  std::vector<cv::Point2f> to;
  for (const Step& step : steps) {
    from.push_back(step.from);
    to.push_back(step.to);
  }
  std::vector<unsigned char> agrees;
  cv::findHomography(from, to, cv::RANSAC, kTolerance_px, agrees);
  std::vector<Step> kept;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (agrees[i] != 0) kept.push_back(steps[i]);
  }
  return kept;
}

/// Which corners are followed on.
using Selection = std::vector<Step> (*)(const std::vector<Step>&);

std::vector<Step> all(const std::vector<Step>& steps) {
  return steps;
}

struct Picture {
  FrameStamp stamp;
  cv::Mat luma;
};

std::vector<Picture> decode(const Session& session) {
  ReplayCamera camera(session.video, session.frames, session.camera->fps);
  std::vector<Picture> pictures;
  if (!camera.start()) return pictures;
  while (true) {
    const auto frame = camera.read();
    if (!frame || !*frame) return pictures;
    pictures.push_back({(*frame)->stamp, luma_of(**frame)});
  }
}

/// Follows corners as long as they are selected; finds new ones every `renewal` frames.
std::vector<Track> track(const std::vector<Picture>& pictures, std::size_t renewal,
                         Selection select) {
  std::vector<Track> tracks;
  std::vector<cv::Point2f> corners;
  for (std::size_t i = 0; i + 1 < pictures.size(); ++i) {
    if (i % renewal == 0) corners = find_corners(pictures[i].luma);
    const auto steps = select(follow(pictures[i].luma, pictures[i + 1].luma, corners));
    corners.clear();
    for (const Step& step : steps) {
      tracks.push_back({pictures[i].stamp,
                        pictures[i + 1].stamp,
                        {step.from.x, step.from.y},
                        {step.to.x, step.to.y}});
      corners.push_back(step.to);
    }
  }
  return tracks;
}

/// Where a corner should have gone, given the camera's orientation when it was seen first and last.
Vector2d predicted_px(const Lens& lens, const Vector2d& from_px, const Eigen::Quaterniond& q_from,
                      const Eigen::Quaterniond& q_to) {
  const Vector3d ray = q_to.conjugate() * (q_from * *lens.unproject(from_px));
  return lens.project(ray).value_or(Vector2d::Constant(1e6));
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

AttitudeHistory orientations(const Session& session) {
  AttitudeHistory history(std::chrono::milliseconds(100));
  ThesisEkf estimator;
  for (const GyroSample& sample : session.gyro) {
    history.append({estimator.update({sample.time, sample.gyro_rad_s, std::nullopt})});
  }
  return history;
}

/// Median distances, in pixels, between where corners went and where they were expected.
struct Residuals {
  double raw_px;       ///< expected where they were
  double one_pose_px;  ///< turned by the camera from the middle of one frame to that of the next
  double rows_px;      ///< turned from the instant of one row to that of the other
};

class PhoneCar : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::filesystem::path recording =
        std::filesystem::path(GIMBALD_SHARED) / "data/sessions/phone-car";
    if (!std::filesystem::exists(recording)) GTEST_SKIP() << "no recording phone-car here";
    session_ = import_session(recording, folder_.path() / "session");
    ASSERT_TRUE(session_) << session_.error().message;
    pictures_ = decode(*session_);
    ASSERT_EQ(pictures_.size(), 101U);
  }

  [[nodiscard]] Residuals residuals(const std::vector<Track>& tracks) const;

  test::TemporaryFolder folder_;
  Result<Session> session_;
  std::vector<Picture> pictures_;
};

class PhoneCarFar : public PhoneCar, public ::testing::WithParamInterface<std::size_t> {};

Residuals PhoneCar::residuals(const std::vector<Track>& tracks) const {
  const Lens lens = *Lens::create(session_->camera->lens);
  const RowTiming timing(*session_->camera);
  const AttitudeHistory history = orientations(*session_);
  const Eigen::Quaterniond q_imu_camera(Eigen::Matrix3d(session_->imu.R_camera_imu.transpose()));
  const auto expected_px = [&](const Track& track, double from_line, double to_line) {
    const auto q_world_camera = [&](const FrameStamp& stamp, double line) {
      return history.at(timing.time_of_line(stamp, line)).q_world_imu * q_imu_camera;
    };
    return predicted_px(lens, track.from_px, q_world_camera(track.from, from_line),
                        q_world_camera(track.to, to_line));
  };
  const double middle = timing.line_count() / 2.0;
  std::vector<double> raw;
  std::vector<double> one_pose;
  std::vector<double> rows;
  for (const Track& track : tracks) {
    raw.push_back((track.to_px - track.from_px).norm());
    one_pose.push_back((expected_px(track, middle, middle) - track.to_px).norm());
    rows.push_back((expected_px(track, track.from_px.y(), track.to_px.y()) - track.to_px).norm());
  }
  return {median(raw), median(one_pose), median(rows)};
}

void print(const std::string& which, std::size_t count, const Residuals& residuals) {
  fmt::print(
      "median residual flow of {} {} corners: raw {:.3f} px, one pose a frame {:.3f} px, "
      "every row its own {:.3f} px\n",
      count, which, residuals.raw_px, residuals.one_pose_px, residuals.rows_px);
}

// The car drives: what is near moves by parallax, which no gyroscope knows. What moves with most of
// the picture, and goes on doing so, is far, and there the gyro has to explain what is seen;
// however long corners are followed.
TEST_P(PhoneCarFar, IsExplainedByTheGyro) {
  const auto far = track(pictures_, GetParam(), with_the_picture);
  ASSERT_GT(far.size(), 5000U);
  const Residuals residual = residuals(far);
  print("far", far.size(), residual);
  EXPECT_GT(residual.raw_px, 2.5);
  EXPECT_LE(residual.rows_px, 0.90);
  EXPECT_LT(residual.rows_px, 0.95 * residual.one_pose_px);
}

INSTANTIATE_TEST_SUITE_P(FramesUntilNewOnes, PhoneCarFar, ::testing::Values(10, 30, 100));

TEST_F(PhoneCar, RowsExplainMoreThanOnePoseAFrame) {
  const auto near_and_far = track(pictures_, 1, all);
  const Residuals residual = residuals(near_and_far);
  print("near and far", near_and_far.size(), residual);
  EXPECT_LT(residual.rows_px, residual.one_pose_px);
  EXPECT_LT(residual.rows_px, residual.raw_px / 2);
}

}  // namespace
}  // namespace gimbal
