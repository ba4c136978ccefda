// OpenCV's camera models as a peer.

#include <gtest/gtest.h>

#include <numbers>
#include <opencv2/calib3d.hpp>
#include <random>
#include <vector>

#include "pipeline/lens/lens.hpp"

namespace gimbal {
namespace {

constexpr double kFx = 1223.0, kFy = 1217.5, kCx = 650.4, kCy = 345.3;

Lens lens_of(LensModel model, const std::vector<double>& distortion) {
  Eigen::Matrix3d K;
  K << kFx, 0, kCx, 0, kFy, kCy, 0, 0, 1;
  return Lens::create({model, K, distortion}).value();
}

cv::Matx33d opencv_K() {
  return {kFx, 0, kCx, 0, kFy, kCy, 0, 0, 1};
}

std::vector<cv::Point3d> rays_within(double off_axis_rad) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> around(-std::numbers::pi, std::numbers::pi);
  std::uniform_real_distribution<double> off_axis(0, off_axis_rad);
  std::vector<cv::Point3d> rays;
  for (int i = 0; i < 300; ++i) {
    const double a = around(random), b = off_axis(random);
    rays.emplace_back(std::sin(b) * std::cos(a), std::sin(b) * std::sin(a), std::cos(b));
  }
  return rays;
}

void expect_same_pixels(const Lens& lens, const std::vector<cv::Point3d>& rays,
                        const std::vector<cv::Point2d>& pixels) {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto pixel = lens.project({rays[i].x, rays[i].y, rays[i].z});
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x(), pixels[i].x, 1e-9);
    EXPECT_NEAR(pixel->y(), pixels[i].y, 1e-9);
  }
}

/// `opencv` has rows of u and v in turns, and the derivatives by the three of the translation from
/// `first_column` on: a camera's ray moves as the point in its axes does.
void expect_same_jacobians(const Lens& lens, const std::vector<cv::Point3d>& rays,
                           const cv::Mat& opencv, int first_column) {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto jacobian = lens.jacobian({rays[i].x, rays[i].y, rays[i].z});
    ASSERT_TRUE(jacobian);
    for (int row = 0; row < 2; ++row) {
      for (int axis = 0; axis < 3; ++axis) {
        const double theirs = opencv.at<double>(2 * static_cast<int>(i) + row, first_column + axis);
        EXPECT_NEAR((*jacobian)(row, axis), theirs, 1e-9 * (1 + jacobian->norm()))
            << "ray " << rays[i];
      }
    }
  }
}

class BrownAgainstOpenCv : public testing::TestWithParam<std::vector<double>> {};

TEST_P(BrownAgainstOpenCv, Project) {
  const auto rays = rays_within(0.6);
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(rays, cv::Vec3d(), cv::Vec3d(), opencv_K(), GetParam(), pixels);
  expect_same_pixels(lens_of(LensModel::brown, GetParam()), rays, pixels);
}

TEST_P(BrownAgainstOpenCv, Jacobian) {
  const auto rays = rays_within(0.6);
  std::vector<cv::Point2d> pixels;
  cv::Mat jacobian;  // by rotation, then by translation
  cv::projectPoints(rays, cv::Vec3d(), cv::Vec3d(), opencv_K(), GetParam(), pixels, jacobian);
  expect_same_jacobians(lens_of(LensModel::brown, GetParam()), rays, jacobian, 3);
}

TEST_P(BrownAgainstOpenCv, Unproject) {
  const Lens lens = lens_of(LensModel::brown, GetParam());
  std::vector<cv::Point2d> pixels;
  for (double x = 0; x < 1280; x += 97) {
    for (double y = 0; y < 720; y += 83) pixels.emplace_back(x, y);
  }
  std::vector<cv::Point2d> points;
  cv::undistortPoints(pixels, points, opencv_K(), GetParam(), cv::noArray(), cv::noArray(),
                      {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 500, 1e-13});
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const auto ray = lens.unproject({pixels[i].x, pixels[i].y});
    ASSERT_TRUE(ray);
    // OpenCV's fixed-point iteration stops at a reprojection error, here far below 1e-9.
    EXPECT_NEAR(ray->x() / ray->z(), points[i].x, 1e-9);
    EXPECT_NEAR(ray->y() / ray->z(), points[i].y, 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(Coefficients, BrownAgainstOpenCv,
                         testing::Values(std::vector{-0.28, 0.07, 1e-3, -2e-3},
                                         std::vector{0.12, -0.3, -1e-3, 5e-4, 0.1},
                                         std::vector{3.1, 1.2, 2e-4, -3e-4, 0.05, 3.4, 2.1, 0.25}));

class FisheyeAgainstOpenCv : public testing::TestWithParam<std::vector<double>> {};

TEST_P(FisheyeAgainstOpenCv, Project) {
  const auto rays = rays_within(1.5);
  std::vector<cv::Point2d> pixels;
  cv::fisheye::projectPoints(rays, pixels, cv::Vec3d(), cv::Vec3d(), opencv_K(), GetParam());
  expect_same_pixels(lens_of(LensModel::fisheye, GetParam()), rays, pixels);
}

TEST_P(FisheyeAgainstOpenCv, Jacobian) {
  const auto rays = rays_within(1.5);
  std::vector<cv::Point2d> pixels;
  cv::Mat jacobian;  // by focal lengths, principal point, coefficients, rotation, translation, skew
  cv::fisheye::projectPoints(rays, pixels, cv::Vec3d(), cv::Vec3d(), opencv_K(), GetParam(), 0,
                             jacobian);
  expect_same_jacobians(lens_of(LensModel::fisheye, GetParam()), rays, jacobian, 11);
}

TEST_P(FisheyeAgainstOpenCv, Unproject) {
  const auto rays = rays_within(1.2);
  std::vector<cv::Point2d> pixels;
  cv::fisheye::projectPoints(rays, pixels, cv::Vec3d(), cv::Vec3d(), opencv_K(), GetParam());
  std::vector<cv::Point2d> points;
  cv::fisheye::undistortPoints(pixels, points, opencv_K(), GetParam());
  const Lens lens = lens_of(LensModel::fisheye, GetParam());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const auto ray = lens.unproject({pixels[i].x, pixels[i].y});
    ASSERT_TRUE(ray);
    EXPECT_NEAR(ray->x() / ray->z(), points[i].x, 1e-7);  // OpenCV stops after ten steps at 1e-8
    EXPECT_NEAR(ray->y() / ray->z(), points[i].y, 1e-7);
  }
}

INSTANTIATE_TEST_SUITE_P(Coefficients, FisheyeAgainstOpenCv,
                         testing::Values(std::vector{0.0, 0.0, 0.0, 0.0},
                                         std::vector{0.05, -0.02, 0.006, -0.001},
                                         std::vector{-0.03, 0.004, -0.002, 0.0001}));

}  // namespace
}  // namespace gimbal
