// What border fill draws where a frame ends, against what the virtual camera would truly see there:
// a walk through the synthetic street at zoom 1, a rolling shutter of 30 ms.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "drivers/synthetic/hand_motion.hpp"
#include "drivers/synthetic/picture_renderer.hpp"
#include "drivers/synthetic/street_scene.hpp"
#include "drivers/synthetic/synthetic_camera.hpp"
#include "pipeline/fill/border_fill.hpp"
#include "pipeline/fill/past_frames.hpp"
#include "pipeline/path/camera_path.hpp"
#include "pipeline/stabilizer.hpp"
#include "tests/golden/ipod_in_hand.hpp"
#include "tests/support/truth_estimator.hpp"

namespace gimbal {
namespace {

constexpr int kFrames = 60;
constexpr double kFps = 30;
constexpr int kSamplesPerSecond = 500;
constexpr double kScale = 0.5;  // of the iPod's picture
constexpr float kBlack = 16;

CameraCalibration small_camera() {
  CameraCalibration camera = test::ipod_touch();
  camera.size = {640, 360};
  camera.lens.K.topRows<2>() *= kScale;
  return camera;
}

/// The truth, turning away about the vertical as a gyroscope's unknown bias makes it.
class DriftingEstimator final : public Estimator {
 public:
  DriftingEstimator(const Motion& motion, const ImuCalibration& imu, double drift_rad_s)
      : truth_(motion, imu), drift_rad_s_(drift_rad_s) {}

  Attitude update(const ImuSample& sample) override {
    Attitude attitude = truth_.update(sample);
    attitude.q_world_imu = drift(sample.time) * attitude.q_world_imu;
    return attitude;
  }

 private:
  [[nodiscard]] Eigen::Quaterniond drift(SensorTime time) const {
    return Eigen::Quaterniond(
        Eigen::AngleAxisd(drift_rad_s_ * seconds_since_epoch(time), Eigen::Vector3d::UnitZ()));
  }

  test::TruthEstimator truth_;
  double drift_rad_s_;
};

struct Recording {
  CameraCalibration camera = small_camera();
  ImuCalibration imu = test::phone_axes();
  std::shared_ptr<const Motion> motion;
  std::shared_ptr<const Panorama> panorama;
  std::vector<VideoFrame> frames;
};

const Recording& walk() {
  static const Recording recording = [] {
    Recording made;
    made.motion = std::make_shared<const Motion>(
        make_hand_motion(walking_hand(), duration_from_seconds(kFrames / kFps + 0.2), 5));
    const double focal_px = made.camera.lens.K(0, 0);
    made.panorama = std::make_shared<const Panorama>(
        std::make_shared<const StreetScene>(1, 1 / focal_px), focal_px, 2);
    SyntheticCameraSettings settings;
    settings.calibration = made.camera;
    settings.frames = kFrames;
    auto camera = *SyntheticCamera::create(settings, made.motion, made.panorama);
    EXPECT_TRUE(camera->start());
    while (auto frame = *camera->read()) made.frames.push_back(*frame);
    return made;
  }();
  return recording;
}

Nv12Buffer copy_of(const VideoFrame& frame) {
  Nv12Buffer copy(frame.size);
  const ImageSize chroma = chroma_size(frame.size);
  for (int y = 0; y < frame.size.height; ++y) {
    std::copy_n(frame.planes[0].data + y * frame.planes[0].stride_bytes, frame.size.width,
                copy.luma().data + y * copy.luma().stride_bytes);
  }
  for (int y = 0; y < chroma.height; ++y) {
    std::copy_n(frame.planes[1].data + y * frame.planes[1].stride_bytes, 2 * chroma.width,
                copy.chroma().data + y * copy.chroma().stride_bytes);
  }
  return copy;
}

/// Calls change(x, y, luma) for each pixel of a copy.
template <typename Change>
VideoFrame changed(const VideoFrame& frame, Change&& change) {
  Nv12Buffer copy = copy_of(frame);
  for (int y = 0; y < frame.size.height; ++y) {
    for (int x = 0; x < frame.size.width; ++x) {
      std::uint8_t& luma = copy.luma().data[y * copy.luma().stride_bytes + x];
      luma = static_cast<std::uint8_t>(
          std::clamp(change(x, y, static_cast<float>(luma)), 0.0F, 255.0F) + 0.5F);
    }
  }
  return std::move(copy).publish(frame.stamp, frame.color);
}

float luma_at(const VideoFrame& frame, int x, int y) {
  return frame.planes[0].data[y * frame.planes[0].stride_bytes + x];
}

struct Drawn {
  VirtualCamera camera;
  WarpMesh mesh;
  FilledPicture filled;
};

struct Choice {
  PathLatency latency;
  Border border = Border::fill;
  double drift_rad_s = 0;
};

/// As the programs do: frames ahead as far as the latency goes, and some that are past.
std::vector<Drawn> draw_all(const std::vector<VideoFrame>& frames, const Choice& choice) {
  StabilizerOptions options;
  options.border = choice.border;
  auto stabilizer = *Stabilizer::create(walk().camera, walk().imu,
                                        make_causal_stream(std::make_unique<DriftingEstimator>(
                                            *walk().motion, walk().imu, choice.drift_rad_s)),
                                        make_bounded_path({}, {1, 1}, choice.latency), options);
  for (int i = -100; i < (kFrames / kFps + 0.2) * kSamplesPerSecond; ++i) {
    stabilizer.push(ImuSample{time_from_seconds(static_cast<double>(i) / kSamplesPerSecond),
                              Eigen::Vector3d::Zero(), std::nullopt});
  }
  for (const VideoFrame& frame : frames) stabilizer.push(frame.stamp);
  stabilizer.finish();
  const auto warper = make_cpu_warper(1);
  BorderFill fill;
  PastFrames past;
  std::vector<Drawn> all;
  const std::size_t ahead = std::min(choice.latency.value_or(kMostFramesAhead), kMostFramesAhead);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    Drawn drawn{*stabilizer.next_camera(), {}, {}};
    drawn.mesh = stabilizer.mesh_for(drawn.camera);
    std::vector<VideoFrame> others(past.frames().begin(), past.frames().end());
    for (std::size_t j = i + 1; j < std::min(i + 1 + ahead, frames.size()); ++j) {
      others.push_back(frames[j]);
    }
    if (choice.border != Border::fill) others.clear();
    if (is_filled(choice.border)) {
      const auto neighbours = stabilizer.neighbours_of(drawn.camera, others);
      drawn.filled = *fill.draw(*warper, frames[i], drawn.mesh, neighbours);
    } else {
      drawn.filled = {*warper->warp(frames[i], drawn.mesh), count_border_pixels(drawn.mesh)};
    }
    past.push(frames[i]);
    all.push_back(std::move(drawn));
  }
  return all;
}

double border_px(const std::vector<Drawn>& all) {
  double sum = 0;
  for (const Drawn& drawn : all) sum += static_cast<double>(drawn.filled.border_px);
  return sum;
}

/// What the virtual camera truly sees.
VideoFrame truth_of(const Drawn& drawn, double drift_rad_s = 0) {
  VirtualCamera camera = drawn.camera;
  const double turned_rad = drift_rad_s * seconds_since_epoch(camera.stamp.time);
  camera.q_world_camera =
      Eigen::AngleAxisd(-turned_rad, Eigen::Vector3d::UnitZ()) * camera.q_world_camera;
  return render_global_shutter(walk().panorama, camera, walk().camera.size);
}

/// Mean square differences to the truth, where the frame itself shows something and where not.
struct SquareError {
  double covered = 0;
  double filled = 0;

  [[nodiscard]] static double psnr_db(double mean_square) {
    return 10 * std::log10(255 * 255 / mean_square);
  }
};

constexpr int kEvery = 5;

/// What the few pixels that no frame shows, and that are blurred, may cost all that are filled.
constexpr double kBlurredRest_db = 6;

/// Light where the frame itself shows something. The mesh has to end where the frame does.
VideoFrame covered_by(const Drawn& drawn) {
  const VideoFrame light = changed(walk().frames.front(), [](int, int, float) { return 255.0F; });
  return *make_cpu_warper(1)->warp(light, drawn.mesh);
}

template <typename TruthOf>
SquareError error_of(const std::vector<Drawn>& all, const std::vector<Drawn>& with_own_mesh,
                     TruthOf&& truth_of_frame) {
  double sums[2] = {0, 0};
  double pixels[2] = {0, 0};
  for (std::size_t i = 0; i < all.size(); i += kEvery) {
    const VideoFrame truth = truth_of_frame(i);
    const VideoFrame covered = covered_by(with_own_mesh[i]);
    for (int y = 0; y < truth.size.height; ++y) {
      for (int x = 0; x < truth.size.width; ++x) {
        const int part = luma_at(covered, x, y) > 128 ? 0 : 1;
        const double off = luma_at(all[i].filled.picture, x, y) - luma_at(truth, x, y);
        sums[part] += off * off;
        pixels[part] += 1;
      }
    }
  }
  return {sums[0] / pixels[0], sums[1] / pixels[1]};
}

class FillAtLatency : public ::testing::TestWithParam<PathLatency> {};

TEST_P(FillAtLatency, LeavesAFifthOfTheBorderAtMost) {
  const double black = border_px(draw_all(walk().frames, {GetParam(), Border::black}));
  const double filled = border_px(draw_all(walk().frames, {GetParam(), Border::fill}));
  const double all_px = kFrames * 640.0 * 360;
  fmt::print("without a source: {:.2f} % black, {:.3f} % filled\n", 100 * black / all_px,
             100 * filled / all_px);
  ASSERT_GT(black, 0.02 * all_px);
  EXPECT_LE(filled, 0.2 * black);
}

INSTANTIATE_TEST_SUITE_P(Walk, FillAtLatency,
                         ::testing::Values(PathLatency{}, PathLatency{15}, PathLatency{5}));

TEST(BorderFill, ShowsWhatIsTrulyThere) {
  const auto all = draw_all(walk().frames, {});
  const auto truth = [&](std::size_t i) { return truth_of(all[i]); };
  const auto filled_psnr_db = [&](Border border) {
    const auto others = draw_all(walk().frames, {std::nullopt, border});
    return SquareError::psnr_db(error_of(others, all, truth).filled);
  };
  const SquareError error = error_of(all, all, truth);
  const double own = SquareError::psnr_db(error.covered);
  const double filled = SquareError::psnr_db(error.filled);
  const double mirrored = filled_psnr_db(Border::mirror);
  const double blurred = filled_psnr_db(Border::blur);
  fmt::print(
      "PSNR to the truth: the frame's own {:.1f} dB, filled {:.1f}, mirrored {:.1f}, "
      "blurred {:.1f}\n",
      own, filled, mirrored, blurred);
  EXPECT_GT(filled, own - kBlurredRest_db);
  EXPECT_GT(filled, mirrored + 10);
  EXPECT_GT(filled, blurred + 8);
}

TEST(BorderFill, FollowsOrientationsThatDriftApart) {
  constexpr double kDrift_rad_s = 0.012;  // a gyroscope's unknown bias
  const auto all = draw_all(walk().frames, {std::nullopt, Border::fill, kDrift_rad_s});
  const SquareError error =
      error_of(all, all, [&](std::size_t i) { return truth_of(all[i], kDrift_rad_s); });
  fmt::print("PSNR to the truth: own {:.1f} dB, filled {:.1f}\n",
             SquareError::psnr_db(error.covered), SquareError::psnr_db(error.filled));
  EXPECT_GT(SquareError::psnr_db(error.filled),
            SquareError::psnr_db(error.covered) - kBlurredRest_db);
}

/// Exposure that changes by up to a fifth from frame to frame.
float exposure_of(std::size_t frame) {
  return 1 + 0.2F * std::sin(1.7F * static_cast<float>(frame));
}

VideoFrame exposed(const VideoFrame& frame, float gain) {
  return changed(frame, [gain](int, int, float luma) { return kBlack + gain * (luma - kBlack); });
}

TEST(BorderFill, MatchesTheExposure) {
  std::vector<VideoFrame> frames;
  for (std::size_t i = 0; i < walk().frames.size(); ++i) {
    frames.push_back(exposed(walk().frames[i], exposure_of(i)));
  }
  const auto all = draw_all(frames, {});
  const SquareError error =
      error_of(all, all, [&](std::size_t i) { return exposed(truth_of(all[i]), exposure_of(i)); });
  fmt::print("PSNR to the truth: own {:.1f} dB, filled {:.1f}\n",
             SquareError::psnr_db(error.covered), SquareError::psnr_db(error.filled));
  EXPECT_GT(SquareError::psnr_db(error.filled),
            SquareError::psnr_db(error.covered) - kBlurredRest_db);
}

/// Something that flies about at the right edge of the picture: a chequered ball.
class Ball {
 public:
  static constexpr double kRadius_px = 40;
  static constexpr double kSquare_px = 16;

  /// Where the camera sees its middle.
  [[nodiscard]] Eigen::Vector2d middle_px(const VirtualCamera& camera) const {
    const double time_s = seconds_since_epoch(camera.stamp.time);
    const double right_rad = 0.47 + 0.07 * std::sin(11 * time_s);
    const Eigen::Vector3d ahead = walk().motion->at(time_from_seconds(1)).q_world_camera *
                                  Eigen::Vector3d(std::sin(right_rad), 0, std::cos(right_rad));
    const Eigen::Vector3d ray = camera.q_world_camera.conjugate() * ahead;
    return {camera.intrinsics.fx * ray.x() / ray.z() + camera.intrinsics.cx,
            camera.intrinsics.fy * ray.y() / ray.z() + camera.intrinsics.cy};
  }

  [[nodiscard]] VideoFrame painted(const VideoFrame& frame, const VirtualCamera& camera) const {
    const Eigen::Vector2d middle = middle_px(camera);
    return changed(frame, [&](int x, int y, float luma) {
      const Eigen::Vector2d off = Eigen::Vector2d(x, y) - middle;
      if (off.norm() > kRadius_px) return luma;
      const int squares = static_cast<int>((off.x() + kRadius_px) / kSquare_px) +
                          static_cast<int>((off.y() + kRadius_px) / kSquare_px);
      return squares % 2 == 0 ? 210.0F : 160.0F;
    });
  }
};

VirtualCamera real_camera(const FrameStamp& stamp) {
  const Eigen::Matrix3d& K = walk().camera.lens.K;
  VirtualCamera camera;
  camera.stamp = stamp;
  camera.q_world_camera = walk().motion->at(stamp.time + walk().camera.readout / 2).q_world_camera;
  camera.intrinsics = {K(0, 0), K(1, 1), K(0, 2), K(1, 2)};
  return camera;
}

/// Rows in which the frame's right edge cuts the ball, and those of them in which the picture jumps
/// there by far more than the truth does, or shows something else over what the frame shows.
struct Tears {
  int rows = 0;
  int torn = 0;

  void look_at(const VideoFrame& picture, const VideoFrame& truth, const VideoFrame& covered,
               const Eigen::Vector2d& middle_px) {
    constexpr int kAside = 2;
    constexpr int kInside = 5;
    constexpr float kFar_levels = 50;
    for (int y = 0; y < truth.size.height; ++y) {
      int edge = truth.size.width - 1;
      while (edge > 0 && luma_at(covered, edge, y) < 128) --edge;
      const bool cuts = (Eigen::Vector2d(edge, y) - middle_px).norm() < Ball::kRadius_px - kInside;
      if (!cuts || edge + kAside >= truth.size.width) continue;
      const auto step = [&](const VideoFrame& frame) {
        return std::abs(luma_at(frame, edge + kAside, y) - luma_at(frame, edge - kAside, y));
      };
      const bool is_overlaid = std::abs(luma_at(picture, edge - kInside, y) -
                                        luma_at(truth, edge - kInside, y)) > kFar_levels;
      rows += 1;
      if (is_overlaid || step(picture) > step(truth) + kFar_levels) torn += 1;
    }
  }
};

TEST(BorderFill, DoesNotTearWhatMoves) {
  const Ball ball;
  std::vector<VideoFrame> frames;
  for (const VideoFrame& frame : walk().frames) {
    frames.push_back(ball.painted(frame, real_camera(frame.stamp)));
  }
  Tears tears;
  for (const Drawn& drawn : draw_all(frames, {})) {
    tears.look_at(drawn.filled.picture, ball.painted(truth_of(drawn), drawn.camera),
                  covered_by(drawn), ball.middle_px(drawn.camera));
  }
  fmt::print("{} of {} rows torn\n", tears.torn, tears.rows);
  ASSERT_GT(tears.rows, 200);
  EXPECT_LE(tears.torn, 0.1 * tears.rows);  // more than half where all are trusted
}

TEST(BorderFill, LeavesAWholePictureAlone) {
  const VideoFrame& frame = walk().frames.front();
  VirtualCamera zoomed_in = real_camera(frame.stamp);
  zoomed_in.intrinsics = zoomed(zoomed_in.intrinsics, frame.size, 1.5);
  const auto truth = [](double) { return Eigen::Quaterniond::Identity(); };
  zoomed_in.q_world_camera = truth(0);
  const WarpMesh mesh =
      build_warp_mesh(*Lens::create(walk().camera.lens), frame.size, ReadoutDirection::top_down,
                      truth, zoomed_in, frame.size, Border::fill, MeshDensity{});
  const auto warper = make_cpu_warper(1);
  const auto filled = BorderFill().draw(*warper, frame, mesh, {});
  const auto warped = warper->warp(frame, mesh);
  ASSERT_TRUE(filled && warped);
  EXPECT_EQ(filled->border_px, 0);
  int different = 0;
  for (int y = 0; y < frame.size.height; ++y) {
    for (int x = 0; x < frame.size.width; ++x) {
      if (luma_at(filled->picture, x, y) != luma_at(*warped, x, y)) ++different;
    }
  }
  EXPECT_EQ(different, 0);
}

}  // namespace
}  // namespace gimbal
