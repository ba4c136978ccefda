#pragma once

#include <cmath>
#include <numbers>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/judge/camera_rotation.hpp"
#include "tests/judge/frame_tracks.hpp"

namespace gimbal::judge {

inline const cv::Size kSize{480, 270};
inline constexpr double kFps = 30;
inline const Pinhole kCamera{450, kSize};

/// Blobs of many sizes, brighter than black, far larger than a frame: one seed, one texture.
inline cv::Mat texture() {
  cv::RNG random(7);
  cv::Mat sum = cv::Mat::zeros(kSize * 3, CV_32F);
  for (const double blob_px : {2.0, 5.0, 12.0}) {
    cv::Mat noise(sum.size(), CV_32F);
    random.fill(noise, cv::RNG::NORMAL, 0, blob_px * 60);
    cv::GaussianBlur(noise, noise, {}, blob_px);
    sum += noise;
  }
  cv::Mat luma;
  sum.convertTo(luma, CV_8U, 1, 120);
  return cv::max(luma, 40);
}

inline cv::Matx33d K_of(const Pinhole& camera) {
  return {camera.focal_px,
          0,
          (camera.size.width - 1) / 2.0,
          0,
          camera.focal_px,
          (camera.size.height - 1) / 2.0,
          0,
          0,
          1};
}

/// What a camera sees of the texture, whose middle lies straight ahead, once it has turned.
/// `turn_rad`: a rotation vector in camera axes, R_start_camera.
inline cv::Mat seen(const cv::Mat& texture, const cv::Vec3d& turn_rad) {
  cv::Matx33d R_start_camera;
  cv::Rodrigues(turn_rad, R_start_camera);
  const cv::Matx33d K = K_of(kCamera);
  const cv::Matx33d in_the_middle(1, 0, kSize.width, 0, 1, kSize.height, 0, 0, 1);
  cv::Mat frame;
  cv::warpPerspective(texture, frame, in_the_middle * K * R_start_camera * K.inv(), kSize,
                      cv::INTER_CUBIC | cv::WARP_INVERSE_MAP, cv::BORDER_REFLECT);
  return frame;
}

inline TrackedPicture looked_at(const cv::Mat& luma) {
  return make_tracked_picture(luma, cv::Mat(luma.size(), CV_8UC1, cv::Scalar(255)));
}

inline double sine(double hz, double time_s) {
  return std::sin(2 * std::numbers::pi * hz * time_s);
}

/// The root mean square, over a long time, of the difference between neighbouring frames of a sine
/// of amplitude 1.
inline double rms_step(double hz) {
  return std::numbers::sqrt2 * std::abs(std::sin(std::numbers::pi * hz / kFps));
}

}  // namespace gimbal::judge
