#include "drivers/synthetic/synthetic_camera.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "drivers/synthetic/hand_motion.hpp"
#include "drivers/synthetic/world.hpp"
#include "pipeline/lens/lens.hpp"
#include "pipeline/timing/row_timing.hpp"

namespace gimbal {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

/// White to the left of a heading (counter-clockwise from the world's x), black to its right.
class EdgeScene : public Scene {
 public:
  explicit EdgeScene(double heading_rad) : heading_rad_(heading_rad) {}
  [[nodiscard]] Eigen::Vector3d color(const Eigen::Vector3d& direction) const override {
    const double heading = std::atan2(direction.y(), direction.x());
    return Eigen::Vector3d::Constant(heading > heading_rad_ ? 0.9 : 0.0);
  }

 private:
  double heading_rad_;
};

/// A small round light in one direction.
class DotScene : public Scene {
 public:
  DotScene(const Eigen::Vector3d& direction, double sigma_rad)
      : direction_(direction.normalized()), sigma_rad_(sigma_rad) {}
  [[nodiscard]] Eigen::Vector3d color(const Eigen::Vector3d& direction) const override {
    const double angle = std::atan2(direction.cross(direction_).norm(), direction.dot(direction_));
    return Eigen::Vector3d::Constant(0.9 * std::exp(-0.5 * std::pow(angle / sigma_rad_, 2)));
  }

 private:
  Eigen::Vector3d direction_;
  double sigma_rad_;
};

/// Grey everywhere.
class EvenScene : public Scene {
 public:
  [[nodiscard]] Eigen::Vector3d color(const Eigen::Vector3d&) const override {
    return Eigen::Vector3d::Constant(0.25);
  }
};

/// Light of a luma byte: BT.709's transfer function the other way round.
double light_of(std::uint8_t luma) {
  const double signal = (luma - 16.0) / 219.0;
  return signal < 0.081 ? signal / 4.5 : std::pow((signal + 0.099) / 1.099, 1.0 / 0.45);
}

double light_at(const VideoFrame& frame, int x, int y) {
  return light_of(frame.planes[0].data[y * frame.planes[0].stride_bytes + x]);
}

/// Where a row changes from white on the left to black: as much of it as is white.
double edge_in_row(const VideoFrame& frame, int y) {
  double white = 0;
  for (int x = 0; x < frame.size.width; ++x) white += light_at(frame, x, y);
  return white / light_at(frame, 0, y) - 0.5;
}

double edge_in_column(const VideoFrame& frame, int x) {
  double white = 0;
  for (int y = 0; y < frame.size.height; ++y) white += light_at(frame, x, y);
  return white / light_at(frame, x, 0) - 0.5;
}

Eigen::Vector2d centroid(const VideoFrame& frame) {
  Eigen::Vector2d sum(0, 0);
  double weight = 0;
  for (int y = 0; y < frame.size.height; ++y) {
    for (int x = 0; x < frame.size.width; ++x) {
      const double light = light_at(frame, x, y);
      sum += light * Eigen::Vector2d(x, y);
      weight += light;
    }
  }
  return sum / weight;
}

constexpr double kFocal_px = 400.0;

SyntheticCameraSettings small_camera() {
  SyntheticCameraSettings settings;
  settings.calibration.size = {320, 240};
  settings.calibration.fps = 30;
  settings.calibration.lens.K << kFocal_px, 0, 159.5, 0, kFocal_px, 119.5, 0, 0, 1;
  settings.calibration.readout = milliseconds(30);
  settings.first_readout = SensorTime(milliseconds(100));
  settings.frames = 3;
  return settings;
}

std::shared_ptr<const Panorama> panorama_of(std::shared_ptr<const Scene> scene) {
  return std::make_shared<Panorama>(std::move(scene), 2.0 * kFocal_px, 4);
}

std::unique_ptr<SyntheticCamera> make_camera(const SyntheticCameraSettings& settings,
                                             const Motion& motion,
                                             std::shared_ptr<const Panorama> panorama) {
  auto camera =
      SyntheticCamera::create(settings, std::make_shared<Motion>(motion), std::move(panorama));
  EXPECT_TRUE(camera.has_value()) << camera.error().message;
  EXPECT_TRUE((*camera)->start().has_value());
  return std::move(*camera);
}

/// Level at time zero and heading along x, turning about a camera axis at a constant rate.
Motion turning_motion(const Eigen::Vector3d& rate_rad_s) {
  MotionKnots knots;
  knots.first = SensorTime(milliseconds(-100));
  knots.spacing = milliseconds(100);
  for (int k = -1; k < 20; ++k) {
    const Eigen::Vector3d turn = 0.1 * k * rate_rad_s;
    knots.q_world_camera.push_back(Eigen::Quaterniond(level_R_world_camera()) *
                                   Eigen::AngleAxisd(turn.norm(), turn.normalized()));
    knots.acceleration_m_s2.emplace_back(0, 0, 0);
  }
  return Motion(knots);
}

TEST(SyntheticCamera, AStillCameraSeesTheSamePictureAgain) {
  const auto camera = make_camera(small_camera(), make_hand_motion(tripod(), seconds(1), 1),
                                  panorama_of(std::make_shared<EdgeScene>(0.05)));
  const VideoFrame first = camera->read().value().value();
  const VideoFrame second = camera->read().value().value();
  for (int y = 0; y < 240; ++y) {
    EXPECT_EQ(std::memcmp(first.planes[0].data + y * first.planes[0].stride_bytes,
                          second.planes[0].data + y * second.planes[0].stride_bytes, 320),
              0);
  }
}

TEST(SyntheticCamera, AnUprightEdgeLeansByRateTimesReadout) {
  constexpr double kRate = 0.8;  // rad/s to the right (about camera y, which is down)
  const auto camera = make_camera(small_camera(), turning_motion({0, kRate, 0}),
                                  panorama_of(std::make_shared<EdgeScene>(-0.1)));
  const VideoFrame frame = camera->read().value().value();
  // The edge stands at -0.1 rad: right of x. The camera turns towards it, so it moves left.
  const auto expected = [&](int y) {
    const double t = 0.1 + 0.030 * y / 240.0;
    return 159.5 + kFocal_px * std::tan(0.1 - kRate * t);
  };
  for (const int y : {0, 60, 120, 239}) EXPECT_NEAR(edge_in_row(frame, y), expected(y), 0.05) << y;
  const double lean_px = edge_in_row(frame, 0) - edge_in_row(frame, 239);
  EXPECT_NEAR(lean_px, kFocal_px * kRate * 0.030 * 239.0 / 240.0, 0.1);
}

TEST(SyntheticCamera, ExposureBlursAroundItsMiddle) {
  SyntheticCameraSettings settings = small_camera();
  settings.exposure = milliseconds(20);
  const auto camera = make_camera(settings, turning_motion({0, 0.8, 0}),
                                  panorama_of(std::make_shared<EdgeScene>(-0.1)));
  const VideoFrame frame = camera->read().value().value();
  const double middle_s = 0.1 + 0.030 * 120 / 240.0 - 0.010;  // a row is read when exposed
  EXPECT_NEAR(edge_in_row(frame, 120), 159.5 + kFocal_px * std::tan(0.1 - 0.8 * middle_s), 0.1);
  // The edge travels f ω E = 6.4 px: a row crosses the middle greys over as many pixels.
  int grey = 0;
  for (int x = 0; x < 320; ++x) {
    const double share = light_at(frame, x, 120) / 0.9;
    grey += share > 0.05 && share < 0.95 ? 1 : 0;
  }
  EXPECT_NEAR(grey, 0.9 * kFocal_px * 0.8 * 0.020, 1.6);
}

struct DirectionCase {
  ReadoutDirection direction;
  int first_line;  ///< read first
  int last_line;   ///< read last
};

class SyntheticCameraReadout : public testing::TestWithParam<DirectionCase> {};

TEST_P(SyntheticCameraReadout, LinesAreReadInOrder) {
  const DirectionCase& c = GetParam();
  SyntheticCameraSettings settings = small_camera();
  settings.calibration.readout_direction = c.direction;
  const auto camera = make_camera(settings, turning_motion({0, 0.8, 0}),
                                  panorama_of(std::make_shared<EdgeScene>(0)));
  const int lines = camera->line_count();
  EXPECT_EQ(camera->time_of_line(0, c.first_line), SensorTime(milliseconds(100)));
  EXPECT_EQ(camera->time_of_line(0, c.last_line),
            SensorTime(milliseconds(100) + SensorDuration(milliseconds(30)) * (lines - 1) / lines));
}

INSTANTIATE_TEST_SUITE_P(Directions, SyntheticCameraReadout,
                         testing::Values(DirectionCase{ReadoutDirection::top_down, 0, 239},
                                         DirectionCase{ReadoutDirection::bottom_up, 239, 0},
                                         DirectionCase{ReadoutDirection::left_right, 0, 319},
                                         DirectionCase{ReadoutDirection::right_left, 319, 0}));

TEST(SyntheticCamera, BottomUpLeansTheOtherWay) {
  SyntheticCameraSettings settings = small_camera();
  settings.calibration.readout_direction = ReadoutDirection::bottom_up;
  const auto camera = make_camera(settings, turning_motion({0, 0.8, 0}),
                                  panorama_of(std::make_shared<EdgeScene>(-0.1)));
  const VideoFrame frame = camera->read().value().value();
  for (const int y : {0, 120, 239}) {
    const double t = 0.1 + 0.030 * (239 - y) / 240.0;
    EXPECT_NEAR(edge_in_row(frame, y), 159.5 + kFocal_px * std::tan(0.1 - 0.8 * t), 0.05) << y;
  }
}

/// White above the horizon.
class HorizonScene : public Scene {
 public:
  [[nodiscard]] Eigen::Vector3d color(const Eigen::Vector3d& direction) const override {
    return Eigen::Vector3d::Constant(direction.z() > 0 ? 0.9 : 0.0);
  }
};

TEST(SyntheticCamera, ColumnsReadInTurnTiltTheHorizon) {
  for (const bool from_left : {true, false}) {
    SyntheticCameraSettings settings = small_camera();
    settings.calibration.readout_direction =
        from_left ? ReadoutDirection::left_right : ReadoutDirection::right_left;
    const auto camera = make_camera(settings, turning_motion({0.8, 0, 0}),
                                    panorama_of(std::make_shared<HorizonScene>()));
    const VideoFrame frame = camera->read().value().value();
    for (const int x : {2, 160, 317}) {
      const double read_before = from_left ? x : 319 - x;
      const double t = 0.1 + 0.030 * read_before / 320.0;
      // Turning up about camera x moves what is ahead down.
      EXPECT_NEAR(edge_in_column(frame, x), 119.5 + kFocal_px * std::tan(0.8 * t), 0.05) << x;
    }
  }
}

TEST(SyntheticCamera, StampsNameTheInstantThatTheCalibrationSays) {
  SyntheticCameraSettings settings = small_camera();
  settings.exposure = milliseconds(8);
  settings.calibration.time_offset = milliseconds(-5);
  const auto stamp_for = [&](TimestampReference reference) {
    settings.calibration.timestamp = reference;
    const auto camera = make_camera(settings, make_hand_motion(tripod(), seconds(1), 1),
                                    panorama_of(std::make_shared<EvenScene>()));
    // Whatever the stamp names, the light is the same.
    EXPECT_EQ(camera->time_of_line(0, 0), SensorTime(milliseconds(96)));
    return camera->stamp(0).time;
  };
  EXPECT_EQ(stamp_for(TimestampReference::readout_start), SensorTime(milliseconds(105)));
  EXPECT_EQ(stamp_for(TimestampReference::exposure_start), SensorTime(milliseconds(97)));
  EXPECT_EQ(stamp_for(TimestampReference::readout_end), SensorTime(milliseconds(135)));
}

TEST(SyntheticCamera, TruthIsWhereThePipelineLooksForIt) {
  for (const auto reference :
       {TimestampReference::readout_start, TimestampReference::exposure_start,
        TimestampReference::readout_end}) {
    for (const auto direction : {ReadoutDirection::top_down, ReadoutDirection::bottom_up,
                                 ReadoutDirection::left_right, ReadoutDirection::right_left}) {
      SyntheticCameraSettings settings = small_camera();
      settings.exposure = microseconds(7300);
      settings.interval_jitter = milliseconds(1);
      settings.calibration.time_offset = milliseconds(13);
      settings.calibration.timestamp = reference;
      settings.calibration.readout_direction = direction;
      const auto camera = make_camera(settings, make_hand_motion(tripod(), seconds(1), 1),
                                      panorama_of(std::make_shared<EvenScene>()));
      const RowTiming timing(settings.calibration);
      for (std::size_t frame = 0; frame < camera->frame_count(); ++frame) {
        for (const int line : {0, 17, 239}) {
          const SensorDuration apart =
              timing.time_of_line(camera->stamp(frame), line) - camera->time_of_line(frame, line);
          EXPECT_LE(std::abs(apart.count()), 2) << line;
        }
      }
    }
  }
}

LensParameters lens_parameters(LensModel model) {
  LensParameters parameters = small_camera().calibration.lens;
  parameters.model = model;
  if (model == LensModel::brown) parameters.distortion = {-0.25, 0.08, 0.001, -0.002};
  if (model == LensModel::fisheye) parameters.distortion = {0.03, -0.01, 0.002, 0.0};
  return parameters;
}

class SyntheticCameraLens : public testing::TestWithParam<LensModel> {};

TEST_P(SyntheticCameraLens, APointIsDrawnWhereItsRowSeesIt) {
  const Eigen::Vector3d point = Eigen::Vector3d(1.0, -0.21, 0.13).normalized();
  SyntheticCameraSettings settings = small_camera();
  settings.calibration.lens = lens_parameters(GetParam());
  settings.exposure = milliseconds(2);
  const Motion motion = turning_motion({0.5, 0.6, 1.2});
  const auto camera = make_camera(settings, motion,
                                  panorama_of(std::make_shared<DotScene>(point, 2.0 / kFocal_px)));
  const Lens lens = Lens::create(settings.calibration.lens).value();
  while (const auto frame = camera->read().value()) {
    const auto index = static_cast<std::size_t>(frame->stamp.index);
    // The row that sees the point depends on where the point is seen: a fixed point.
    Eigen::Vector2d pixel(160, 120);
    for (int i = 0; i < 20; ++i) {
      const SensorTime upper = camera->time_of_line(index, static_cast<int>(std::floor(pixel.y())));
      const SensorTime time =
          upper + duration_from_seconds(0.030 / 240.0 * (pixel.y() - std::floor(pixel.y())));
      pixel = lens.project(motion.at(time).q_world_camera.conjugate() * point).value();
    }
    EXPECT_LT((centroid(*frame) - pixel).norm(), 0.05) << index << ": " << pixel.transpose();
  }
}

INSTANTIATE_TEST_SUITE_P(Models, SyntheticCameraLens,
                         testing::Values(LensModel::pinhole, LensModel::brown, LensModel::fisheye));

TEST(SyntheticCamera, PixelNoiseHasTheVarianceOfPhotonsAndReadout) {
  SyntheticCameraSettings settings = small_camera();
  settings.noise = PixelNoise{2000, 5};
  const auto camera = make_camera(settings, make_hand_motion(tripod(), seconds(1), 1),
                                  panorama_of(std::make_shared<EvenScene>()));
  const VideoFrame frame = camera->read().value().value();
  double sum = 0;
  double squares = 0;
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      const double signal = (frame.planes[0].data[y * frame.planes[0].stride_bytes + x]);
      sum += signal;
      squares += signal * signal;
    }
  }
  constexpr double kCount = 320 * 240;
  const double mean = sum / kCount;
  const double sigma = std::sqrt(squares / kCount - mean * mean);
  // By hand: light 0.25 has sigma sqrt(0.25 * 2000 + 5²) / 2000 in each colour; luma sums three
  // colours with BT.709's weights; the transfer function's slope there is 1.099 * 0.45 *
  // 0.25^-0.55; rounding to bytes adds 1/12.
  const double light_sigma = std::sqrt(0.25 * 2000 + 25) / 2000;
  const double weights = std::sqrt(0.2126 * 0.2126 + 0.7152 * 0.7152 + 0.0722 * 0.0722);
  const double slope = 1.099 * 0.45 * std::pow(0.25, -0.55);
  const double expected = std::sqrt(std::pow(219 * slope * weights * light_sigma, 2) + 1.0 / 12);
  EXPECT_NEAR(sigma / expected, 1.0, 0.02);
}

TEST(SyntheticCamera, SeedDecidesNoiseJitterAndDrops) {
  const auto first_bytes = [](std::uint64_t seed) {
    SyntheticCameraSettings settings = small_camera();
    settings.noise = PixelNoise{};
    settings.seed = seed;
    const auto camera = make_camera(settings, make_hand_motion(tripod(), seconds(1), 1),
                                    panorama_of(std::make_shared<EvenScene>()));
    const VideoFrame frame = camera->read().value().value();
    return std::vector<std::uint8_t>(frame.planes[0].data, frame.planes[0].data + 320);
  };
  EXPECT_EQ(first_bytes(1), first_bytes(1));
  EXPECT_NE(first_bytes(1), first_bytes(2));

  SyntheticCameraSettings settings = small_camera();
  settings.frames = 400;
  settings.interval_jitter = milliseconds(2);
  settings.drop_probability = 0.1;
  const auto motion = std::make_shared<Motion>(make_hand_motion(tripod(), seconds(1), 1));
  const auto panorama = panorama_of(std::make_shared<EvenScene>());
  const auto camera = SyntheticCamera::create(settings, motion, panorama).value();
  const auto same = SyntheticCamera::create(settings, motion, panorama).value();
  EXPECT_EQ(camera->frame_count(), same->frame_count());
  EXPECT_NEAR(static_cast<double>(camera->frame_count()), 360, 5 * std::sqrt(400 * 0.1 * 0.9));
  for (std::size_t i = 1; i < camera->frame_count(); ++i) {
    EXPECT_EQ(camera->stamp(i).time, same->stamp(i).time);
    EXPECT_LT(camera->stamp(i - 1).time, camera->stamp(i).time);
  }
}

TEST(SyntheticCamera, AnInstantReadoutIsTheGlobalShutterPicture) {
  SyntheticCameraSettings settings = small_camera();
  settings.calibration.readout = SensorDuration::zero();
  const Motion motion = turning_motion({0.3, 0.6, 0.9});
  const auto panorama = panorama_of(std::make_shared<EdgeScene>(-0.03));
  const auto camera = make_camera(settings, motion, panorama);
  const VideoFrame frame = camera->read().value().value();
  VirtualCamera truth;
  truth.q_world_camera = motion.at(SensorTime(milliseconds(100))).q_world_camera;
  truth.intrinsics = {kFocal_px, kFocal_px, 159.5, 119.5};
  const VideoFrame expected = render_global_shutter(panorama, truth, {320, 240});
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      ASSERT_NEAR(frame.planes[0].data[y * frame.planes[0].stride_bytes + x],
                  expected.planes[0].data[y * expected.planes[0].stride_bytes + x], 1)
          << x << ' ' << y;
    }
  }
}

TEST(SyntheticCamera, DeliversItsFramesOnceAndAgainAfterANewStart) {
  const auto camera = make_camera(small_camera(), make_hand_motion(tripod(), seconds(1), 1),
                                  panorama_of(std::make_shared<EvenScene>()));
  EXPECT_EQ(camera->format().size, (ImageSize{320, 240}));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(camera->read().value().value().stamp.index, i);
  EXPECT_FALSE(camera->read().value().has_value());
  ASSERT_TRUE(camera->start().has_value());
  EXPECT_EQ(camera->read().value().value().stamp.index, 0);
  camera->stop();
  EXPECT_FALSE(camera->read().value().has_value());
}

TEST(SyntheticCamera, RefusesWhatNoCameraHas) {
  const auto refuses = [](auto change) {
    SyntheticCameraSettings settings = small_camera();
    change(settings);
    return !SyntheticCamera::create(
                settings, std::make_shared<Motion>(make_hand_motion(tripod(), seconds(1), 1)),
                panorama_of(std::make_shared<EvenScene>()))
                .has_value();
  };
  EXPECT_TRUE(refuses([](auto& s) { s.calibration.size = {0, 240}; }));
  EXPECT_TRUE(refuses([](auto& s) { s.calibration.fps = 0; }));
  EXPECT_TRUE(refuses([](auto& s) { s.calibration.fps = std::nan(""); }));
  EXPECT_TRUE(refuses([](auto& s) { s.calibration.readout = milliseconds(40); }));
  EXPECT_TRUE(refuses([](auto& s) { s.exposure = milliseconds(-1); }));
  EXPECT_TRUE(refuses([](auto& s) { s.calibration.lens.K(0, 0) = 0; }));
  EXPECT_FALSE(refuses([](auto&) {}));
}

}  // namespace
}  // namespace gimbal
