// Rectified and stabilized pictures against the truth: where each point of a written frame is
// shown, and where a camera with a global shutter in the virtual camera's place would have shown
// it. The motion is a real hand's, known exactly at every instant; the figures are for the iPod
// touch of the thesis at 1280x720 with a readout of 30 ms.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/synthetic/motion.hpp"
#include "drivers/synthetic/synthetic_imu.hpp"
#include "pipeline/estimator/thesis_ekf.hpp"
#include "pipeline/stabilizer.hpp"
#include "pipeline/timing/imu_aligner.hpp"
#include "tests/golden/ipod_in_hand.hpp"
#include "tests/support/truth_error.hpp"
#include "tests/support/truth_estimator.hpp"

namespace gimbal {
namespace {

constexpr ImageSize kSize{1280, 720};
constexpr int kGridColumns = 16;
constexpr int kGridRows = 18;

/// A phone's sensors: 100 Hz like the log, the log's own bias, noise as in data sheets (BMI160:
/// 0.007 deg/s/√Hz, 180 µg/√Hz).
SyntheticImuSettings phone_sensors(double duration_s) {
  SyntheticImuSettings settings;
  settings.R_camera_imu = test::phone_axes().R_camera_imu;
  settings.span = {time_from_seconds(0), time_from_seconds(duration_s)};
  settings.gyro_clock = {100, {}};
  settings.accel_clock = {100, std::chrono::milliseconds(1)};
  settings.gyro.noise_density = 0.007 * std::numbers::pi / 180;
  settings.gyro.bias = {-0.0077, -0.0017, 0.0193};
  settings.accel.noise_density = 180e-6 * 9.80665;
  settings.seed = 1;
  return settings;
}

struct Part {
  std::string name;
  double start_s;
  double duration_s;
};

void PrintTo(const Part& part, std::ostream* stream) {
  *stream << part.name;
}

/// Errors of all frames of a part, in output pixels.
struct Errors {
  std::vector<double> before;
  std::vector<double> after;
  std::vector<double> after_without_rotation;
};

void append(std::vector<double>& to, const std::vector<double>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

class Rectification : public ::testing::TestWithParam<Part> {
 protected:
  Rectification()
      : motion_(test::hand_motion(GetParam().start_s, GetParam().duration_s)),
        camera_(test::ipod_touch()),
        lens_(*Lens::create(camera_.lens)) {}

  /// The instants of rows, written out here once more so that the pipeline's are not their own
  /// truth.
  [[nodiscard]] test::TrueOrientation truth_of(const FrameStamp& stamp) const {
    return [this, stamp](double line) {
      const double fraction = std::clamp(line, 0.0, kSize.height - 1.0) / kSize.height;
      return motion_.at(stamp.time + duration_from_seconds(0.030 * fraction)).q_world_camera;
    };
  }

  [[nodiscard]] Errors run(std::unique_ptr<AttitudeStream> attitudes,
                           const std::vector<ImuSample>& samples) const;
  void measure(const Stabilizer& stabilizer, const VirtualCamera& camera, Errors& errors) const;

  Motion motion_;
  CameraCalibration camera_;
  Lens lens_;
};

Errors Rectification::run(std::unique_ptr<AttitudeStream> attitudes,
                          const std::vector<ImuSample>& samples) const {
  // The harshest frame is bent by 65 px; what does not fit would be rectified in part.
  constexpr ZoomChoice kZoom = {1.3, 1.3};
  auto stabilizer = Stabilizer::create(camera_, test::phone_axes(), std::move(attitudes),
                                       make_adaptive_hann_path({}, kZoom, std::nullopt), {});
  if (!stabilizer) throw std::runtime_error(stabilizer.error().message);
  for (const ImuSample& sample : samples) stabilizer->push(sample);
  const int frames = static_cast<int>((GetParam().duration_s - 0.1) * camera_.fps);
  for (int i = 0; i < frames; ++i) {
    const SensorTime time = time_from_seconds(i / camera_.fps);
    stabilizer->push(FrameStamp{i, time, std::nullopt});
  }
  stabilizer->finish();
  Errors errors;
  while (const auto camera = stabilizer->next_camera()) measure(*stabilizer, *camera, errors);
  return errors;
}

void Rectification::measure(const Stabilizer& stabilizer, const VirtualCamera& camera,
                            Errors& errors) const {
  const auto truth = truth_of(camera.stamp);
  const auto compare = [&](const test::SourceMap& map, const VirtualCamera& against) {
    return test::compare_with_truth(map, lens_, ReadoutDirection::top_down, truth, against, kSize,
                                    kGridColumns, kGridRows);
  };
  const WarpMesh mesh = stabilizer.mesh_for(camera);
  const auto drawn = compare([&](const auto& pixel) { return source_of(mesh, pixel); }, camera);
  append(errors.after, test::errors_px(drawn, camera.intrinsics));
  append(errors.after_without_rotation,
         test::errors_px(test::without_common_rotation(drawn), camera.intrinsics));

  const VirtualCamera as_recorded{
      camera.stamp, truth((kSize.height - 1) / 2.0), {1223.0, 1217.5, 650.4, 345.3}};
  const auto raw = compare([](const auto& pixel) { return std::optional(pixel); }, as_recorded);
  append(errors.before,
         test::errors_px(test::without_common_rotation(raw), as_recorded.intrinsics));
}

std::vector<ImuSample> samples_of(ImuSource& source) {
  std::vector<ImuSample> samples;
  ImuAligner aligner(Accelerometer::present);
  EXPECT_TRUE(source.start());
  while (const auto reading = source.read().value()) {
    std::visit([&](const auto& sample) { aligner.push(sample); }, *reading);
  }
  aligner.finish();
  while (const auto sample = aligner.pop()) samples.push_back(*sample);
  return samples;
}

TEST_P(Rectification, TrueOrientationDrawsTheTruth) {
  std::vector<ImuSample> instants;
  for (double t = -0.01; t < GetParam().duration_s; t += 0.001) {
    instants.push_back({time_from_seconds(t), Eigen::Vector3d::Zero(), std::nullopt});
  }
  const Errors errors =
      run(make_causal_stream(std::make_unique<test::TruthEstimator>(motion_, test::phone_axes())),
          instants);
  fmt::print(
      "{}: before mean {:.3f} max {:.2f} px; after, true orientation: mean {:.4f} max {:.4f} "
      "px\n",
      GetParam().name, test::mean(errors.before), test::maximum(errors.before),
      test::mean(errors.after), test::maximum(errors.after));
  EXPECT_GT(test::mean(errors.before), test::mean(errors.after));
  EXPECT_LE(test::mean(errors.after), 0.10);
  EXPECT_LE(test::maximum(errors.after), 0.5);
  EXPECT_EQ(errors.after.size(), errors.before.size());  // no point of the view is without a source
}

TEST_P(Rectification, NoisySensorsStayClose) {
  const auto imu = SyntheticImu::create(phone_sensors(GetParam().duration_s), motion_);
  ASSERT_TRUE(imu) << imu.error().message;
  const std::vector<ImuSample> samples = samples_of(**imu);
  const auto stays_close = [&](std::string_view name, std::unique_ptr<AttitudeStream> attitudes) {
    const Errors errors = run(std::move(attitudes), samples);
    fmt::print(
        "{}: before mean {:.3f} max {:.2f} px; after, noisy sensors, {}: mean {:.4f} max {:.4f} px "
        "(one rotation a frame taken out)\n",
        GetParam().name, test::mean(errors.before), test::maximum(errors.before), name,
        test::mean(errors.after_without_rotation), test::maximum(errors.after_without_rotation));
    EXPECT_LE(test::mean(errors.after_without_rotation), 0.6);
  };
  stays_close("thesis EKF", make_causal_stream(std::make_unique<ThesisEkf>()));
  stays_close("attitude EKF", make_causal_stream(AttitudeEkfParameters{}));
  FixedLagSmootherParameters whole;
  whole.lag = std::nullopt;
  stays_close("attitude EKF, looking back", make_smoothed_stream(whole));
}

INSTANTIATE_TEST_SUITE_P(IphoneMotion, Rectification,
                         ::testing::Values(Part{"calm_0_4_s", 0, 4}, Part{"harsh_12_16_s", 12, 4},
                                           Part{"harsh_24_32_s", 24, 8}),
                         [](const auto& part) { return part.param.name; });

}  // namespace
}  // namespace gimbal
