#include "tests/judge/camera_rotation.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace gimbal::judge {
namespace {

constexpr std::size_t kLeastTracks = 12;
constexpr int kDraws = 200;
constexpr int kRefinements = 8;

cv::Point2d middle_of(const Pinhole& camera) {
  return {(camera.size.width - 1) / 2.0, (camera.size.height - 1) / 2.0};
}

/// How far a track may lie from the rotation and still be the camera's, px.
double tolerance_px(const Pinhole& camera) {
  return std::max(1.5, camera.size.width / 400.0);
}

/// Kabsch's rotation: the one that takes the rays `from` to the rays `to`, of unit length, best.
cv::Matx33d best_rotation(const cv::Matx33d& covariance_to_from) {
  cv::Vec3d singular;
  cv::Matx33d u;
  cv::Matx33d vt;
  cv::SVD::compute(covariance_to_from, singular, u, vt);
  const double handedness = cv::determinant(u) * cv::determinant(vt) < 0 ? -1 : 1;
  return u * cv::Matx33d::diag({1, 1, handedness}) * vt;
}

cv::Matx33d outer(const cv::Vec3d& to, const cv::Vec3d& from) {
  return to * from.t();
}

struct RayPair {
  cv::Vec3d from;
  cv::Vec3d to;
};

std::vector<RayPair> rays_of(const Pinhole& camera, const std::vector<Track>& tracks) {
  std::vector<RayPair> rays;
  for (const Track& track : tracks) {
    rays.push_back(
        {cv::normalize(ray_of(camera, track.from)), cv::normalize(ray_of(camera, track.to))});
  }
  return rays;
}

/// Two directions fix a rotation; the plane that they span gives the third.
cv::Matx33d rotation_from_two(const RayPair& a, const RayPair& b) {
  return best_rotation(outer(a.to, a.from) + outer(b.to, b.from) +
                       outer(a.to.cross(b.to), a.from.cross(b.from)));
}

double distance_px(const Pinhole& camera, const cv::Matx33d& R_to_from, const Track& track) {
  return cv::norm(turned(camera, R_to_from, track.from) - track.to);
}

std::size_t count_near(const Pinhole& camera, const cv::Matx33d& R_to_from,
                       const std::vector<Track>& tracks) {
  return static_cast<std::size_t>(
      std::count_if(tracks.begin(), tracks.end(), [&](const Track& track) {
        return distance_px(camera, R_to_from, track) <= tolerance_px(camera);
      }));
}

cv::Matx33d refined(const Pinhole& camera, const std::vector<Track>& tracks,
                    const std::vector<RayPair>& rays, const cv::Matx33d& R_to_from) {
  cv::Matx33d covariance = cv::Matx33d::zeros();
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const double share = distance_px(camera, R_to_from, tracks[i]) / (2 * tolerance_px(camera));
    if (share >= 1) continue;
    const double weight = (1 - share * share) * (1 - share * share);
    covariance += weight * outer(rays[i].to, rays[i].from);
  }
  return best_rotation(covariance);
}

}  // namespace

cv::Vec3d ray_of(const Pinhole& camera, const cv::Point2f& px) {
  const cv::Point2d middle = middle_of(camera);
  return {(px.x - middle.x) / camera.focal_px, (px.y - middle.y) / camera.focal_px, 1};
}

cv::Point2f turned(const Pinhole& camera, const cv::Matx33d& R_to_from, const cv::Point2f& px) {
  const cv::Vec3d ray = R_to_from * ray_of(camera, px);
  const cv::Point2d middle = middle_of(camera);
  return cv::Point2d(middle.x + camera.focal_px * ray[0] / ray[2],
                     middle.y + camera.focal_px * ray[1] / ray[2]);
}

std::optional<cv::Matx33d> fit_rotation(const Pinhole& camera, const std::vector<Track>& tracks) {
  if (tracks.size() < kLeastTracks) return std::nullopt;
  const std::vector<RayPair> rays = rays_of(camera, tracks);
  std::mt19937 random(1);
  cv::Matx33d best = cv::Matx33d::eye();
  std::size_t most = count_near(camera, best, tracks);
  for (int draw = 0; draw < kDraws; ++draw) {
    const std::size_t a = random() % rays.size();
    const std::size_t b = random() % rays.size();
    if (a == b) continue;
    const cv::Matx33d drawn = rotation_from_two(rays[a], rays[b]);
    const std::size_t near = count_near(camera, drawn, tracks);
    if (near <= most) continue;
    most = near;
    best = drawn;
  }
  if (most < kLeastTracks) return std::nullopt;
  for (int i = 0; i < kRefinements; ++i) best = refined(camera, tracks, rays, best);
  return best;
}

}  // namespace gimbal::judge
