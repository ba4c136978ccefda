#include "tests/judge/video_judge.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/judge/fast_part.hpp"
#include "tests/judge/frame_border.hpp"
#include "tests/judge/row_wobble.hpp"

namespace gimbal::judge {
namespace {

constexpr double kCutoff_hz = 1;
constexpr double kEnd_s = 2;
constexpr double kShortest_s = 5;  // of a video that has an inside
constexpr double kDegrees = 180 / std::numbers::pi;
/// A track farther than this share of the width from the camera's rotation is not the scene's.
constexpr double kSceneShare = 1.0 / 64;
constexpr int kViewEvery = 6;         // frames: views change slowly, and comparing takes long
constexpr int kTrackerReach_px = 12;  // of its window, next to what may not be looked at

template <typename Values, typename Of>
double mean_of(const Values& values, Of of) {
  double sum = 0;
  for (const auto& value : values) sum += of(value);
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

double mean(const std::vector<double>& values) {
  return mean_of(values, [](double value) { return value; });
}

double most(const std::vector<double>& values) {
  return values.empty() ? 0 : *std::max_element(values.begin(), values.end());
}

double psnr_db(const cv::Mat& a, const cv::Mat& b) {
  constexpr double kRounding = 1.0 / 12;  // variance of what rounding to whole numbers adds
  const double squares = cv::norm(a, b, cv::NORM_L2SQR) / static_cast<double>(a.total());
  return 10 * std::log10(255.0 * 255.0 / std::max(squares, kRounding));
}

cv::Mat mask_without(const cv::Mat& border) {
  cv::Mat near;
  const cv::Size reach(2 * kTrackerReach_px + 1, 2 * kTrackerReach_px + 1);
  cv::dilate(border, near, cv::getStructuringElement(cv::MORPH_RECT, reach));
  return near == 0;
}

std::vector<Track> of_the_scene(const Pinhole& camera, const cv::Matx33d& R_to_from,
                                const std::vector<Track>& tracks) {
  std::vector<Track> near;
  for (const Track& track : tracks) {
    const double distance = cv::norm(turned(camera, R_to_from, track.from) - track.to);
    if (distance <= kSceneShare * camera.size.width) near.push_back(track);
  }
  return near;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Of the picture's middle, px.
cv::Vec3d motion_of_the_middle(const Pinhole& camera, const cv::Matx33d& R_to_from) {
  const cv::Point2f middle((static_cast<float>(camera.size.width) - 1) / 2,
                           (static_cast<float>(camera.size.height) - 1) / 2);
  const cv::Point2f motion = turned(camera, R_to_from, middle) - middle;
  return {motion.x, motion.y, 0};
}

/// Mean square distance of tracks from their best homography, px².
std::optional<double> homography_residual_px2(const std::vector<Track>& tracks, int width) {
  std::vector<cv::Point2f> from;
  std::vector<cv::Point2f> to;
  for (const Track& track : tracks) {
    from.push_back(track.from);
    to.push_back(track.to);
  }
  if (from.size() < 12) return std::nullopt;
  cv::Mat inliers;
  const cv::Mat H = cv::findHomography(from, to, cv::RANSAC, width / 400.0, inliers);
  if (H.empty()) return std::nullopt;
  std::vector<cv::Point2f> expected;
  cv::perspectiveTransform(from, expected, H);
  double squares = 0;
  for (std::size_t i = 0; i < to.size(); ++i) {
    if (inliers.at<unsigned char>(static_cast<int>(i)) != 0) {
      squares += (expected[i] - to[i]).dot(expected[i] - to[i]);
    }
  }
  return squares / cv::countNonZero(inliers);
}

Judgement::AgainstOriginal summary_of(const std::vector<ShownView>& views) {
  Judgement::AgainstOriginal summary;
  summary.frames = static_cast<int>(views.size());
  summary.zoom = mean_of(views, [](const ShownView& view) { return view.zoom; });
  summary.retained_view = mean_of(views, [](const ShownView& view) { return view.retained; });
  summary.distortion = mean_of(views, [](const ShownView& view) { return view.distortion; });
  for (const ShownView& view : views) {
    summary.worst_distortion = std::max(summary.worst_distortion, view.distortion);
  }
  return summary;
}

/// What pairs of frames tell of motion, in order of time.
class MotionMeasures {
 public:
  MotionMeasures(const Pinhole& camera, double fps) : camera_(camera), fps_(fps) {}

  void add(double time_s, const std::vector<Track>& tracks) {
    const auto R_to_from = fit_rotation(camera_, tracks);
    if (!R_to_from) {
      ++lost_;
      return;
    }
    const std::vector<Track> scene = of_the_scene(camera_, *R_to_from, tracks);
    add_rate(time_s, *R_to_from);
    shifts_.push_back({time_s, motion_of_the_middle(camera_, *R_to_from)});
    wobble_.add(time_s, camera_, *R_to_from, scene);
    if (const auto left = homography_residual_px2(scene, camera_.size.width)) {
      residuals_px2_.push_back(*left);
    }
  }

  void write_to(Judgement& judgement) const {
    const std::vector<cv::Vec3d> shake_deg_s = fast_part(rates_deg_s_, kCutoff_hz);
    judgement.rate_deg_s = rms_length(shake_deg_s);
    judgement.rate_inside_deg_s = rms_inside(shake_deg_s, judgement.frames / fps_);
    judgement.shift_px = rms_length(fast_part(shifts_, kCutoff_hz));
    judgement.wobble_px = wobble_.rms_px(kCutoff_hz);
    judgement.residual_px = std::sqrt(mean(residuals_px2_));
    judgement.lost_pairs = lost_;
    cv::Vec3d turned_deg;
    for (const Measured& rate : rates_deg_s_) {
      turned_deg += rate.value / fps_;
      judgement.path_deg.push_back({rate.time_s + 0.5 / fps_, turned_deg});
    }
  }

 private:
  /// In the axes of the first frame's camera, so that a turn about one axis of the world stays on
  /// one component however the camera rolls.
  void add_rate(double time_s, const cv::Matx33d& R_to_from) {
    cv::Vec3d turn_rad;
    cv::Rodrigues(R_to_from.t(), turn_rad);
    rates_deg_s_.push_back({time_s, fps_ * kDegrees * (R_world_camera_ * turn_rad)});
    R_world_camera_ = R_world_camera_ * R_to_from.t();
  }

  [[nodiscard]] std::optional<double> rms_inside(const std::vector<cv::Vec3d>& shake_deg_s,
                                                 double duration_s) const {
    if (duration_s < kShortest_s) return std::nullopt;
    std::vector<cv::Vec3d> inside;
    for (std::size_t i = 0; i < shake_deg_s.size(); ++i) {
      const double time_s = rates_deg_s_[i].time_s;
      if (time_s >= kEnd_s && time_s <= duration_s - kEnd_s) inside.push_back(shake_deg_s[i]);
    }
    return rms_length(inside);
  }

  Pinhole camera_;
  double fps_;
  cv::Matx33d R_world_camera_ = cv::Matx33d::eye();
  std::vector<Measured> rates_deg_s_;
  std::vector<Measured> shifts_;
  RowWobble wobble_;
  std::vector<double> residuals_px2_;
  int lost_ = 0;
};

}  // namespace

VideoJudge::VideoJudge(double focal_px, double fps) : focal_px_(focal_px), fps_(fps) {}

void VideoJudge::add(const cv::Mat& luma, const std::optional<cv::Mat>& original) {
  cv::Mat border = black_border(luma);
  TrackedPicture picture = make_tracked_picture(luma.clone(), mask_without(border));
  const bool is_view_due = frames_ % kViewEvery == 0;
  if (original && (is_view_due || cv::countNonZero(border) > 0)) {
    if (const auto view = compare_views(*original, picture)) {
      if (is_view_due) views_.push_back(*view);
      border = without_dark_scene(border, *original, view->H_original_output);
      picture.mask = mask_without(border);
    }
  }
  border_shares_.push_back(cv::countNonZero(border) / static_cast<double>(border.total()));
  if (frames_ > 0) {
    psnr_db_.push_back(psnr_db(last_.luma, luma));
    pairs_.push_back({(frames_ - 0.5) / fps_, track_corners(last_, picture)});
  }
  last_ = std::move(picture);
  ++frames_;
}

double VideoJudge::zoom() const {
  if (views_.empty()) return 1;
  std::vector<double> zooms;
  for (const ShownView& view : views_) zooms.push_back(view.zoom);
  return median(std::move(zooms));
}

Judgement VideoJudge::judgement() const {
  Judgement judgement;
  judgement.frames = frames_;
  judgement.itf_db = mean(psnr_db_);
  judgement.border_share = mean(border_shares_);
  judgement.worst_border_share = most(border_shares_);
  if (!views_.empty()) judgement.against_original = summary_of(views_);
  MotionMeasures motion({focal_px_ * zoom(), last_.luma.size()}, fps_);
  for (const Pair& pair : pairs_) motion.add(pair.time_s, pair.tracks);
  motion.write_to(judgement);
  return judgement;
}

}  // namespace gimbal::judge
