#include "pipeline/intrinsics/view_choice.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <utility>

namespace gimbal {
namespace {

constexpr std::size_t kMostViews = 40;
constexpr double kSpacing = 0.12;

double distance(const ViewShape& a, const ViewShape& b) {
  return std::sqrt((a.middle - b.middle).squaredNorm() + (a.tilt - b.tilt).squaredNorm() +
                   (a.size - b.size) * (a.size - b.size));
}

/// From the picture to the board.
Eigen::Matrix3d homography(const BoardView& view) {
  std::vector<cv::Point2d> from;
  std::vector<cv::Point2d> to;
  for (const Eigen::Vector2d& seen : view.seen_px) from.emplace_back(seen.x(), seen.y());
  for (const Eigen::Vector2d& corner : view.corners) to.emplace_back(corner.x(), corner.y());
  const cv::Mat found = cv::findHomography(from, to);
  Eigen::Matrix3d H = Eigen::Matrix3d::Identity();
  for (int i = 0; i < 9 && !found.empty(); ++i) H(i / 3, i % 3) = found.at<double>(i / 3, i % 3);
  return H;
}

}  // namespace

ViewShape shape_of(const BoardView& view, ImageSize size) {
  Eigen::AlignedBox2d box;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& seen : view.seen_px) {
    box.extend(seen);
    middle += seen / static_cast<double>(view.seen_px.size());
  }
  const Eigen::Vector2d picture(size.width, size.height);
  const Eigen::Matrix3d H = homography(view);
  // Squares grow as the third coordinate of the homography does, to the power of 3/2 a side.
  const double depth = H.row(2).dot(middle.homogeneous());
  const Eigen::Vector2d growth = 3 * H.block<1, 2>(2, 0).transpose() / depth;
  return {middle.cwiseQuotient(picture), std::sqrt(box.volume() / picture.prod()),
          std::sqrt(box.volume()) * growth};
}

ViewChoice::ViewChoice(ImageSize size, Pictures pictures)
    : size_(size), spacing_(pictures == Pictures::running ? kSpacing : 0) {}

bool ViewChoice::offer(BoardView view) {
  const ViewShape shape = shape_of(view, size_);
  for (std::size_t i = 0; i < views_.size(); ++i) {
    if (distance(shape, shapes_[i]) >= spacing_) continue;
    if (view.sharpness <= views_[i].sharpness) return false;
    views_[i] = std::move(view);
    shapes_[i] = shape;
    return true;
  }
  views_.push_back(std::move(view));
  shapes_.push_back(shape);
  if (views_.size() <= kMostViews) return true;
  const std::size_t gone = least_useful();
  const bool is_kept = gone + 1 != views_.size();
  views_.erase(views_.begin() + static_cast<std::ptrdiff_t>(gone));
  shapes_.erase(shapes_.begin() + static_cast<std::ptrdiff_t>(gone));
  return is_kept;
}

/// Of the two that are most alike the less sharp one.
std::size_t ViewChoice::least_useful() const {
  double least = std::numeric_limits<double>::infinity();
  std::pair<std::size_t, std::size_t> alike;
  for (std::size_t i = 0; i < views_.size(); ++i) {
    for (std::size_t j = i + 1; j < views_.size(); ++j) {
      if (distance(shapes_[i], shapes_[j]) >= least) continue;
      least = distance(shapes_[i], shapes_[j]);
      alike = {i, j};
    }
  }
  const bool is_first = views_[alike.first].sharpness < views_[alike.second].sharpness;
  return is_first ? alike.first : alike.second;
}

}  // namespace gimbal
