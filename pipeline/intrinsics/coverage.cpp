#include "pipeline/intrinsics/coverage.hpp"

#include <algorithm>
#include <cstddef>
#include <string_view>

#include "pipeline/intrinsics/view_choice.hpp"

namespace gimbal {
namespace {

constexpr double kLeastTilt = 0.3;
constexpr double kLeastOfRegion = 0.5;

std::size_t index_of(int column, int row) {
  return static_cast<std::size_t>(row) * Coverage::kSide + static_cast<std::size_t>(column);
}

std::size_t part_of(const Eigen::Vector2d& seen_px, ImageSize size) {
  const auto place = [](double at, int length) {
    const auto part = static_cast<int>((at + 0.5) * Coverage::kSide / length);
    return std::clamp(part, 0, Coverage::kSide - 1);
  };
  return index_of(place(seen_px.x(), size.width), place(seen_px.y(), size.height));
}

/// Parts of the picture that have a name, of two rows and columns each but for the middle ones.
struct Region {
  std::string_view name;
  int left;
  int top;
  int right;   ///< one past the last
  int bottom;  ///< one past the last
};

constexpr std::array<Region, 9> kRegions = {{{"top left", 0, 0, 2, 2},
                                             {"top", 2, 0, 3, 2},
                                             {"top right", 3, 0, 5, 2},
                                             {"left", 0, 2, 2, 3},
                                             {"middle", 2, 2, 3, 3},
                                             {"right", 3, 2, 5, 3},
                                             {"bottom left", 0, 3, 2, 5},
                                             {"bottom", 2, 3, 3, 5},
                                             {"bottom right", 3, 3, 5, 5}}};

bool is_seen(const Coverage& coverage, const Region& region) {
  int seen = 0;
  for (int y = region.top; y < region.bottom; ++y) {
    for (int x = region.left; x < region.right; ++x) {
      seen += coverage.corners.at(index_of(x, y)) > 0 ? 1 : 0;
    }
  }
  return seen > kLeastOfRegion * (region.right - region.left) * (region.bottom - region.top);
}

}  // namespace

double Coverage::share() const {
  const auto seen = std::count_if(corners.begin(), corners.end(), [](int n) { return n > 0; });
  return static_cast<double>(seen) / static_cast<double>(corners.size());
}

std::vector<std::string> Coverage::missing() const {
  std::vector<std::string> words;
  for (const Region& region : kRegions) {
    if (!is_seen(*this, region)) words.push_back("the picture's " + std::string(region.name));
  }
  const auto want = [&](int views, std::string_view side) {
    if (views == 0) words.push_back("the board's " + std::string(side) + " tilted nearer");
  };
  want(nearer_left, "left side");
  want(nearer_right, "right side");
  want(nearer_top, "top");
  want(nearer_bottom, "bottom");
  return words;
}

Coverage coverage_of(std::span<const BoardView> views, ImageSize size) {
  Coverage coverage;
  for (const BoardView& view : views) {
    for (const Eigen::Vector2d& seen_px : view.seen_px) {
      ++coverage.corners.at(part_of(seen_px, size));
    }
    const ViewShape shape = shape_of(view, size);
    coverage.nearer_left += shape.tilt.x() < -kLeastTilt ? 1 : 0;
    coverage.nearer_right += shape.tilt.x() > kLeastTilt ? 1 : 0;
    coverage.nearer_top += shape.tilt.y() < -kLeastTilt ? 1 : 0;
    coverage.nearer_bottom += shape.tilt.y() > kLeastTilt ? 1 : 0;
  }
  return coverage;
}

}  // namespace gimbal
