#include "drivers/replay/lens_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/core.hpp>
#include <string>

#include "pipeline/lens/lens.hpp"
#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class LensFileTest : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path write(const std::string& name,
                                            const std::string& text) const {
    std::ofstream(folder_.path() / name) << text;
    return folder_.path() / name;
  }

  [[nodiscard]] std::string fault(const std::string& name, const std::string& text) const {
    const auto lens = read_lens_file(write(name, text));
    if (lens) return "none";
    EXPECT_EQ(lens.error().kind, Error::Kind::bad_input);
    EXPECT_EQ(lens.error().message.find('\n'), std::string::npos);
    EXPECT_THAT(lens.error().message, HasSubstr(name));
    return lens.error().message;
  }

  test::TemporaryFolder folder_;
};

const std::string kGyroflow = R"({
  "camera_brand": "Maker", "camera_model": "One", "calib_dimension": {"w": 2704, "h": 1520},
  "frame_readout_time": 15.5, "fps": 59.94, "distortion_model": "opencv_fisheye",
  "input_horizontal_stretch": 1.0,
  "fisheye_params": {
    "camera_matrix": [[1180.5, 0.0, 1349.0], [0.0, 1181.25, 761.5], [0.0, 0.0, 1.0]],
    "distortion_coeffs": [0.04, 0.02, -0.03, 0.01]
  }
})";

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const auto at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

TEST_F(LensFileTest, ReadsAGyroflowProfile) {
  const auto lens = read_lens_file(write("a.json", kGyroflow));
  ASSERT_TRUE(lens) << lens.error().message;
  EXPECT_EQ(lens->camera.size, (ImageSize{2704, 1520}));
  EXPECT_EQ(lens->camera.lens.model, LensModel::fisheye);
  EXPECT_EQ(lens->camera.readout, std::chrono::microseconds(15500));
  EXPECT_EQ(lens->camera.fps, 59.94);
  const Eigen::Matrix3d& K = lens->camera.lens.K;
  EXPECT_EQ(K(0, 0), 1180.5);
  EXPECT_EQ(K(1, 1), 1181.25);
  EXPECT_EQ(K(0, 2), 1351.5) << "the middle of the picture, as Gyroflow takes it";
  EXPECT_EQ(K(1, 2), 759.5);
  EXPECT_THAT(lens->camera.lens.distortion, ElementsAre(0.04, 0.02, -0.03, 0.01));
  EXPECT_FALSE(lens->R_camera_imu);
}

TEST_F(LensFileTest, GyroflowsOtherWays) {
  const auto own_centre = read_lens_file(
      write("a.json", replaced(kGyroflow, "\"fps\"", "\"asymmetrical\": true, \"fps\"")));
  ASSERT_TRUE(own_centre);
  EXPECT_EQ(own_centre->camera.lens.K(0, 2), 1349.0);
  EXPECT_EQ(own_centre->camera.lens.K(1, 2), 761.5);
  const auto plain =
      read_lens_file(write("b.json", replaced(kGyroflow, "opencv_fisheye", "opencv_standard")));
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->camera.lens.model, LensModel::brown);
}

TEST_F(LensFileTest, SaysWhatItDoesNotTakeOfGyroflow) {
  EXPECT_THAT(fault("a.json", "[]"), HasSubstr("not a JSON object"));
  EXPECT_THAT(fault("a.json", "{"), HasSubstr("not a JSON object"));
  EXPECT_THAT(fault("a.json", replaced(kGyroflow, "2704", "\"wide\"")),
              HasSubstr("calib_dimension"));
  EXPECT_THAT(fault("a.json", replaced(kGyroflow, "2704", "-4")), HasSubstr("-4x1520"));
  EXPECT_THAT(fault("a.json", replaced(kGyroflow, "opencv_fisheye", "poly3")), HasSubstr("poly3"));
  EXPECT_THAT(fault("a.json", replaced(kGyroflow, "1180.5, 0.0", "1180.5")),
              HasSubstr("camera_matrix"));
  EXPECT_THAT(fault("a.json", replaced(kGyroflow, "1180.5", "-1180.5")), HasSubstr("focal"));
  EXPECT_THAT(fault("a.json", replaced(kGyroflow, "0.04,", "\"k1\",")),
              HasSubstr("distortion_coeffs"));
  EXPECT_THAT(fault("a.json", replaced(kGyroflow, "0.04, 0.02", "0.04")),
              HasSubstr("3 coefficients"));
  EXPECT_THAT(fault("a.json", replaced(kGyroflow, "stretch\": 1.0", "stretch\": 1.33")),
              HasSubstr("anamorphic"));
  EXPECT_THAT(
      fault("a.json", replaced(kGyroflow, "\"fps\"", "\"digital_lens\": \"gopro\", \"fps\"")),
      HasSubstr("gopro"));
}

const std::string kKalibr = R"(cam0:
  T_cam_imu:
  - [0.0, -1.0, 0.0, 0.01]
  - [-1.0, 0.0, 0.0, 0.02]
  - [0.0, 0.0, -1.0, 0.03]
  - [0.0, 0.0, 0.0, 1.0]
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [-0.28, 0.07, 0.001, -0.002]
  distortion_model: radtan
  intrinsics: [458.6, 457.3, 367.2, 248.4]
  resolution: [752, 480]
  rostopic: /cam0/image_raw
  timeshift_cam_imu: -0.0125
cam1:
  camera_model: pinhole
)";

TEST_F(LensFileTest, ReadsTheFirstCameraOfAKalibrChain) {
  const auto lens = read_lens_file(write("camchain.yaml", kKalibr));
  ASSERT_TRUE(lens) << lens.error().message;
  EXPECT_EQ(lens->camera.size, (ImageSize{752, 480}));
  EXPECT_EQ(lens->camera.lens.model, LensModel::brown);
  EXPECT_THAT(lens->camera.lens.distortion, ElementsAre(-0.28, 0.07, 0.001, -0.002));
  EXPECT_EQ(lens->camera.lens.K(0, 0), 458.6);
  EXPECT_EQ(lens->camera.lens.K(1, 1), 457.3);
  EXPECT_EQ(lens->camera.lens.K(0, 2), 367.2);
  EXPECT_EQ(lens->camera.lens.K(1, 2), 248.4);
  EXPECT_EQ(lens->camera.time_offset, std::chrono::microseconds(-12500));
  ASSERT_TRUE(lens->R_camera_imu);
  const Eigen::Matrix3d R = (Eigen::Matrix3d() << 0, -1, 0, -1, 0, 0, 0, 0, -1).finished();
  EXPECT_EQ(*lens->R_camera_imu, R);
  const auto fisheye = read_lens_file(write("b.yml", replaced(kKalibr, "radtan", "equidistant")));
  ASSERT_TRUE(fisheye);
  EXPECT_EQ(fisheye->camera.lens.model, LensModel::fisheye);
}

TEST_F(LensFileTest, SaysWhatItDoesNotTakeOfKalibr) {
  EXPECT_THAT(fault("a.yaml", replaced(kKalibr, "camera_model: pinhole", "camera_model: omni")),
              HasSubstr("\"omni\""));
  EXPECT_THAT(fault("a.yaml", replaced(kKalibr, "radtan", "fov")), HasSubstr("\"fov\""));
  EXPECT_THAT(fault("a.yaml", replaced(kKalibr, "458.6, ", "")), HasSubstr("intrinsics"));
  EXPECT_THAT(fault("a.yaml", replaced(kKalibr, "[752, 480]", "big")), HasSubstr("resolution"));
  EXPECT_THAT(fault("a.yaml", replaced(kKalibr, "- [0.0, -1.0, 0.0, 0.01]", "- [0.0]")),
              HasSubstr("T_cam_imu"));
  EXPECT_THAT(fault("a.yaml", "cam0: [\n"), HasSubstr("line 2"));
  EXPECT_THAT(fault("a.yaml", "else: 1\n"), HasSubstr("neither"));
  EXPECT_THAT(fault("a.yaml", ""), HasSubstr("neither"));
  EXPECT_THAT(read_lens_file(folder_.path() / "no.yaml").error().message, HasSubstr("no.yaml"));
}

/// OpenCV's own writer makes the file.
TEST_F(LensFileTest, ReadsWhatOpenCvWrites) {
  const cv::Matx33d K(1223, 0, 650.4, 0, 1217.5, 345.3, 0, 0, 1);
  for (const bool is_fisheye : {false, true}) {
    const auto path = folder_.path() / "camera.yml";
    {
      cv::FileStorage file(path.string(), cv::FileStorage::WRITE);
      file << "calibration_time"
           << "Tue Jul  1 12:00:00 2025";
      file << "image_width" << 1280 << "image_height" << 720;
      file << "fisheye_model" << (is_fisheye ? 1 : 0);
      file << "camera_matrix" << cv::Mat(K);
      const cv::Mat plain = (cv::Mat_<double>(5, 1) << 0.12, -0.3, -1e-3, 5e-4, 0.1);
      const cv::Mat fisheye = (cv::Mat_<double>(4, 1) << 0.05, -0.02, 0.006, -0.001);
      file << "distortion_coefficients" << (is_fisheye ? fisheye : plain);
    }
    const auto lens = read_lens_file(path);
    ASSERT_TRUE(lens) << lens.error().message;
    EXPECT_EQ(lens->camera.size, (ImageSize{1280, 720}));
    EXPECT_EQ(lens->camera.lens.K(0, 0), 1223);
    EXPECT_EQ(lens->camera.lens.K(1, 2), 345.3);
    if (is_fisheye) {
      EXPECT_EQ(lens->camera.lens.model, LensModel::fisheye);
      EXPECT_THAT(lens->camera.lens.distortion, ElementsAre(0.05, -0.02, 0.006, -0.001));
    } else {
      EXPECT_EQ(lens->camera.lens.model, LensModel::brown);
      EXPECT_THAT(lens->camera.lens.distortion, ElementsAre(0.12, -0.3, -1e-3, 5e-4, 0.1));
    }
  }
}

const std::string kCameraInfo = R"(image_width: 800
image_height: 600
camera_name: front
camera_matrix:
  rows: 3
  cols: 3
  data: [538.63, 0, 457.698, 0, 539.723, 297.003, 0, 0, 1]
distortion_model: rational_polynomial
distortion_coefficients:
  rows: 1
  cols: 8
  data: [3.1, 1.2, 2e-4, -3e-4, 0.05, 3.4, 2.1, 0.25]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]
)";

TEST_F(LensFileTest, ReadsRosCameraInfo) {
  const auto lens = read_lens_file(write("front.yaml", kCameraInfo));
  ASSERT_TRUE(lens) << lens.error().message;
  EXPECT_EQ(lens->camera.size, (ImageSize{800, 600}));
  EXPECT_EQ(lens->camera.lens.model, LensModel::brown);
  EXPECT_THAT(lens->camera.lens.distortion,
              ElementsAre(3.1, 1.2, 2e-4, -3e-4, 0.05, 3.4, 2.1, 0.25));
  EXPECT_EQ(lens->camera.lens.K(0, 2), 457.698);
  EXPECT_THAT(fault("a.yaml", replaced(kCameraInfo, "rational_polynomial", "thin")),
              HasSubstr("\"thin\""));
  EXPECT_THAT(fault("a.yaml", replaced(kCameraInfo, "image_width: 800\n", "")),
              HasSubstr("image_width"));
  EXPECT_THAT(fault("a.yaml", replaced(kCameraInfo, "457.698, ", "")), HasSubstr("nine numbers"));
}

TEST_F(LensFileTest, FitsToAnotherSizeOfTheSameShape) {
  CameraCalibration camera;
  camera.size = {1280, 720};
  camera.lens.model = LensModel::brown;
  camera.lens.K << 1223, 0, 650.4, 0, 1217.5, 345.3, 0, 0, 1;
  camera.lens.distortion = {0.12, -0.3, -1e-3, 5e-4, 0.1};
  const auto large = fitted_to(camera, {1920, 1080});
  ASSERT_TRUE(large);
  // A ray goes through the same share of the picture.
  const Eigen::Vector3d ray(0.3, -0.2, 1);
  const Eigen::Vector2d there = *Lens::create(camera.lens)->project(ray);
  const Eigen::Vector2d here = *Lens::create(large->lens)->project(ray);
  EXPECT_NEAR((here.x() + 0.5) / 1920, (there.x() + 0.5) / 1280, 1e-12);
  EXPECT_NEAR((here.y() + 0.5) / 1080, (there.y() + 0.5) / 720, 1e-12);
  const auto other_shape = fitted_to(camera, {640, 480});
  ASSERT_FALSE(other_shape);
  EXPECT_THAT(other_shape.error().message, HasSubstr("1280x720"));
}

}  // namespace
}  // namespace gimbal
