#include "pipeline/fill/cell_extension.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace gimbal {
namespace {

const CellGrid kGrid({200, 120});  // 25 x 15 cells, no powers of two

std::vector<CellValues> known_left_of(int column, const auto& value_of) {
  std::vector<CellValues> cells(kGrid.cells());
  kGrid.for_each_cell([&](CellPlace place) {
    if (place.column >= column) return;
    cells[kGrid.index(place)] = {Eigen::Array4f::Constant(value_of(place)), 1};
  });
  return cells;
}

TEST(CellExtension, CarriesAConstantEverywhere) {
  auto cells = known_left_of(3, [](CellPlace) { return 77.0F; });
  extend(kGrid, cells);
  for (const CellValues& cell : cells) EXPECT_NEAR(cell.values[2], 77, 1e-3);
}

TEST(CellExtension, LeavesWhatIsKnownAndStaysBetweenItsExtremes) {
  const auto value_of = [](CellPlace place) {
    return static_cast<float>(10 * (place.row % 5) + place.column);
  };
  auto cells = known_left_of(12, value_of);
  extend(kGrid, cells);
  kGrid.for_each_cell([&](CellPlace place) {
    const float value = cells[kGrid.index(place)].values[0];
    if (place.column < 12) {
      EXPECT_EQ(value, value_of(place));
    }
    EXPECT_GE(value, 0);
    EXPECT_LE(value, 51);
  });
}

TEST(CellExtension, IsSmootherFartherAway) {
  auto cells = known_left_of(5, [](CellPlace place) { return place.row % 2 == 0 ? 0.0F : 100.0F; });
  extend(kGrid, cells);
  const auto step_at = [&](int column) {
    return std::abs(cells[kGrid.index({column, 7})].values[0] -
                    cells[kGrid.index({column, 8})].values[0]);
  };
  EXPECT_GT(step_at(4), 99);
  EXPECT_LT(step_at(12), 20);
}

TEST(CellExtension, OfNothingIsNothing) {
  std::vector<CellValues> cells(kGrid.cells());
  extend(kGrid, cells);
  for (const CellValues& cell : cells) EXPECT_TRUE((cell.values == 0).all());
}

}  // namespace
}  // namespace gimbal
