#include "pipeline/intrinsics/intrinsics.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "pipeline/lens/lens.hpp"

namespace gimbal {
namespace {

constexpr std::size_t kFewestViews = 8;
constexpr std::size_t kFewestTilted = 3;
constexpr double kLeastTilt_rad = 15 * std::numbers::pi / 180;
constexpr double kLeastCoverage = 0.6;
constexpr double kMostTimesMedian = 3;
constexpr double kMostLeftOut = 1.0 / 3;   // of the views
constexpr double kMostError = 1e-3;        // of the picture's width
constexpr double kMostTwiceSigma = 0.005;  // of the focal length

double rms(const std::vector<Eigen::Vector2d>& residuals_px) {
  double squares = 0;
  for (const Eigen::Vector2d& residual_px : residuals_px) squares += residual_px.squaredNorm();
  return std::sqrt(squares / static_cast<double>(residuals_px.size()));
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<ViewError> errors_of(const std::vector<BoardView>& views, const LensFit& fit) {
  std::vector<ViewError> errors;
  for (std::size_t i = 0; i < views.size(); ++i) {
    errors.push_back({views[i].name, views[i].corners.size(), rms(fit.residuals_px[i])});
  }
  return errors;
}

/// The view that fits worst, if it is far worse than most.
std::optional<std::size_t> outlier(const std::vector<ViewError>& errors) {
  std::vector<double> all;
  all.reserve(errors.size());
  for (const ViewError& error : errors) all.push_back(error.rms_px);
  const auto worst = std::max_element(all.begin(), all.end());
  if (*worst <= kMostTimesMedian * median(all)) return std::nullopt;
  return static_cast<std::size_t>(worst - all.begin());
}

/// Fits, and again without the worst view as long as one contradicts the others.
void fit_those_that_agree(Intrinsics& found, ImageSize size, LensModel model) {
  const auto most =
      static_cast<std::size_t>(kMostLeftOut * static_cast<double>(found.views.size()));
  while (true) {
    found.fit = fit_lens(found.views, size, model);
    if (!found.fit) return;
    found.errors = errors_of(found.views, *found.fit);
    const auto worst = outlier(found.errors);
    if (!worst || found.left_out.size() >= most) return;
    found.left_out.push_back(found.errors[*worst]);
    found.views.erase(found.views.begin() + static_cast<std::ptrdiff_t>(*worst));
  }
}

std::size_t tilted_views(const LensFit& fit) {
  const auto is_tilted = [](const Eigen::Isometry3d& pose) {
    return std::abs(pose.linear()(2, 2)) < std::cos(kLeastTilt_rad);
  };
  return static_cast<std::size_t>(
      std::count_if(fit.T_camera_board.begin(), fit.T_camera_board.end(), is_tilted));
}

/// Square pixels and an axis near the middle, as real cameras have them.
bool is_plausible(const Eigen::Matrix3d& K, ImageSize size) {
  const double aspect = K(0, 0) / K(1, 1);
  return K(0, 0) > 0 && K(1, 1) > 0 && aspect > 0.8 && aspect < 1.25 &&
         K(0, 2) > 0.25 * size.width && K(0, 2) < 0.75 * size.width &&
         K(1, 2) > 0.25 * size.height && K(1, 2) < 0.75 * size.height;
}

/// Whether every pixel has a ray: beyond the corners that were seen distortion may fold back.
bool reaches_all(const LensParameters& parameters, ImageSize size) {
  const auto lens = Lens::create(parameters);
  if (!lens) return false;
  const double right = size.width - 1;
  const double bottom = size.height - 1;
  return lens->unproject({0, 0}) && lens->unproject({right, 0}) && lens->unproject({0, bottom}) &&
         lens->unproject({right, bottom});
}

/// By how much the focal length is another, as a share, once the lens may distort; 0 where that is
/// within what is not known. A little distortion hides in the focal length and leaves hardly
/// anything to see.
double change_by_distortion(const Intrinsics& found, ImageSize size) {
  const auto other = fit_lens(found.views, size, LensModel::brown);
  if (!other) return 0;
  const double focal_px = found.fit->lens.K(0, 0);
  const double change_px = std::abs(other->lens.K(0, 0) - focal_px);
  return change_px > 3 * other->sigmas[0] ? change_px / focal_px : 0;
}

/// Of the focal lengths and the principal point, in focal lengths: the least certain.
double twice_sigma(const LensFit& fit) {
  const double worst = *std::max_element(fit.sigmas.begin(), fit.sigmas.begin() + 4);
  return 2 * worst / std::min(fit.lens.K(0, 0), fit.lens.K(1, 1));
}

/// What the views lack, whatever came of them.
std::string lack(const Intrinsics& found, LensModel model) {
  if (found.views.size() < kFewestViews) {
    return fmt::format("only {} pictures show the board; {} are needed, better 20",
                       found.views.size(), kFewestViews);
  }
  if (model != LensModel::pinhole && found.coverage.share() < kLeastCoverage) {
    return fmt::format("the corners cover only {:.0f} % of the picture; show {}",
                       100 * found.coverage.share(), fmt::join(found.coverage.missing(), ", "));
  }
  return "";
}

std::string doubt(const Intrinsics& found, ImageSize size) {
  const LensFit& fit = *found.fit;
  if (tilted_views(fit) < kFewestTilted) {
    return "the board faces the camera in all pictures, which leaves the focal length open; tilt "
           "it by "
           "some 30 degrees, each side nearer in turn";
  }
  if (outlier(found.errors) || fit.rms_px > kMostError * size.width) {
    return fmt::format(
        "the corners are {:.2f} px from where the lens has them: the board is not flat or not this "
        "one, or the lens is of another model",
        fit.rms_px);
  }
  if (!is_plausible(fit.lens.K, size)) {
    return "no real camera has such a focal length and principal point; show more of the picture "
           "and "
           "more tilts";
  }
  if (!reaches_all(fit.lens, size)) {
    return "the lens that was fitted folds back within the picture, where no corner was seen; show "
           "the "
           "board there, or take another model of lens";
  }
  if (!(twice_sigma(fit) <= kMostTwiceSigma)) {
    return fmt::format(
        "focal length and principal point are known to {:.1f} % only; take more pictures, with "
        "more "
        "tilts",
        100 * twice_sigma(fit));
  }
  if (fit.lens.model != LensModel::pinhole) return "";
  const double change = change_by_distortion(found, size);
  if (change <= kMostTwiceSigma) return "";
  return fmt::format(
      "the lens distorts: with that fitted too, the focal length is another by {:.1f} %; "
      "take the model brown or fisheye",
      100 * change);
}

}  // namespace

Intrinsics calibrate_intrinsics(std::vector<BoardView> views, ImageSize size, LensModel model) {
  Intrinsics found;
  found.views = std::move(views);
  if (found.views.size() >= kFewestViews) fit_those_that_agree(found, size, model);
  found.coverage = coverage_of(found.views, size);
  found.reason = lack(found, model);
  if (!found.reason.empty()) return found;
  found.reason = found.fit ? doubt(found, size) : "no lens explains where the corners are";
  return found;
}

}  // namespace gimbal
