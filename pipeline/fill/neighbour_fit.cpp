#include "pipeline/fill/neighbour_fit.hpp"

#include <cmath>

#include "pipeline/fill/cell_extension.hpp"
#include "pipeline/sample/smooth_step.hpp"

namespace gimbal {
namespace {

// What the same thing may differ by in two pictures: its noise, and what a pixel's shift makes.
constexpr float kUsualNoise = 5;
constexpr float kUsualShift_px = 1.6F;

// Of what it may differ by: what is still trusted wholly, and what is not trusted at all.
constexpr float kTrusted = 0.6F;
constexpr float kDistrusted = 1.2F;
constexpr float kMostDisagreement = 4;

/// What differs by more is another thing, not another light.
constexpr float kMostUnevenness = 12;

/// How much the two pictures of a cell differ, and may differ if both show the same.
struct Disagreement {
  float off = 0;
  float allowed = 0;
};

/// A cell that both pictures show.
struct SharedCell {
  CellPlace place;
  CellPair looks;
  float weight = 0;  ///< of what lies past the edge, for that
  Disagreement disagreement = {};
  float trust = 0;
};

/// All of them, to be found by place, too.
class SharedCells {
 public:
  explicit SharedCells(const CellGrid& grid) : grid_(grid), indices_(grid.cells(), kNone) {}

  void add(const SharedCell& cell) {
    indices_[grid_.index(cell.place)] = static_cast<int>(cells_.size());
    cells_.push_back(cell);
  }

  [[nodiscard]] std::vector<SharedCell>& all() { return cells_; }

  /// Calls visit(cell) for it and those around it.
  template <typename Visit>
  void for_each_around(CellPlace place, Visit&& visit) const {
    for (int row = place.row - 1; row <= place.row + 1; ++row) {
      for (int column = place.column - 1; column <= place.column + 1; ++column) {
        const bool exists =
            column >= 0 && column < grid_.columns() && row >= 0 && row < grid_.rows();
        if (!exists) continue;
        const int index = indices_[grid_.index({column, row})];
        if (index != kNone) visit(cells_[static_cast<std::size_t>(index)]);
      }
    }
  }

 private:
  static constexpr int kNone = -1;
  const CellGrid& grid_;
  std::vector<SharedCell> cells_;
  std::vector<int> indices_;
};

SharedCells find_shared(const CellGrid& grid, const ShownPart& there, const ShownPart& neighbour,
                        float reach_px) {
  SharedCells shared(grid);
  grid.for_each_cell([&](CellPlace place) {
    const float depth_px = least_corner(grid, there.depth_px, place);
    const bool is_shared = is_whole(grid, place) && depth_px >= 1 && depth_px < reach_px &&
                           least_corner(grid, neighbour.depth_px, place) >= 1;
    if (!is_shared) return;
    SharedCell cell{place,
                    {look_at(there.planes, grid, place), look_at(neighbour.planes, grid, place)}};
    const float nearness = 1 - depth_px / reach_px;
    cell.weight = nearness * nearness;
    shared.add(cell);
  });
  return shared;
}

std::vector<CellPair> looks_of(SharedCells& shared) {
  std::vector<CellPair> looks;
  for (const SharedCell& cell : shared.all()) looks.push_back(cell.looks);
  return looks;
}

Disagreement disagreement_of(const CellPair& looks, const Tone& tone) {
  const float gradient =
      std::max(looks.wanted.luma_gradient().norm(), tone.gain * looks.given.luma_gradient().norm());
  Disagreement cell;
  cell.allowed = kUsualNoise + kUsualShift_px * gradient;
  for (std::size_t i = 0; i < 4; ++i) {
    cell.off += std::abs(looks.wanted.luma[i] - tone.luma(looks.given.luma[i])) / 4;
  }
  cell.off = std::min(cell.off, kMostDisagreement * cell.allowed);
  return cell;
}

void judge(SharedCells& shared, const Tone& tone) {
  for (SharedCell& cell : shared.all()) cell.disagreement = disagreement_of(cell.looks, tone);
  for (SharedCell& cell : shared.all()) {
    Disagreement around;
    shared.for_each_around(cell.place, [&](const SharedCell& other) {
      around.off += other.disagreement.off;
      around.allowed += other.disagreement.allowed;
    });
    const float share = around.off / around.allowed;
    cell.trust = smooth_step((kDistrusted - share) / (kDistrusted - kTrusted));
  }
}

float held_difference(float wanted, float given) {
  return std::clamp(wanted - given, -kMostUnevenness, kMostUnevenness);
}

NodeField extended_trust(const CellGrid& grid, SharedCells& shared) {
  std::vector<CellValues> cells(grid.cells());
  for (const SharedCell& cell : shared.all()) {
    CellValues& values = cells[grid.index(cell.place)];
    values.values[0] = cell.trust;
    values.weight = cell.weight;
  }
  extend(grid, cells);
  std::vector<float> trust;
  for (const CellValues& cell : cells) trust.push_back(cell.values[0]);
  return mean_at_nodes(grid, trust);
}

std::array<NodeField, 3> extended_difference(const CellGrid& grid, SharedCells& shared,
                                             const Tone& tone) {
  std::vector<CellValues> cells(grid.cells());
  for (const SharedCell& cell : shared.all()) {
    const auto& [wanted, given] = cell.looks;
    CellValues& known = cells[grid.index(cell.place)];
    known.weight = 0.25F * cell.weight * cell.trust;  // less than all: neighbours smooth it
    known.values << held_difference(wanted.mean_luma(), tone.luma(given.mean_luma())),
        held_difference(wanted.chroma[0], tone.chroma(given.chroma[0], 0)),
        held_difference(wanted.chroma[1], tone.chroma(given.chroma[1], 1)), 0;
  }
  extend(grid, cells);
  return fields_of(grid, cells);
}

}  // namespace

NeighbourFit fit_neighbour(const CellGrid& grid, const ShownPart& there, const ShownPart& neighbour,
                           float reach_px, float black) {
  SharedCells shared = find_shared(grid, there, neighbour, reach_px);
  NeighbourFit fit;
  const std::vector<CellPair> looks = looks_of(shared);
  fit.tone = match_tones(looks, black);
  fit.shift_px = seam_shift_px(looks, fit.tone);
  judge(shared, fit.tone);
  fit.trust = extended_trust(grid, shared);
  fit.difference = extended_difference(grid, shared, fit.tone);
  return fit;
}

}  // namespace gimbal
