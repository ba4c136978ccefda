#include "tests/support/rendered_board.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "drivers/synthetic/random.hpp"
#include "tests/support/charuco_drawing.hpp"

namespace gimbal::test {
namespace {

constexpr double kWhite = 210;
constexpr double kBlack = 40;
constexpr double kSurroundings = 120;
constexpr double kMargin_squares = 0.5;
constexpr int kSamplesASide = 4;  // of a pixel

/// Squares a side, from one before the first inner corner on.
Eigen::Vector2i squares_of(const CalibrationBoard& board) {
  const int more = board.kind == BoardKind::checkerboard ? 1 : 0;
  return {board.columns + more, board.rows + more};
}

/// The outer corners of the squares.
std::array<Eigen::Vector3d, 4> outline_of(const CalibrationBoard& board) {
  const Eigen::Vector2d end = (squares_of(board) - Eigen::Vector2i::Ones()).cast<double>();
  return {Eigen::Vector3d(-1, -1, 0), Eigen::Vector3d(end.x(), -1, 0),
          Eigen::Vector3d(end.x(), end.y(), 0), Eigen::Vector3d(-1, end.y(), 0)};
}

/// Paper around the squares, and nothing around the paper.
std::optional<double> off_the_squares(const Eigen::Vector2d& place,
                                      const Eigen::Vector2i& squares) {
  const Eigen::Array2d before = -1 - place.array();
  const Eigen::Array2d behind = place.array() + 1 - squares.cast<double>().array();
  const double off = std::max(before.maxCoeff(), behind.maxCoeff());
  if (off < 0) return std::nullopt;
  return off < kMargin_squares ? kWhite : kSurroundings;
}

bool is_inside(const Eigen::Vector2d& pixel, ImageSize size) {
  constexpr double kBorder_px = 6;
  return pixel.x() > kBorder_px && pixel.y() > kBorder_px && pixel.x() < size.width - kBorder_px &&
         pixel.y() < size.height - kBorder_px;
}

bool is_in_picture(const CalibrationBoard& board, const Eigen::Isometry3d& T_camera_board,
                   const Lens& lens, ImageSize size) {
  const auto outline = outline_of(board);
  return std::all_of(outline.begin(), outline.end(), [&](const Eigen::Vector3d& corner) {
    const auto pixel = lens.project(T_camera_board * corner);
    return pixel && is_inside(*pixel, size);
  });
}

Eigen::Isometry3d random_pose(const CalibrationBoard& board, const Lens& lens, ImageSize size,
                              Random& random, const BoardPoses& how) {
  const Eigen::Vector2d middle = 0.5 * Eigen::Vector2d(size.width - 1, size.height - 1);
  const Eigen::Vector2d off(random.uniform(-1, 1), random.uniform(-1, 1));
  const auto ray = lens.unproject(middle + how.reach * middle.cwiseProduct(off));
  if (!ray) throw std::logic_error("the lens does not reach all of the picture");
  const double axis_rad = random.uniform(0, 2 * std::numbers::pi);
  const Eigen::Vector3d axis(std::cos(axis_rad), std::sin(axis_rad), 0);
  const Eigen::Quaterniond facing =
      how.facing == Facing::camera
          ? Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), *ray)
          : Eigen::Quaterniond::Identity();
  const Eigen::Matrix3d R =
      (facing * Eigen::AngleAxisd(how.tilt_rad * std::sqrt(random.uniform()), axis) *
       Eigen::AngleAxisd(random.uniform(-0.4, 0.4), Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  const Eigen::Vector2d squares = squares_of(board).cast<double>();
  const double distance = squares.x() * lens.parameters().K(0, 0) /
                          (how.share * size.width * random.uniform(0.8, 1.25));
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = R;
  T.translation() =
      *ray * distance - R * Eigen::Vector3d(squares.x() / 2 - 1, squares.y() / 2 - 1, 0);
  return T;
}

}  // namespace

BoardTexture board_texture(const CalibrationBoard& board) {
  const Eigen::Vector2i squares = squares_of(board);
  if (board.kind == BoardKind::charuco) {
    return [squares, drawing = draw_charuco(board)](const Eigen::Vector2d& place) {
      if (const auto off = off_the_squares(place, squares)) return *off;
      return drawing.is_white(place + Eigen::Vector2d::Ones()) ? kWhite : kBlack;
    };
  }
  return [squares](const Eigen::Vector2d& place) {
    if (const auto off = off_the_squares(place, squares)) return *off;
    const auto square = place.array().floor().cast<int>().sum();
    return square % 2 == 0 ? kBlack : kWhite;
  };
}

BoardRenderer::BoardRenderer(const Lens& lens, ImageSize size, BoardTexture texture,
                             PictureFaults faults)
    : size_(size), texture_(std::move(texture)), faults_(faults) {
  for (int y = 0; y <= size.height; ++y) {
    for (int x = 0; x <= size.width; ++x) {
      const auto ray = lens.unproject({x - 0.5, y - 0.5});
      if (!ray) throw std::logic_error("the lens does not reach all of the picture");
      rays_.push_back(*ray);
    }
  }
}

double BoardRenderer::brightness(const Eigen::Isometry3d& T_board_camera, int x, int y) const {
  const auto corner = [&](int right, int below) -> const Eigen::Vector3d& {
    return rays_[static_cast<std::size_t>((y + below) * (size_.width + 1) + x + right)];
  };
  double sum = 0;
  for (int i = 0; i < kSamplesASide * kSamplesASide; ++i) {
    const double u = (i % kSamplesASide + 0.5) / kSamplesASide;
    const double v = (i / kSamplesASide + 0.5) / kSamplesASide;
    const Eigen::Vector3d ray = (1 - v) * ((1 - u) * corner(0, 0) + u * corner(1, 0)) +
                                v * ((1 - u) * corner(0, 1) + u * corner(1, 1));
    const Eigen::Vector3d along = T_board_camera.linear() * ray;
    const Eigen::Vector3d& from = T_board_camera.translation();
    const double distance = -from.z() / along.z();
    sum += distance > 0 ? texture_((from + distance * along).head<2>()) : kSurroundings;
  }
  return sum / (kSamplesASide * kSamplesASide);
}

VideoFrame BoardRenderer::render(const Eigen::Isometry3d& T_camera_board,
                                 std::uint64_t seed) const {
  const Eigen::Isometry3d T_board_camera = T_camera_board.inverse();
  cv::Mat picture(size_.height, size_.width, CV_64F);
  for (int y = 0; y < size_.height; ++y) {
    for (int x = 0; x < size_.width; ++x) {
      picture.at<double>(y, x) = brightness(T_board_camera, x, y);
    }
  }
  if (faults_.blur_px > 0) cv::GaussianBlur(picture, picture, {0, 0}, faults_.blur_px);
  Random random(seed);
  Nv12Buffer buffer(size_);
  for (int y = 0; y < size_.height; ++y) {
    for (int x = 0; x < size_.width; ++x) {
      const double value = picture.at<double>(y, x) + faults_.noise * random.normal();
      buffer.luma().data[y * buffer.luma().stride_bytes + x] =
          static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
    }
  }
  const ImageSize chroma = chroma_size(size_);
  for (int y = 0; y < chroma.height; ++y) {
    std::fill_n(buffer.chroma().data + y * buffer.chroma().stride_bytes, 2 * chroma.width, 128);
  }
  return std::move(buffer).publish({}, {});
}

std::vector<Eigen::Isometry3d> board_poses(const CalibrationBoard& board, const Lens& lens,
                                           ImageSize size, int count, std::uint64_t seed,
                                           const BoardPoses& how) {
  Random random(seed);
  std::vector<Eigen::Isometry3d> poses;
  while (poses.size() < static_cast<std::size_t>(count)) {
    const Eigen::Isometry3d pose = random_pose(board, lens, size, random, how);
    if (is_in_picture(board, pose, lens, size)) poses.push_back(pose);
  }
  return poses;
}

std::vector<BoardView> noisy_views(const CalibrationBoard& board, const Lens& lens,
                                   const std::vector<Eigen::Isometry3d>& poses, double noise_px,
                                   std::uint64_t seed) {
  Random random(seed);
  const Eigen::Vector2i corners = squares_of(board) - Eigen::Vector2i::Ones();
  std::vector<BoardView> views;
  for (const Eigen::Isometry3d& pose : poses) {
    views.emplace_back();
    views.back().name = "picture " + std::to_string(views.size());
    for (int i = 0; i < corners.prod(); ++i) {
      const Eigen::Vector2d corner(i % corners.x(), i / corners.x());
      const auto pixel = lens.project(pose * Eigen::Vector3d(corner.x(), corner.y(), 0));
      views.back().corners.push_back(corner);
      views.back().seen_px.push_back(*pixel +
                                     noise_px * Eigen::Vector2d(random.normal(), random.normal()));
    }
  }
  return views;
}

}  // namespace gimbal::test
