#include "pipeline/lens/lens.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace gimbal {
namespace {

using std::numbers::pi;

Eigen::Matrix3d ipod_K() {  // thesis (2.6)
  return (Eigen::Matrix3d() << 1223.0, 0, 650.4, 0, 1217.5, 345.3, 0, 0, 1).finished();
}

LensParameters parameters(LensModel model, std::vector<double> distortion) {
  return {model, ipod_K(), std::move(distortion)};
}

std::vector<LensParameters> some_lenses() {
  using enum LensModel;
  return {parameters(pinhole, {}),
          parameters(brown, {}),
          parameters(brown, {-0.28, 0.07, 1e-3, -2e-3}),
          parameters(brown, {0.12, -0.3, -1e-3, 5e-4, 0.1}),
          parameters(brown, {3.1, 1.2, 2e-4, -3e-4, 0.05, 3.4, 2.1, 0.25}),
          parameters(fisheye, {}),
          parameters(fisheye, {0.05, -0.02, 0.006, -0.001}),
          parameters(fisheye, {-0.03, 0.004, -0.002, 0.0001})};
}

TEST(Lens, ProjectsByTheThesisCamera) {
  const Lens lens = Lens::create(parameters(LensModel::pinhole, {})).value();
  const auto pixel = lens.project({1, -2, 10});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 1223.0 * 0.1 + 650.4, 1e-9);
  EXPECT_NEAR(pixel->y(), 1217.5 * -0.2 + 345.3, 1e-9);
}

TEST(Lens, PixelToRayToPixelIsExact) {
  for (const auto& p : some_lenses()) {
    const Lens lens = Lens::create(p).value();
    int seen = 0;
    for (double x = -0.5; x <= 1280; x += 61) {
      for (double y = -0.5; y <= 720; y += 37) {
        const auto ray = lens.unproject({x, y});
        if (!ray) continue;
        ++seen;
        EXPECT_NEAR(ray->norm(), 1, 1e-12);
        const auto pixel = lens.project(*ray);
        ASSERT_TRUE(pixel);
        EXPECT_LT((*pixel - Eigen::Vector2d(x, y)).norm(), 1e-9);
      }
    }
    EXPECT_EQ(seen, 21 * 20);  // every one of these lenses sees its whole frame
  }
}

TEST(Lens, RayToPixelToRayIsExact) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> around(-pi, pi);
  std::uniform_real_distribution<double> off_axis(0, 0.5);
  for (const auto& p : some_lenses()) {
    const Lens lens = Lens::create(p).value();
    for (int i = 0; i < 500; ++i) {
      const double a = around(random);
      const double b = off_axis(random);
      const Eigen::Vector3d ray(std::sin(b) * std::cos(a), std::sin(b) * std::sin(a), std::cos(b));
      const auto pixel = lens.project(7.0 * ray);
      ASSERT_TRUE(pixel);
      const auto back = lens.unproject(*pixel);
      ASSERT_TRUE(back);
      EXPECT_LT((*back - ray).norm(), 1e-9);
    }
  }
}

TEST(Lens, JacobianIsWhatDifferencesTendTo) {
  constexpr double kStep = 1e-5;
  for (const auto& p : some_lenses()) {
    const Lens lens = Lens::create(p).value();
    const bool sees_sideways = p.model == LensModel::fisheye && p.distortion.empty();
    for (const double off_axis_rad : {0.0, 1e-9, 1e-3, 0.3, 0.6, sees_sideways ? 2.0 : 0.5}) {
      for (const double length : {1.0, 3.5}) {
        const double x = std::sin(off_axis_rad);
        const Eigen::Vector3d ray =
            length * Eigen::Vector3d(0.8 * x, -0.6 * x, std::cos(off_axis_rad));
        const auto jacobian = lens.jacobian(ray);
        ASSERT_TRUE(jacobian);
        for (int axis = 0; axis < 3; ++axis) {
          const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(axis);
          const Eigen::Vector2d difference = *lens.project(ray + step) - *lens.project(ray - step);
          EXPECT_LT((jacobian->col(axis) - difference / (2 * kStep)).norm(), 1e-3)
              << "axis " << axis << ", " << off_axis_rad << " rad off";
        }
      }
    }
    EXPECT_FALSE(lens.jacobian({0, 0, -1}));
  }
}

TEST(Lens, SeesNothingBehind) {
  for (const auto& p : some_lenses()) {
    const Lens lens = Lens::create(p).value();
    EXPECT_FALSE(lens.project({0, 0, -1}));
    EXPECT_FALSE(lens.project({0, 0, 0}));
    EXPECT_FALSE(lens.project({std::numeric_limits<double>::quiet_NaN(), 0, 1}));
    EXPECT_FALSE(lens.unproject({std::numeric_limits<double>::infinity(), 0}));
    if (p.model == LensModel::fisheye) continue;
    EXPECT_FALSE(lens.project({1, 0, 0}));
    EXPECT_FALSE(lens.project({1, 0, -0.1}));
  }
}

TEST(Lens, StopsWhereBarrelDistortionFoldsBack) {
  // r (1 + k r²) has its maximum at r = 1/sqrt(-3k), and is 2/3 of that there.
  const double k = -0.3;
  const double fold = 1 / std::sqrt(-3 * k);
  const Lens lens = Lens::create(parameters(LensModel::brown, {k, 0, 0, 0})).value();
  for (double angle = 0; angle < 2 * pi; angle += 0.3) {
    const auto ray = [&](double r) {
      return Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle), 1);
    };
    EXPECT_TRUE(lens.project(ray(0.999 * fold)));
    EXPECT_FALSE(lens.project(ray(1.001 * fold)));
    EXPECT_FALSE(lens.project(ray(5 * fold)));
    const auto pixel_at = [&](double r) {
      return Eigen::Vector2d(1223.0 * r * std::cos(angle) + 650.4,
                             1217.5 * r * std::sin(angle) + 345.3);
    };
    EXPECT_TRUE(lens.unproject(pixel_at(0.999 * 2 / 3 * fold)));
    EXPECT_FALSE(lens.unproject(pixel_at(1.001 * 2 / 3 * fold)));
  }
}

TEST(Lens, StopsWhereTangentialDistortionFoldsBack) {
  // Along y = 0 with p2 alone x'' = x + 3 p2 x², which turns back at x = -1/(6 p2).
  const Lens lens = Lens::create(parameters(LensModel::brown, {0, 0, 0, 0.1})).value();
  EXPECT_FALSE(lens.project({-1.7, 0, 1}));
  EXPECT_TRUE(lens.project({-1.6, 0, 1}));
}

TEST(Lens, StopsAtThePoleOfTheRationalModel) {
  // 1/(1 - r²/4) goes to infinity at r = 2.
  const Lens lens =
      Lens::create(parameters(LensModel::brown, {0, 0, 0, 0, 0, -0.25, 0, 0})).value();
  EXPECT_TRUE(lens.project({1.99, 0, 1}));
  EXPECT_FALSE(lens.project({2.01, 0, 1}));
  const auto far = lens.unproject({1e7, 345.3});
  ASSERT_TRUE(far);
  EXPECT_LT(far->x() / far->z(), 2);
}

TEST(Lens, FisheyeReachesPastTheSide) {
  const Lens lens = Lens::create(parameters(LensModel::fisheye, {})).value();
  const double angle = 100 * pi / 180;
  const auto pixel = lens.project({std::sin(angle), 0, std::cos(angle)});
  ASSERT_TRUE(pixel);  // equidistant: the radius is the angle itself
  EXPECT_NEAR(pixel->x(), 1223.0 * angle + 650.4, 1e-9);
  const auto ray = lens.unproject(*pixel);
  ASSERT_TRUE(ray);
  EXPECT_NEAR(ray->z(), std::cos(angle), 1e-12);
}

TEST(Lens, FisheyeStopsWhereItFoldsBack) {
  // θ (1 + k θ²) has its maximum at θ = 1/sqrt(-3k).
  const double k = -0.2;
  const double fold = 1 / std::sqrt(-3 * k);
  const Lens lens = Lens::create(parameters(LensModel::fisheye, {k, 0, 0, 0})).value();
  const auto ray = [](double angle) {
    return Eigen::Vector3d(0, std::sin(angle), std::cos(angle));
  };
  EXPECT_TRUE(lens.project(ray(0.9999 * fold)));
  EXPECT_FALSE(lens.project(ray(1.0001 * fold)));
  EXPECT_FALSE(lens.unproject({650.4, 345.3 + 1217.5 * 2 / 3 * fold * 1.0001}));
}

TEST(Lens, RefusesParametersThatAreNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  struct Case {
    std::string part;
    LensParameters parameters;
  };
  const auto with_K = [](int row, int column, double value) {
    LensParameters p = parameters(LensModel::pinhole, {});
    p.K(row, column) = value;
    return p;
  };
  for (const auto& [part, p] :
       {Case{"fx = 0", with_K(0, 0, 0)}, Case{"fy = -5", with_K(1, 1, -5)},
        Case{"skew", with_K(0, 1, 0.1)}, Case{"finite", with_K(0, 2, nan)},
        Case{"rows", with_K(2, 0, 7)}, Case{"rows", with_K(1, 0, 7)}, Case{"rows", with_K(2, 2, 0)},
        Case{"1 coefficients", parameters(LensModel::pinhole, {0.1})},
        Case{"3 coefficients", parameters(LensModel::brown, {0.1, 0, 0})},
        Case{"6 coefficients", parameters(LensModel::brown, {0.1, 0, 0, 0, 0, 0})},
        Case{"5 coefficients", parameters(LensModel::fisheye, {0.1, 0, 0, 0, 0})},
        Case{"finite", parameters(LensModel::fisheye, {0.1, nan, 0, 0})}}) {
    const auto lens = Lens::create(p);
    ASSERT_FALSE(lens);
    EXPECT_EQ(lens.error().kind, Error::Kind::bad_input);
    EXPECT_THAT(lens.error().message, testing::HasSubstr(part));
    EXPECT_EQ(lens.error().message.find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace gimbal
