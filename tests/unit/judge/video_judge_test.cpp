#include "tests/judge/video_judge.hpp"

#include <gtest/gtest.h>

#include "tests/unit/judge/moving_picture.hpp"

namespace gimbal::judge {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

template <typename Frame>
Judgement judged(int frames, Frame frame_at) {
  VideoJudge judge(kCamera.focal_px, kFps);
  for (int i = 0; i < frames; ++i) judge.add(frame_at(i / kFps), std::nullopt);
  return judge.judgement();
}

TEST(VideoJudge, KnowsTheRateOfAShake) {
  constexpr double kHz = 5;
  const cv::Vec3d amplitude_rad(0.004, 0.006, 0.008);
  const cv::Mat wall = texture();
  const Judgement judgement =
      judged(90, [&](double time_s) { return seen(wall, sine(kHz, time_s) * amplitude_rad); });
  const double expected_deg_s = cv::norm(amplitude_rad) * kDegrees * kFps * rms_step(kHz);
  EXPECT_EQ(judgement.lost_pairs, 0);
  EXPECT_NEAR(judgement.rate_deg_s, expected_deg_s, 0.02 * expected_deg_s);
  const double expected_px = kCamera.focal_px * std::hypot(0.004, 0.006) * rms_step(kHz);
  EXPECT_NEAR(judgement.shift_px, expected_px, 0.02 * expected_px);
}

TEST(VideoJudge, TellsTheEndsFromTheInside) {
  const cv::Mat wall = texture();
  const cv::Mat still = seen(wall, {0, 0, 0});
  const auto shaken_until_1_s = [&](double time_s) {
    return time_s < 1 ? seen(wall, {0.004 * sine(5, time_s), 0, 0}) : still;
  };
  const Judgement judgement = judged(160, shaken_until_1_s);
  ASSERT_TRUE(judgement.rate_inside_deg_s);
  EXPECT_GT(judgement.rate_deg_s, 1);
  EXPECT_LT(*judgement.rate_inside_deg_s, 0.01);
  EXPECT_FALSE(judged(140, [&](double) { return still; }).rate_inside_deg_s);
}

TEST(VideoJudge, DoesNotBlameAPan) {
  const cv::Mat wall = texture();
  const Judgement judgement = judged(60, [&](double time_s) {
    return seen(wall, {0, 0.2 * time_s, 0});
  });
  EXPECT_EQ(judgement.lost_pairs, 0);
  EXPECT_LT(judgement.rate_deg_s, 0.02 * 0.2 * kDegrees);
  ASSERT_EQ(judgement.path_deg.size(), 59U);
  EXPECT_NEAR(judgement.path_deg.back().time_s, 59 / kFps, 1e-9);
  EXPECT_NEAR(judgement.path_deg.back().value[1], 0.2 * 59 / kFps * kDegrees, 0.1);
}

TEST(VideoJudge, FindsAStillVideoStill) {
  const cv::Mat still = seen(texture(), {0, 0, 0});
  const Judgement judgement = judged(10, [&](double) { return still; });
  EXPECT_EQ(judgement.frames, 10);
  EXPECT_LT(judgement.rate_deg_s, 1e-3);
  EXPECT_LT(judgement.shift_px, 1e-3);
  EXPECT_LT(judgement.wobble_px, 1e-3);
  EXPECT_LT(judgement.residual_px, 1e-3);
  EXPECT_EQ(judgement.border_share, 0);
  EXPECT_NEAR(judgement.itf_db, 58.9, 0.05);
  EXPECT_FALSE(judgement.against_original);
}

TEST(VideoJudge, MeasuresFidelityByTheNoise) {
  constexpr double kNoise = 4;
  const cv::Mat still = seen(texture(), {0, 0, 0});
  cv::RNG random(5);
  const Judgement judgement = judged(10, [&](double) {
    cv::Mat noise(kSize, CV_16S);
    random.fill(noise, cv::RNG::NORMAL, 0, kNoise);
    cv::Mat noisy;
    cv::add(still, noise, noisy, cv::noArray(), CV_8U);
    return noisy;
  });
  EXPECT_NEAR(judgement.itf_db, 10 * std::log10(255 * 255 / (2 * kNoise * kNoise)), 0.1);
}

TEST(VideoJudge, DoesNotFollowABorder) {
  const cv::Mat wall = texture();
  const Judgement judgement = judged(30, [&](double time_s) {
    cv::Mat frame = seen(wall, {0, 0, 0});
    frame.colRange(0, 30 + cvRound(10 * sine(5, time_s))).setTo(16);
    return frame;
  });
  EXPECT_LT(judgement.rate_deg_s, 0.01);
  EXPECT_NEAR(judgement.border_share, 30.0 / 480, 0.005);
  EXPECT_NEAR(judgement.worst_border_share, 40.0 / 480, 0.005);
}

TEST(VideoJudge, DoesNotTakeADarkSceneForABorder) {
  cv::Mat original = seen(texture(), {0, 0, 0});
  original.rowRange(250, 270).setTo(16);  // a dashboard
  cv::Mat output;
  cv::warpAffine(original, output, cv::Matx23d(1, 0, -24, 0, 1, 0), kSize, cv::WARP_INVERSE_MAP,
                 cv::BORDER_CONSTANT, 16);  // with 24 px to the left that have no source
  VideoJudge judge(kCamera.focal_px, kFps);
  for (int i = 0; i < 2; ++i) judge.add(output, original);
  EXPECT_NEAR(judge.judgement().border_share, 24.0 * 250 / kSize.area(), 0.003);
}

TEST(VideoJudge, CountsPairsInWhichNothingIsSeen) {
  const cv::Mat wall = texture();
  const Judgement judgement = judged(10, [&](double time_s) {
    return time_s > 0.15 && time_s < 0.18 ? cv::Mat(kSize, CV_8UC1, cv::Scalar(90))
                                          : seen(wall, {0, 0, 0});
  });
  EXPECT_EQ(judgement.lost_pairs, 2);
}

TEST(VideoJudge, ScalesTheRateByTheZoomAgainstTheOriginal) {
  constexpr double kHz = 5;
  constexpr double kZoom = 1.2;
  const double amplitude_rad = 0.006;
  const cv::Mat wall = texture();
  VideoJudge judge(kCamera.focal_px, kFps);
  for (int i = 0; i < 60; ++i) {
    const cv::Mat original = seen(wall, {0, amplitude_rad * sine(kHz, i / kFps), 0});
    cv::Mat zoomed;
    const double scale = 1 / kZoom;
    const cv::Matx23d about_the_middle(scale, 0, (1 - scale) * (kSize.width - 1) / 2.0, 0, scale,
                                       (1 - scale) * (kSize.height - 1) / 2.0);
    cv::warpAffine(original, zoomed, about_the_middle, kSize,
                   cv::INTER_CUBIC | cv::WARP_INVERSE_MAP);
    judge.add(zoomed, original);
  }
  const Judgement judgement = judge.judgement();
  ASSERT_TRUE(judgement.against_original);
  EXPECT_NEAR(judgement.against_original->zoom, kZoom, 0.003);
  const double expected_deg_s = amplitude_rad * kDegrees * kFps * rms_step(kHz);
  EXPECT_NEAR(judgement.rate_deg_s, expected_deg_s, 0.02 * expected_deg_s);
}

}  // namespace
}  // namespace gimbal::judge
