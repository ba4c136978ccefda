// The written picture itself against the truth: a frame with a rolling shutter, drawn again through
// the mesh that the true orientation gives, must be the picture that a global shutter in the
// virtual camera's place takes. Corners of the one are looked for in the other.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <memory>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <vector>

#include "drivers/synthetic/picture_renderer.hpp"
#include "drivers/synthetic/street_scene.hpp"
#include "drivers/synthetic/synthetic_camera.hpp"
#include "pipeline/warp/frame_outline.hpp"
#include "pipeline/warp/warp_mesh.hpp"
#include "pipeline/warp/warper.hpp"
#include "tests/golden/ipod_in_hand.hpp"
#include "tests/support/truth_error.hpp"

namespace gimbal {
namespace {

constexpr double kZoom = 1.1;
constexpr double kFocal_px = 1223;  // the iPod's, along x

cv::Mat luma_of(const VideoFrame& frame) {
  return {frame.size.height, frame.size.width, CV_8UC1,
          const_cast<std::uint8_t*>(frame.planes[0].data),
          static_cast<std::size_t>(frame.planes[0].stride_bytes)};
}

/// How far corners of the truth lie from where the picture has them. The edge is left out, where
/// the tracker's window would reach past it.
std::vector<double> displacements_px(const cv::Mat& truth, const cv::Mat& picture) {
  std::vector<cv::Point2f> corners;
  constexpr int kEdge_px = 24;
  cv::Mat inside = cv::Mat::zeros(truth.size(), CV_8UC1);
  inside(cv::Rect(kEdge_px, kEdge_px, truth.cols - 2 * kEdge_px, truth.rows - 2 * kEdge_px)) = 255;
  cv::goodFeaturesToTrack(truth, corners, 500, 0.05, 16, inside);
  std::vector<cv::Point2f> found = corners;
  std::vector<unsigned char> status;
  std::vector<float> error;
  cv::calcOpticalFlowPyrLK(truth, picture, corners, found, status, error, cv::Size(21, 21), 4);
  std::vector<double> distances;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (status[i] != 0) distances.push_back(cv::norm(found[i] - corners[i]));
  }
  return distances;
}

/// The street, turned so that a camera with the given orientation looks along it and level: a log
/// of a hand looks at the asphalt for most of its time, where there are no corners.
class StreetAhead : public Scene {
 public:
  explicit StreetAhead(const Eigen::Quaterniond& q_world_camera)
      : R_street_world_(R_street_camera() * q_world_camera.toRotationMatrix().transpose()) {}

  [[nodiscard]] Eigen::Vector3d color(const Eigen::Vector3d& direction_world) const override {
    return street_.color(R_street_world_ * direction_world);
  }

 private:
  static Eigen::Matrix3d R_street_camera() {
    Eigen::Matrix3d R;  // columns: the camera's right, down and forward
    R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    return R;
  }

  StreetScene street_{1, 1.0 / kFocal_px};
  Eigen::Matrix3d R_street_world_;
};

struct Instant {
  std::string name;
  double start_s;
};

void PrintTo(const Instant& instant, std::ostream* stream) {
  *stream << instant.name;
}

class Picture : public ::testing::TestWithParam<Instant> {};

TEST_P(Picture, IsWhatAGlobalShutterWouldHaveTaken) {
  const CameraCalibration calibration = test::ipod_touch();
  const auto motion = std::make_shared<const Motion>(test::hand_motion(GetParam().start_s, 1));
  const SensorTime readout = time_from_seconds(0.5);
  const auto panorama = std::make_shared<const Panorama>(
      std::make_shared<StreetAhead>(motion->at(readout).q_world_camera), kFocal_px, 2);
  SyntheticCameraSettings settings;
  settings.calibration = calibration;
  settings.exposure = std::chrono::microseconds(100);
  settings.first_readout = readout;
  settings.frames = 1;
  const auto camera = SyntheticCamera::create(settings, motion, panorama);
  ASSERT_TRUE(camera) << camera.error().message;
  ASSERT_TRUE((*camera)->start());
  const VideoFrame recorded = (*camera)->read().value().value();

  const LineOrientation truth = [&](double line) {
    return motion->at((*camera)->time_of_line(0, static_cast<int>(line))).q_world_camera;
  };
  const ImageSize size = calibration.size;
  const VirtualCamera virtual_camera{recorded.stamp, truth((size.height - 1) / 2),
                                     zoomed({kFocal_px, 1217.5, 650.4, 345.3}, size, kZoom)};
  const WarpMesh mesh =
      build_warp_mesh(*Lens::create(calibration.lens), size, ReadoutDirection::top_down, truth,
                      virtual_camera, size, Border::crop, MeshDensity{});
  const auto drawn = make_cpu_warper()->warp(recorded, mesh);
  ASSERT_TRUE(drawn) << drawn.error().message;

  const VideoFrame expected = render_global_shutter(panorama, virtual_camera, size);
  const VirtualCamera as_recorded{
      recorded.stamp, virtual_camera.q_world_camera, {kFocal_px, 1217.5, 650.4, 345.3}};
  const VideoFrame unbent = render_global_shutter(panorama, as_recorded, size);
  const auto before = displacements_px(luma_of(unbent), luma_of(recorded));
  const auto after = displacements_px(luma_of(expected), luma_of(*drawn));
  ASSERT_GT(after.size(), 100U);
  fmt::print("{}: {} corners, before mean {:.3f} px, after mean {:.4f} max {:.3f} px\n",
             GetParam().name, after.size(), test::mean(before), test::mean(after),
             test::maximum(after));
  EXPECT_LE(test::mean(after), 0.10);
  EXPECT_LE(test::maximum(after), 0.5);
}

INSTANTIATE_TEST_SUITE_P(IphoneMotion, Picture,
                         ::testing::Values(Instant{"calm_2_s", 2}, Instant{"harsh_13_s", 13},
                                           Instant{"harsh_26_s", 26}),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace gimbal
