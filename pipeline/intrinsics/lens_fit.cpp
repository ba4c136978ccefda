#include "pipeline/intrinsics/lens_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <utility>

namespace gimbal {
namespace {

constexpr Eigen::Index kOfPose = 6;

/// The same problem as OpenCV has it.
struct CvProblem {
  std::vector<std::vector<cv::Point3d>> corners;
  std::vector<std::vector<cv::Point2d>> seen;
  cv::Size size;
  LensModel model;
};

struct CvSolution {
  cv::Mat K;
  cv::Mat distortion;
  std::vector<cv::Mat> rotations;
  std::vector<cv::Mat> translations;
  double rms_px = 0;
};

CvProblem problem_of(std::span<const BoardView> views, ImageSize size, LensModel model) {
  CvProblem problem{{}, {}, {size.width, size.height}, model};
  for (const BoardView& view : views) {
    problem.corners.emplace_back();
    problem.seen.emplace_back();
    for (const Eigen::Vector2d& at : view.corners) {
      problem.corners.back().emplace_back(at.x(), at.y(), 0);
    }
    for (const Eigen::Vector2d& at : view.seen_px) {
      problem.seen.back().emplace_back(at.x(), at.y());
    }
  }
  return problem;
}

/// calibrateCamera takes single precision alone.
template <typename Point, typename Wide>
std::vector<std::vector<Point>> narrowed(const std::vector<std::vector<Wide>>& wide) {
  std::vector<std::vector<Point>> narrow;
  narrow.reserve(wide.size());
  for (const auto& points : wide) narrow.emplace_back(points.begin(), points.end());
  return narrow;
}

CvSolution solve_perspective(const CvProblem& problem) {
  constexpr int kNoDistortion =
      cv::CALIB_ZERO_TANGENT_DIST | cv::CALIB_FIX_K1 | cv::CALIB_FIX_K2 | cv::CALIB_FIX_K3;
  const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 100, 1e-10);
  CvSolution found;
  found.rms_px = cv::calibrateCamera(
      narrowed<cv::Point3f>(problem.corners), narrowed<cv::Point2f>(problem.seen), problem.size,
      found.K, found.distortion, found.rotations, found.translations,
      problem.model == LensModel::pinhole ? kNoDistortion : 0, until);
  return found;
}

CvSolution solve_fisheye(const CvProblem& problem, double focal_px) {
  constexpr int kFlags = cv::fisheye::CALIB_RECOMPUTE_EXTRINSIC | cv::fisheye::CALIB_FIX_SKEW |
                         cv::fisheye::CALIB_USE_INTRINSIC_GUESS;
  const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 100, 1e-10);
  CvSolution found;
  found.K = (cv::Mat_<double>(3, 3) << focal_px, 0, 0.5 * (problem.size.width - 1), 0, focal_px,
             0.5 * (problem.size.height - 1), 0, 0, 1);
  found.distortion = cv::Mat::zeros(4, 1, CV_64F);
  found.rms_px =
      cv::fisheye::calibrate(problem.corners, problem.seen, problem.size, found.K, found.distortion,
                             found.rotations, found.translations, kFlags, until);
  return found;
}

/// From another start where one leads astray or nowhere.
std::optional<CvSolution> solve_fisheye(const CvProblem& problem) {
  constexpr std::array<double, 3> kFocalsOfWidth = {0.45, 0.3, 0.8};
  constexpr double kGoodOfWidth = 1e-3;
  std::optional<CvSolution> best;
  for (const double share : kFocalsOfWidth) {
    try {
      CvSolution found = solve_fisheye(problem, share * problem.size.width);
      if (std::isfinite(found.rms_px) && (!best || found.rms_px < best->rms_px)) {
        best = std::move(found);
      }
    } catch (const cv::Exception&) {  // this start led nowhere
    }
    if (best && best->rms_px < kGoodOfWidth * problem.size.width) break;
  }
  return best;
}

std::optional<CvSolution> solve(const CvProblem& problem) {
  if (problem.model == LensModel::fisheye) return solve_fisheye(problem);
  try {
    return solve_perspective(problem);
  } catch (const cv::Exception&) {  // of views that no lens could have
    return std::nullopt;
  }
}

/// Coefficients that the model has of those that OpenCV returns.
std::size_t coefficients(LensModel model) {
  if (model == LensModel::pinhole) return 0;
  return model == LensModel::brown ? 5 : 4;
}

/// A view's corners where the solution has them, and how they move: a column for each of fx, fy,
/// cx, cy and the distortion (J_lens), and of the pose (J_pose).
struct Linearized {
  Eigen::VectorXd residual;
  Eigen::MatrixXd J_lens;
  Eigen::MatrixXd J_pose;
};

/// OpenCV's columns: rotation, translation, f, c, distortion; for a fisheye lens f, c, distortion,
/// rotation, translation.
Linearized linearize(const CvProblem& problem, const CvSolution& at, std::size_t view) {
  const bool is_fisheye = problem.model == LensModel::fisheye;
  std::vector<cv::Point2d> modelled;
  cv::Mat all;
  if (is_fisheye) {
    cv::fisheye::projectPoints(problem.corners[view], modelled, at.rotations[view],
                               at.translations[view], at.K, at.distortion, 0, all);
  } else {
    cv::projectPoints(problem.corners[view], at.rotations[view], at.translations[view], at.K,
                      at.distortion, modelled, all);
  }
  const auto lens_columns = static_cast<Eigen::Index>(4 + coefficients(problem.model));
  const Eigen::Index first_of_lens = is_fisheye ? 0 : kOfPose;
  const Eigen::Index first_of_pose = is_fisheye ? lens_columns : 0;
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> J(
      all.ptr<double>(), all.rows, all.cols);
  Linearized linear{Eigen::VectorXd(all.rows), J.middleCols(first_of_lens, lens_columns),
                    J.middleCols(first_of_pose, kOfPose)};
  for (std::size_t i = 0; i < modelled.size(); ++i) {
    const cv::Point2d residual = problem.seen[view][i] - modelled[i];
    linear.residual.segment<2>(static_cast<Eigen::Index>(2 * i)) << residual.x, residual.y;
  }
  return linear;
}

/// What the views know of the lens once each one's pose is left free: Schur's complement.
Eigen::MatrixXd information_of(const Linearized& linear) {
  const Eigen::MatrixXd mixed = linear.J_pose.transpose() * linear.J_lens;
  const Eigen::MatrixXd pose = linear.J_pose.transpose() * linear.J_pose;
  return linear.J_lens.transpose() * linear.J_lens - mixed.transpose() * pose.ldlt().solve(mixed);
}

std::vector<Eigen::Vector2d> in_pairs(const Eigen::VectorXd& residual) {
  std::vector<Eigen::Vector2d> pairs;
  for (Eigen::Index i = 0; i + 1 < residual.size(); i += 2)
    pairs.emplace_back(residual.segment<2>(i));
  return pairs;
}

/// Infinite where the views leave something open.
std::vector<double> sigmas_of(const Eigen::MatrixXd& information, double noise_px) {
  const Eigen::LDLT<Eigen::MatrixXd> solver(information);
  const Eigen::MatrixXd covariance =
      solver.solve(Eigen::MatrixXd::Identity(information.rows(), information.cols()));
  std::vector<double> sigmas;
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    const double variance = covariance(i, i);
    const bool is_known = solver.isPositive() && std::isfinite(variance) && variance > 0;
    sigmas.push_back(is_known ? noise_px * std::sqrt(variance)
                              : std::numeric_limits<double>::infinity());
  }
  return sigmas;
}

Eigen::Isometry3d pose_of(const cv::Mat& rotation, const cv::Mat& translation) {
  const Eigen::Map<const Eigen::Vector3d> turn(rotation.ptr<double>());
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  if (turn.norm() > 0) {
    pose.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  }
  pose.translation() = Eigen::Map<const Eigen::Vector3d>(translation.ptr<double>());
  return pose;
}

LensParameters lens_of(const CvSolution& found, LensModel model) {
  LensParameters lens;
  lens.model = model;
  for (int i = 0; i < 9; ++i) lens.K(i / 3, i % 3) = found.K.at<double>(i / 3, i % 3);
  for (std::size_t i = 0; i < coefficients(model); ++i) {
    lens.distortion.push_back(found.distortion.ptr<double>()[i]);
  }
  return lens;
}

LensFit judged(const CvProblem& problem, const CvSolution& found) {
  LensFit fit;
  fit.lens = lens_of(found, problem.model);
  const auto of_lens = static_cast<Eigen::Index>(4 + coefficients(problem.model));
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(of_lens, of_lens);
  double squares = 0;
  Eigen::Index values = 0;
  for (std::size_t view = 0; view < problem.seen.size(); ++view) {
    const Linearized linear = linearize(problem, found, view);
    information += information_of(linear);
    squares += linear.residual.squaredNorm();
    values += linear.residual.size();
    fit.residuals_px.push_back(in_pairs(linear.residual));
    fit.T_camera_board.push_back(pose_of(found.rotations[view], found.translations[view]));
  }
  const auto views = static_cast<Eigen::Index>(problem.seen.size());
  const Eigen::Index freedom = values - of_lens - kOfPose * views;
  fit.rms_px = std::sqrt(2 * squares / static_cast<double>(values));
  fit.sigmas = sigmas_of(
      information, std::sqrt(squares / static_cast<double>(std::max<Eigen::Index>(freedom, 1))));
  return fit;
}

}  // namespace

std::optional<LensFit> fit_lens(std::span<const BoardView> views, ImageSize size, LensModel model) {
  const CvProblem problem = problem_of(views, size, model);
  const auto found = solve(problem);
  if (!found || !std::isfinite(found->rms_px)) return std::nullopt;
  return judged(problem, *found);
}

}  // namespace gimbal
