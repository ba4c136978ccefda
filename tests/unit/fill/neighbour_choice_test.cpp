#include "pipeline/fill/neighbour_choice.hpp"

#include <gtest/gtest.h>

namespace gimbal {
namespace {

constexpr ImageSize kSize{640, 360};

/// The whole picture, moved.
PicturePolygon moved(double right_px, double down_px) {
  const double x = right_px - 0.5;
  const double y = down_px - 0.5;
  return {{x, y}, {x + kSize.width, y}, {x + kSize.width, y + kSize.height}, {x, y + kSize.height}};
}

using Indices = std::vector<std::size_t>;

TEST(NeighbourChoice, TakesNothingWhereNothingIsMissing) {
  EXPECT_EQ(choose_neighbours(kSize, moved(0, 0), {{moved(50, 0), 0.1}}, 8), Indices{});
}

TEST(NeighbourChoice, TakesWhatShowsTheGapAndLeavesTheRest) {
  // The left is missing: 0 shows nothing of it, 1 a strip, 2 all of it, 3 too, but later.
  const std::vector<NeighbourCandidate> candidates = {
      {moved(60, 0), 0.03}, {moved(40, 0), 0.07}, {moved(0, 0), 0.2}, {moved(-10, 0), 0.5}};
  const Indices chosen = choose_neighbours(kSize, moved(60, 0), candidates, 8);
  ASSERT_FALSE(chosen.empty());
  EXPECT_EQ(std::count(chosen.begin(), chosen.end(), 0U), 0);
  EXPECT_EQ(std::count(chosen.begin(), chosen.end(), 2U), 1);
}

TEST(NeighbourChoice, NearestInTimeComesFirst) {
  const std::vector<NeighbourCandidate> candidates = {
      {moved(-60, 0), 0.4}, {moved(20, 0), 0.1}, {moved(0, 60), 0.2}};
  EXPECT_EQ(choose_neighbours(kSize, moved(60, -60), candidates, 8), (Indices{1, 2, 0}));
}

TEST(NeighbourChoice, FewCoverTheWholeGap) {
  std::vector<NeighbourCandidate> candidates;
  for (int i = 1; i <= 30; ++i) candidates.push_back({moved(60 - 2 * i, 0), i / 30.0});
  const Indices chosen = choose_neighbours(kSize, moved(60, 0), candidates, 3);
  EXPECT_LE(chosen.size(), 3U);
  // The thirtieth alone shows all.
  EXPECT_EQ(std::count(chosen.begin(), chosen.end(), 29U), 1);
}

TEST(NeighbourChoice, LeavesOutWhatIsNotSeen) {
  EXPECT_EQ(choose_neighbours(kSize, moved(60, 0), {{{}, 0.1}}, 8), Indices{});
}

}  // namespace
}  // namespace gimbal
