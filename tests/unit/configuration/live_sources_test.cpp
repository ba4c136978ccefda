#include "daemon/live_sources.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <chrono>
#include <string>

#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

constexpr CameraFormat kFormat{{640, 360}, 25, {}};

class CalibrationFor : public ::testing::Test {
 protected:
  CalibrationSettings from_file() {
    folder_.write("lens.toml",
                  "[camera]\nwidth = 1280\nheight = 720\nfps = 30.0\nK = [[1000.0, 0.0, 639.5], "
                  "[0.0, 1000.0, 359.5], [0.0, 0.0, 1.0]]\nreadout_s = 0.03\n");
    CalibrationSettings settings;
    settings.file = folder_.path() / "lens.toml";
    return settings;
  }

  test::TemporaryFolder folder_;
};

TEST_F(CalibrationFor, AnUnknownLensIsRefused) {
  const auto camera = calibration_for(kFormat, {});
  ASSERT_FALSE(camera);
  EXPECT_NE(camera.error().message.find("horizontal_fov_deg"), std::string::npos);
}

TEST_F(CalibrationFor, AFieldOfViewMakesALens) {
  CalibrationSettings settings;
  settings.horizontal_fov_deg = 90;
  const auto camera = calibration_for(kFormat, settings);
  ASSERT_TRUE(camera);
  // The left edge of the first column is seen 45 degrees to the left.
  const Eigen::Vector3d ray = camera->lens.K.inverse() * Eigen::Vector3d(-0.5, 179.5, 1);
  EXPECT_NEAR(ray.x(), -1, 1e-9);
  EXPECT_NEAR(ray.y(), 0, 1e-9);
  EXPECT_EQ(camera->fps, 25);
}

TEST_F(CalibrationFor, AnotherSizeOfTheSameShapeSeesTheSame) {
  const auto camera = calibration_for(kFormat, from_file());
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->size, (ImageSize{640, 360}));
  // The picture's corner is the same ray in both sizes.
  const Eigen::Vector3d small = camera->lens.K.inverse() * Eigen::Vector3d(639.5, 359.5, 1);
  EXPECT_NEAR(small.x(), 640.0 / 1000, 1e-9);
  EXPECT_NEAR(small.y(), 360.0 / 1000, 1e-9);
  EXPECT_EQ(camera->readout, std::chrono::milliseconds(30));
}

TEST_F(CalibrationFor, ACalibrationOfAnotherProgramKnowsTheLensAndTheDriverTheStamps) {
  folder_.write("camera.yaml",
                "image_width: 1280\nimage_height: 720\ndistortion_model: plumb_bob\n"
                "camera_matrix:\n  data: [1000, 0, 639.5, 0, 1000, 359.5, 0, 0, 1]\n"
                "distortion_coefficients:\n  data: [0.1, 0, 0, 0, 0]\n");
  CalibrationSettings settings;
  settings.file = folder_.path() / "camera.yaml";
  CameraFormat format = kFormat;
  format.readout = std::chrono::milliseconds(20);
  format.timestamp = TimestampReference::readout_end;
  const auto camera = calibration_for(format, settings);
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_EQ(camera->lens.model, LensModel::brown);
  EXPECT_NEAR(camera->lens.K(0, 0), 500, 1e-9);
  EXPECT_EQ(camera->readout, std::chrono::milliseconds(20));
  EXPECT_EQ(camera->timestamp, TimestampReference::readout_end);
}

TEST_F(CalibrationFor, AnotherShapeIsRefused) {
  CameraFormat format = kFormat;
  format.size = {640, 480};
  EXPECT_FALSE(calibration_for(format, from_file()));
}

TEST_F(CalibrationFor, WhatIsSaidGoesBeforeTheFileAndTheDevice) {
  CameraFormat format = kFormat;
  format.readout = std::chrono::milliseconds(12);
  format.timestamp = TimestampReference::readout_end;
  CalibrationSettings settings;
  settings.horizontal_fov_deg = 60;
  EXPECT_EQ(calibration_for(format, settings)->readout, std::chrono::milliseconds(12));
  EXPECT_EQ(calibration_for(format, settings)->timestamp, TimestampReference::readout_end);
  settings.readout = std::chrono::milliseconds(20);
  settings.timestamp = TimestampReference::exposure_start;
  EXPECT_EQ(calibration_for(format, settings)->readout, std::chrono::milliseconds(20));
  EXPECT_EQ(calibration_for(format, settings)->timestamp, TimestampReference::exposure_start);
  CalibrationSettings of_file = from_file();
  of_file.readout = std::chrono::milliseconds(20);
  EXPECT_EQ(calibration_for(kFormat, of_file)->readout, std::chrono::milliseconds(20));
}

}  // namespace
}  // namespace gimbal
