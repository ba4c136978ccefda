#include "drivers/synthetic/panorama.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <thread>
#include <vector>

#include "drivers/synthetic/random.hpp"

namespace gimbal {
namespace {

/// Smooth, and different in every direction.
class SmoothScene : public Scene {
 public:
  [[nodiscard]] Eigen::Vector3d color(const Eigen::Vector3d& d) const override {
    return Eigen::Vector3d(0.5 + 0.4 * std::sin(9 * d.x()), 0.5 + 0.4 * std::cos(7 * d.y() + d.x()),
                           0.5 + 0.4 * std::sin(8 * d.z()));
  }
};

Eigen::Vector3f seen(const Panorama& panorama, const Eigen::Vector3f& ray) {
  const std::vector<float> x{ray.x()};
  const std::vector<float> y{ray.y()};
  const std::vector<float> z{ray.z()};
  std::vector<Light> light(1, Light::Zero());
  panorama.add_light({x, y, z}, Eigen::Matrix3f::Identity(), 1.0F, light);
  return light.front().head<3>();
}

/// Between texels at most h²/8 times the second derivatives, here at 600 texels a radian.
constexpr float kBetweenTexels = 1e-4F;

TEST(Panorama, ShowsTheSceneInEveryDirection) {
  const SmoothScene scene;
  const Panorama panorama(std::make_shared<SmoothScene>(), 600.0, 1);
  Random random(1);
  for (int i = 0; i < 5000; ++i) {
    const double x = random.normal();
    const double y = random.normal();
    const Eigen::Vector3d direction = Eigen::Vector3d(x, y, random.normal()).normalized();
    const Eigen::Vector3f expected = scene.color(direction).cast<float>();
    EXPECT_LT((seen(panorama, direction.cast<float>()) - expected).cwiseAbs().maxCoeff(),
              kBetweenTexels)
        << direction.transpose();
  }
}

TEST(Panorama, HasNoSeamBetweenFaces) {
  const SmoothScene scene;
  const Panorama panorama(std::make_shared<SmoothScene>(), 600.0, 2);
  for (double along = -0.99; along < 1.0; along += 0.013) {
    for (const double off : {-1e-3, -1e-5, 0.0, 1e-5, 1e-3}) {
      for (const Eigen::Vector3d& edge :
           {Eigen::Vector3d(1, 1 + off, along), Eigen::Vector3d(along, -1, 1 + off),
            Eigen::Vector3d(-1, along, -1 - off)}) {
        const Eigen::Vector3d direction = edge.normalized();
        const Eigen::Vector3f expected = scene.color(direction).cast<float>();
        EXPECT_LT((seen(panorama, direction.cast<float>()) - expected).cwiseAbs().maxCoeff(),
                  kBetweenTexels)
            << edge.transpose();
      }
    }
  }
}

TEST(Panorama, IsBlackWhereALensHasNoRay) {
  const Panorama panorama(std::make_shared<SmoothScene>(), 100.0, 1);
  EXPECT_EQ(seen(panorama, Eigen::Vector3f::Zero()), Eigen::Vector3f::Zero());
}

TEST(Panorama, IsTheSameForThreadsThatLookAtOnce) {
  const Panorama alone(std::make_shared<SmoothScene>(), 300.0, 1);
  const Panorama shared(std::make_shared<SmoothScene>(), 300.0, 1);
  const auto look_around = [](const Panorama& panorama) {
    std::vector<Eigen::Vector3f> light;
    for (int i = 0; i < 3000; ++i) {
      const auto angle = static_cast<float>(0.002 * i);
      light.push_back(
          seen(panorama, {std::cos(angle), std::sin(angle), 0.3F * std::sin(5 * angle)}));
    }
    return light;
  };
  std::vector<Eigen::Vector3f> one;
  std::vector<Eigen::Vector3f> other;
  {
    const std::jthread first([&] { one = look_around(shared); });
    const std::jthread second([&] { other = look_around(shared); });
  }
  EXPECT_EQ(one, look_around(alone));
  EXPECT_EQ(other, one);
}

}  // namespace
}  // namespace gimbal
