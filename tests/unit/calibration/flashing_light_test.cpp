#include "pipeline/calibration/flashing_light.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "drivers/synthetic/random.hpp"

namespace gimbal {
namespace {

using ::testing::HasSubstr;

struct Filmed {
  double light_hz = 500;
  double readout_s = 0.0283;
  double exposure_s = 0.6e-3;
  double led = 1;        ///< 0: off
  double ambient = 0.1;  ///< of the light's own brightness
  double mains_hz = 0;   ///< 0: none
  double mains = 0;      ///< how bright
  int lines = 480;
  int frames = 60;
  double fps = 30;
};

/// Time from zero to `time_s` during which a square wave is on, first from zero on.
double lit_s(double time_s, double light_hz) {
  const double periods = std::floor(time_s * light_hz);
  const double into = time_s - periods / light_hz;
  return periods / (2 * light_hz) + std::min(into, 0.5 / light_hz);
}

/// Integral over the exposure, not a model of what it looks like: time of light that each line got.
std::vector<LineProfile> film(const Filmed& scene) {
  Random random(1);
  std::vector<LineProfile> profiles;
  for (int frame = 0; frame < scene.frames; ++frame) {
    LineProfile profile;
    profile.time_s = 100 + frame / scene.fps;
    for (int line = 0; line < scene.lines; ++line) {
      const double end_s = profile.time_s + scene.readout_s * line / scene.lines;
      const double begin_s = end_s - scene.exposure_s;
      const double middle_s = (begin_s + end_s) / 2;
      const double lit =
          (lit_s(end_s, scene.light_hz) - lit_s(begin_s, scene.light_hz)) / scene.exposure_s;
      const double mains =
          scene.mains * (1 + 0.5 * std::cos(2 * std::numbers::pi * scene.mains_hz * middle_s));
      const double vignette = 1 - 0.4 * std::pow(2.0 * line / scene.lines - 1, 2);
      profile.light.push_back(vignette * (scene.led * lit + scene.ambient + mains) +
                              0.003 * random.normal());
    }
    profiles.push_back(profile);
  }
  return profiles;
}

TEST(FlashingLight, TellsReadoutAndExposureToOnePercent) {
  for (const double light_hz : {247.0, 500.3, 1013.0}) {
    for (const double exposure_s : {0.15e-3, 0.3e-3, 0.45e-3}) {
      Filmed scene;
      scene.light_hz = light_hz;
      scene.exposure_s = exposure_s;
      const FlashingLight found = measure_flashing_light(film(scene), light_hz);
      ASSERT_EQ(found.reason, "") << light_hz << " Hz, " << exposure_s << " s";
      EXPECT_NEAR(found.readout_s, scene.readout_s, 0.01 * scene.readout_s);
      EXPECT_LT(found.readout_sigma_s, 0.005 * scene.readout_s);
      ASSERT_TRUE(found.exposure_s);
      EXPECT_NEAR(*found.exposure_s, exposure_s, 0.01 * exposure_s + 4e-6) << light_hz;
    }
  }
}

TEST(FlashingLight, IsFoundBesideALampOnTheMains) {
  Filmed scene;
  scene.mains_hz = 100;
  scene.mains = 2;
  const FlashingLight found = measure_flashing_light(film(scene), scene.light_hz);
  ASSERT_EQ(found.reason, "");
  EXPECT_NEAR(found.readout_s, scene.readout_s, 0.01 * scene.readout_s);
}

TEST(FlashingLight, IsNotTakenForALampOnTheMains) {
  for (const double mains_hz : {100.0, 120.0}) {
    Filmed scene;
    scene.led = 0;
    scene.mains_hz = mains_hz;
    scene.mains = 1;
    scene.fps = 29.0;
    EXPECT_THAT(measure_flashing_light(film(scene), 500.3).reason,
                HasSubstr(mains_hz == 100 ? "mains (100 Hz)" : "mains (120 Hz)"));
  }
}

TEST(FlashingLight, OfAnotherFrequencyIsNotMeasured) {
  Filmed scene;
  scene.light_hz = 437;
  EXPECT_THAT(measure_flashing_light(film(scene), 500.3).reason, HasSubstr("do not move on"));
}

TEST(FlashingLight, IsMissedWhereThereIsNone) {
  Filmed scene;
  scene.exposure_s = 0.02;  // ten periods: nothing is left of them
  EXPECT_THAT(measure_flashing_light(film(scene), 500).reason, HasSubstr("no bands"));
  scene.frames = 5;
  EXPECT_THAT(measure_flashing_light(film(scene), 500).reason, HasSubstr("only 5 frames"));
}

// 120 Hz moves on by 4.096 turns a frame, 500.3 Hz by 17.075.
TEST(FlashingLight, MustNotLookLikeTheMains) {
  Filmed scene;
  scene.light_hz = 500.3;
  scene.fps = 29.3;
  EXPECT_THAT(measure_flashing_light(film(scene), 500.3).reason, HasSubstr("looks like a lamp"));
}

TEST(FlashingLight, MustNotStandStill) {
  Filmed scene;
  scene.light_hz = 510;
  EXPECT_THAT(measure_flashing_light(film(scene), 510).reason, HasSubstr("multiple of the frame"));
}

}  // namespace
}  // namespace gimbal
