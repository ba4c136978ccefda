#include "pipeline/intrinsics/board_detector.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/intrinsics/intrinsics.hpp"
#include "tests/support/rendered_board.hpp"

namespace gimbal {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr ImageSize kSize = {640, 480};

CalibrationBoard checkerboard() {
  return {BoardKind::checkerboard, 9, 6, 0, ""};
}

[[maybe_unused]] CalibrationBoard charuco() {
  return {BoardKind::charuco, 9, 7, 0.7, "DICT_5X5_100"};
}

Lens lens_of(LensModel model, double focal_px, std::vector<double> distortion) {
  LensParameters parameters;
  parameters.model = model;
  parameters.K << focal_px, 0, 325.3, 0, 1.006 * focal_px, 236.8, 0, 0, 1;
  parameters.distortion = std::move(distortion);
  return *Lens::create(parameters);
}

std::vector<BoardView> rendered_views(const CalibrationBoard& board, const Lens& lens,
                                      test::PictureFaults faults, std::uint64_t seed,
                                      int count = 14) {
  const test::BoardRenderer renderer(lens, kSize, test::board_texture(board), faults);
  const auto detector = BoardDetector::create(board);
  std::vector<BoardView> views;
  for (const auto& pose : test::board_poses(board, lens, kSize, count, seed)) {
    auto view = (*detector)->find(renderer.render(pose, ++seed));
    if (!view) continue;
    view->name = "picture " + std::to_string(views.size() + 1);
    views.push_back(*view);
  }
  return views;
}

/// From pictures all the way to the lens, which must be the one that drew them.
void expect_truth(const CalibrationBoard& board, const Lens& lens, test::PictureFaults faults,
                  std::uint64_t seed) {
  const LensParameters& truth = lens.parameters();
  const Intrinsics found =
      calibrate_intrinsics(rendered_views(board, lens, faults, seed), kSize, truth.model);
  ASSERT_THAT(found.reason, IsEmpty());
  const Eigen::Matrix3d off = (found.fit->lens.K - truth.K) / truth.K(0, 0);
  EXPECT_LT(off.cwiseAbs().maxCoeff(), 0.003) << off;
  EXPECT_LT(found.fit->rms_px, 0.12);
}

struct Case {
  LensModel model;
  double focal_px;
  std::vector<double> distortion;
  test::PictureFaults faults;
  std::uint64_t seed;
};

class RenderedBoards : public ::testing::TestWithParam<Case> {
 protected:
  const Case& case_ = GetParam();
  const Lens lens_ = lens_of(case_.model, case_.focal_px, case_.distortion);
};
INSTANTIATE_TEST_SUITE_P(
    Lenses, RenderedBoards,
    ::testing::Values(Case{LensModel::pinhole, 520, {}, {0, 2}, 1},
                      Case{LensModel::brown, 520, {-0.28, 0.09, 8e-4, -5e-4, -0.01}, {0.7, 3}, 20},
                      Case{LensModel::fisheye, 260, {-0.02, 4e-3, -2e-3, 5e-4}, {1, 4}, 30}));

TEST_P(RenderedBoards, CheckerboardTellsTheLens) {
  expect_truth(checkerboard(), lens_, case_.faults, case_.seed);
}

#ifdef GIMBALD_HAS_CHARUCO
TEST_P(RenderedBoards, CharucoTellsTheLens) {
  expect_truth(charuco(), lens_, case_.faults, case_.seed);
}

TEST(BoardDetector, SeesPartOfACharucoBoard) {
  const CalibrationBoard board = charuco();
  const Lens lens = lens_of(LensModel::pinhole, 520, {});
  const test::BoardRenderer renderer(lens, kSize, test::board_texture(board), {});
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() << 1, -2, 10;  // its right end is out of the picture
  const auto view = (*BoardDetector::create(board))->find(renderer.render(pose, 1));
  ASSERT_TRUE(view);
  EXPECT_GT(view->corners.size(), 20U);
  EXPECT_LT(view->corners.size(), static_cast<std::size_t>(board.corner_count()));
}
#endif

VideoFrame gray_picture() {
  Nv12Buffer buffer(kSize);
  for (int y = 0; y < kSize.height; ++y) {
    std::fill_n(buffer.luma().data + y * buffer.luma().stride_bytes, kSize.width, 128);
  }
  return std::move(buffer).publish({}, {});
}

TEST(BoardDetector, SeesNothingWhereThereIsNothing) {
  EXPECT_FALSE((*BoardDetector::create(checkerboard()))->find(gray_picture()));
#ifdef GIMBALD_HAS_CHARUCO
  EXPECT_FALSE((*BoardDetector::create(charuco()))->find(gray_picture()));
#endif
}

// Of two pictures that show the same the sharper one is chosen by this.
TEST(BoardDetector, TellsBlurredFromSharp) {
  const Lens lens = lens_of(LensModel::pinhole, 520, {});
  const auto sharp = rendered_views(checkerboard(), lens, {0.5, 2}, 4, 3);
  const auto blurred = rendered_views(checkerboard(), lens, {2, 2}, 4, 3);
  ASSERT_EQ(sharp.size(), 3U);
  ASSERT_EQ(blurred.size(), 3U);
  for (std::size_t i = 0; i < sharp.size(); ++i) {
    EXPECT_GT(sharp[i].sharpness, 1.5 * blurred[i].sharpness);
  }
}

TEST(Board, IsReadFromText) {
  EXPECT_EQ(parse_board("checkerboard:9x6")->corner_count(), 54);
  EXPECT_EQ(parse_board("charuco:5x7")->corner_count(), 24);
  for (const char* const text : {"", "9x6", "checkerboard", "checkerboard:9", "checkerboard:9x",
                                 "checkerboard:x6", "checkerboard:9x6x", "circles:4x11",
                                 "checkerboard:2x6", "charuco:5x700", "checkerboard:-9x6"}) {
    EXPECT_FALSE(parse_board(text)) << text;
  }
}

#ifdef GIMBALD_HAS_CHARUCO
TEST(Board, OfMarkersThatCannotBeIsRefused) {
  CalibrationBoard board = charuco();
  board.dictionary = "DICT_5X5_10";
  EXPECT_THAT(BoardDetector::create(board).error().message, HasSubstr("DICT_5X5_100"));
  board.dictionary = "DICT_APRILTAG_16h5";
  EXPECT_THAT(BoardDetector::create(board).error().message, HasSubstr("has only 30"));
  board.dictionary = "DICT_4X4_50";
  board.marker_squares = 1;
  EXPECT_THAT(BoardDetector::create(board).error().message, HasSubstr("smaller than its squares"));
}
#endif

}  // namespace
}  // namespace gimbal
