#include "tests/judge/camera_rotation.hpp"

#include <gtest/gtest.h>

#include "tests/unit/judge/moving_picture.hpp"

namespace gimbal::judge {
namespace {

std::vector<Track> tracks_of(const cv::Vec3d& turn_rad, int count) {
  cv::Matx33d R_to_from;
  cv::Rodrigues(turn_rad, R_to_from);
  cv::RNG random(3);
  std::vector<Track> tracks;
  for (int i = 0; i < count; ++i) {
    const cv::Point2f from(random.uniform(0.F, 480.F), random.uniform(0.F, 270.F));
    tracks.push_back({from, turned(kCamera, R_to_from, from)});
  }
  return tracks;
}

double error_rad(const cv::Matx33d& R_to_from, const cv::Vec3d& turn_rad) {
  cv::Vec3d found_rad;
  cv::Rodrigues(R_to_from, found_rad);
  return cv::norm(found_rad - turn_rad);
}

TEST(CameraRotation, IsFoundThoughATurnIsLarge) {
  const cv::Vec3d turn_rad(0.05, -0.2, 0.1);
  const auto R_to_from = fit_rotation(kCamera, tracks_of(turn_rad, 100));
  ASSERT_TRUE(R_to_from);
  EXPECT_LT(error_rad(*R_to_from, turn_rad), 1e-6);
}

TEST(CameraRotation, IsThatOfTheSceneThoughAThirdMovesOtherwise) {
  const cv::Vec3d turn_rad(0.01, 0.02, -0.01);
  std::vector<Track> tracks = tracks_of(turn_rad, 150);
  for (std::size_t i = 0; i < 50; ++i) tracks[i].to += cv::Point2f(9, -4);
  const auto R_to_from = fit_rotation(kCamera, tracks);
  ASSERT_TRUE(R_to_from);
  EXPECT_LT(error_rad(*R_to_from, turn_rad), 1e-6);
}

TEST(CameraRotation, IsNotGuessedFromAFewTracks) {
  EXPECT_FALSE(fit_rotation(kCamera, tracks_of({0.01, 0, 0}, 11)));
}

TEST(CameraRotation, IsNotMadeUpWhereNothingAgrees) {
  std::vector<Track> tracks = tracks_of({0, 0, 0}, 40);
  cv::RNG random(4);
  for (Track& track : tracks) {
    track.to = {random.uniform(0.F, 480.F), random.uniform(0.F, 270.F)};
  }
  EXPECT_FALSE(fit_rotation(kCamera, tracks));
}

}  // namespace
}  // namespace gimbal::judge
