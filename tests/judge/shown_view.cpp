#include "tests/judge/shown_view.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace gimbal::judge {
namespace {

constexpr int kCoarseWidth_px = 160;
constexpr double kTemplateShare = 0.6;  // of the output's width and height, in its middle
constexpr double kPaddingShare = 0.25;  // the output may look past the original's edge
constexpr double kLeastCorrelation = 0.5;
constexpr std::size_t kLeastTracks = 20;

cv::Point2d project(const cv::Matx33d& H, const cv::Point2d& p) {
  const cv::Vec3d q = H * cv::Vec3d(p.x, p.y, 1);
  return {q[0] / q[2], q[1] / q[2]};
}

struct Place {
  double correlation = 0;
  double zoom = 1;
  double roll_deg = 0;  ///< of the output against the original, clockwise on the screen
  cv::Point2d middle;   ///< of the output, in the original's px
};

/// Where the template lies best if it is shrunk by `zoom`.
Place best_place(const cv::Mat& padded, cv::Point padding, const cv::Mat& in_middle, double zoom) {
  cv::Mat shrunk;
  cv::resize(in_middle, shrunk, {}, 1 / zoom, 1 / zoom, cv::INTER_AREA);
  cv::Mat correlation;
  cv::matchTemplate(padded, shrunk, correlation, cv::TM_CCOEFF_NORMED);
  Place place;
  cv::Point corner;
  cv::minMaxLoc(correlation, nullptr, &place.correlation, nullptr, &corner);
  place.zoom = zoom;
  place.middle =
      cv::Point2d(corner - padding) + cv::Point2d((shrunk.cols - 1) / 2.0, (shrunk.rows - 1) / 2.0);
  return place;
}

Place find_coarsely(const cv::Mat& original, const cv::Mat& output) {
  const double shrink = static_cast<double>(kCoarseWidth_px) / original.cols;
  cv::Mat small_original;
  cv::Mat small_output;
  cv::resize(original, small_original, {}, shrink, shrink, cv::INTER_AREA);
  cv::resize(output, small_output, {}, shrink, shrink, cv::INTER_AREA);
  const cv::Point padding(cvRound(kPaddingShare * small_original.cols),
                          cvRound(kPaddingShare * small_original.rows));
  cv::Mat padded;
  cv::copyMakeBorder(small_original, padded, padding.y, padding.y, padding.x, padding.x,
                     cv::BORDER_REPLICATE);
  const cv::Size size(cvRound(kTemplateShare * small_output.cols),
                      cvRound(kTemplateShare * small_output.rows));
  const cv::Rect inside((small_output.cols - size.width) / 2, (small_output.rows - size.height) / 2,
                        size.width, size.height);
  const cv::Point2f middle((static_cast<float>(small_output.cols) - 1) / 2,
                           (static_cast<float>(small_output.rows) - 1) / 2);
  Place best;
  for (const double roll_deg : {-10.0, -5.0, 0.0, 5.0, 10.0}) {
    cv::Mat rolled_back;
    cv::warpAffine(small_output, rolled_back, cv::getRotationMatrix2D(middle, roll_deg, 1),
                   small_output.size());
    for (double zoom = 0.8; zoom < 2.01; zoom *= 1.08) {
      Place place = best_place(padded, padding, rolled_back(inside), zoom);
      place.roll_deg = roll_deg;
      if (place.correlation > best.correlation) best = place;
    }
  }
  best.middle = (best.middle + cv::Point2d(0.5, 0.5)) / shrink - cv::Point2d(0.5, 0.5);
  return best;
}

cv::Matx33d similarity_at(const Place& place, cv::Size size) {
  const cv::Point2f middle((static_cast<float>(size.width) - 1) / 2,
                           (static_cast<float>(size.height) - 1) / 2);
  cv::Matx23d A = cv::getRotationMatrix2D(middle, place.roll_deg, 1 / place.zoom);
  A(0, 2) += place.middle.x - middle.x;
  A(1, 2) += place.middle.y - middle.y;
  return {A(0, 0), A(0, 1), A(0, 2), A(1, 0), A(1, 1), A(1, 2), 0, 0, 1};
}

/// A better homography, from corners followed into the original as the given one shows it.
std::optional<cv::Matx33d> refined(const cv::Mat& original, const TrackedPicture& output,
                                   const cv::Matx33d& H_original_output) {
  cv::Mat shown;
  cv::Mat has_source;
  const int flags = cv::INTER_LINEAR | cv::WARP_INVERSE_MAP;
  cv::warpPerspective(original, shown, H_original_output, original.size(), flags,
                      cv::BORDER_REPLICATE);
  cv::warpPerspective(cv::Mat(original.size(), CV_8UC1, cv::Scalar(255)), has_source,
                      H_original_output, original.size(), flags);
  std::vector<cv::Point2f> from;
  std::vector<cv::Point2f> to;
  for (const Track& track : track_corners(output, make_tracked_picture(shown, has_source))) {
    from.push_back(track.from);
    to.push_back(track.to);
  }
  if (from.size() < kLeastTracks) return std::nullopt;
  const cv::Mat H_shown_output = cv::findHomography(from, to, cv::RANSAC, original.cols / 250.0);
  if (H_shown_output.empty()) return std::nullopt;
  return H_original_output * cv::Matx33d(H_shown_output);
}

double retained_share(const cv::Matx33d& H, cv::Size size) {
  const auto corner = [&](double x, double y) {
    return cv::Point2f(project(H, {x * size.width - 0.5, y * size.height - 0.5}));
  };
  const std::vector<cv::Point2f> outline = {corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
  const auto right = static_cast<float>(size.width - 0.5);
  const auto bottom = static_cast<float>(size.height - 0.5);
  const std::vector<cv::Point2f> frame = {
      {-0.5F, -0.5F}, {right, -0.5F}, {right, bottom}, {-0.5F, bottom}};
  std::vector<cv::Point2f> both;
  return cv::intersectConvexConvex(outline, frame, both) / static_cast<double>(size.area());
}

}  // namespace

ShownView view_of(const cv::Matx33d& H_original_output, cv::Size size) {
  const cv::Point2d middle((size.width - 1) / 2.0, (size.height - 1) / 2.0);
  const auto derivative = [&](const cv::Point2d& step) {
    return project(H_original_output, middle + step) - project(H_original_output, middle - step);
  };
  const cv::Point2d by_x = derivative({0.5, 0});
  const cv::Point2d by_y = derivative({0, 0.5});
  cv::Vec2d scales;
  cv::SVD::compute(cv::Matx22d(by_x.x, by_y.x, by_x.y, by_y.y), scales, cv::SVD::NO_UV);
  return {H_original_output, 1 / std::sqrt(scales[0] * scales[1]),
          retained_share(H_original_output, size), 1 - scales[1] / scales[0]};
}

std::optional<ShownView> compare_views(const cv::Mat& original, const TrackedPicture& output) {
  const Place place = find_coarsely(original, output.luma);
  if (place.correlation < kLeastCorrelation) return std::nullopt;
  const auto first = refined(original, output, similarity_at(place, original.size()));
  if (!first) return std::nullopt;
  const auto H = refined(original, output, *first);
  if (!H) return std::nullopt;
  return view_of(*H, original.size());
}

}  // namespace gimbal::judge
