#include "pipeline/fill/composition.hpp"

#include <cmath>
#include <utility>

#include "pipeline/fill/cell_extension.hpp"
#include "pipeline/sample/smooth_step.hpp"

namespace gimbal {
namespace {

// Widths in a picture: of the band that is blended, as a share of its height; of where an edge
// fades, as a share of that; and how far pictures are compared, in bands.
constexpr float kBandPerHeight = 1 / 30.0F;
constexpr float kNarrowestBand_px = 16;
constexpr float kRampPerBand = 1 / 3.0F;
constexpr float kReachPerBand = 2;

/// A mesh is affine between its vertices, an outline is its edge: so much further inside everything
/// is drawn.
constexpr float kEdge_px = 1;

/// A picture that shows less more, of all nodes, is not worth drawing.
constexpr float kLeastGain = 5e-4F;

constexpr float kOpaque = 255;
constexpr std::uint8_t kMostlyThere = 128;

float band_px(ImageSize picture) {
  return std::max(kNarrowestBand_px, kBandPerHeight * static_cast<float>(picture.height));
}

float ramp(float depth_px, float width_px) {
  return std::clamp((depth_px - kEdge_px) / width_px, 0.0F, 1.0F);
}

float smooth_ramp(float depth_px, float width_px) {
  return smooth_step(ramp(depth_px, width_px));
}

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::clamp(value, 0.0F, 255.0F) + 0.5F);
}

void mix_in(std::uint8_t& there, float share, float value) {
  const auto before = static_cast<float>(there);
  there = to_byte(before + share * (value - before));
}

/// Of a cell's chroma samples, each for the luma around it.
PixelBox chroma_box(const PixelBox& luma) {
  return {luma.x_begin / 2, (luma.x_end + 1) / 2, luma.y_begin / 2, (luma.y_end + 1) / 2};
}

std::uint8_t* row_of(const MutablePlane& plane, int y) {
  return plane.data + y * plane.stride_bytes;
}

const std::uint8_t* row_of(const ConstPlane& plane, int y) {
  return plane.data + y * plane.stride_bytes;
}

/// The mean over the luma around a chroma sample, which the cell may cut.
template <typename Shares>
float share_of_chroma(const Shares& shares, const PixelBox& luma, int x, int y) {
  const auto right = static_cast<std::size_t>(std::min(2 * x + 1, luma.x_end - 1 - luma.x_begin));
  const auto below = static_cast<std::size_t>(std::min(2 * y + 1, luma.y_end - 1 - luma.y_begin));
  const auto left = static_cast<std::size_t>(2 * x);
  const auto above = static_cast<std::size_t>(2 * y);
  return (shares[above][left] + shares[above][right] + shares[below][left] + shares[below][right]) /
         4;
}

}  // namespace

float Composition::reach_px(ImageSize picture) {
  return kReachPerBand * band_px(picture);
}

void Composition::begin(Nv12Buffer picture, float black, NodeField depth_px) {
  if (picture.size() != size_) {
    size_ = picture.size();
    grid_ = CellGrid(size_);
    reach_px_ = reach_px(size_);
    band_px_ = band_px(size_);
    ramp_px_ = kRampPerBand * band_px_;
  }
  picture_.emplace(std::move(picture));
  black_ = black;
  depth_px_ = std::move(depth_px);
  open_.clear();
  grid_.for_each_cell([this](CellPlace cell) {
    if (is_near_gap(cell)) open_.push_back(cell);
  });
  mark_edge();
}

void Composition::mark_edge() {
  alpha_.assign(static_cast<std::size_t>(size_.width) * static_cast<std::size_t>(size_.height),
                static_cast<std::uint8_t>(kOpaque));
  for (const CellPlace& cell : open_) {
    const PixelBox box = grid_.pixels(cell);
    const CellPatch depth(grid_, depth_px_, cell);
    for (int y = box.y_begin; y < box.y_end; ++y) {
      std::uint8_t* const alpha = alpha_at(box.x_begin, y);
      for (int x = 0; x < box.x_end - box.x_begin; ++x) {
        alpha[x] = to_byte(kOpaque * ramp(depth.at(x, y - box.y_begin), ramp_px_));
      }
    }
  }
}

bool Composition::gains_from(const NodeField& depth_px) const {
  std::size_t gained = 0;
  for (std::size_t i = 0; i < depth_px.size(); ++i) {
    if (depth_px_[i] < kEdge_px && depth_px[i] > kEdge_px) ++gained;
  }
  return static_cast<float>(gained) > kLeastGain * static_cast<float>(depth_px.size());
}

bool Composition::is_near_gap(CellPlace cell) const {
  return least_corner(grid_, depth_px_, cell) < reach_px_;
}

PicturePlanes Composition::planes() const {
  return {{{picture_->luma().data, picture_->luma().stride_bytes},
           {picture_->chroma().data, picture_->chroma().stride_bytes}}};
}

NeighbourFit Composition::fit(const ShownPart& neighbour) const {
  return fit_neighbour(grid_, {planes(), depth_px_}, neighbour, reach_px_, black_);
}

void Composition::lay_beneath(const ShownPart& neighbour, const NeighbourFit& fit) {
  for (const CellPlace& cell : open_) {
    const bool gives = least_corner(grid_, depth_px_, cell) < band_px_ + kEdge_px &&
                       greatest_corner(grid_, neighbour.depth_px, cell) > kEdge_px &&
                       greatest_corner(grid_, fit.trust, cell) > 0;
    if (!gives) continue;
    const CellShares shares = take_on(cell, neighbour.depth_px, fit.trust);
    blend(cell, shares, neighbour.planes, fit);
  }
  for (std::size_t i = 0; i < depth_px_.size(); ++i) {
    if (neighbour.depth_px[i] <= 0) continue;
    depth_px_[i] = std::max(depth_px_[i], fit.trust[i] * neighbour.depth_px[i]);
  }
}

/// The old picture lies on the new one, but fades out along its edge where that can be trusted.
Composition::CellShares Composition::take_on(CellPlace cell, const NodeField& depth_px,
                                             const NodeField& trust) {
  const PixelBox box = grid_.pixels(cell);
  const CellPatch old_depth(grid_, depth_px_, cell);
  const CellPatch new_depth(grid_, depth_px, cell);
  const CellPatch trusted(grid_, trust, cell);
  CellShares shares{};
  for (int y = 0; y < box.y_end - box.y_begin; ++y) {
    std::uint8_t* const alpha = alpha_at(box.x_begin, box.y_begin + y);
    for (int x = 0; x < box.x_end - box.x_begin; ++x) {
      const float before = static_cast<float>(alpha[x]) / kOpaque;
      const float added = trusted.at(x, y) * ramp(new_depth.at(x, y), ramp_px_) *
                          (1 - smooth_ramp(old_depth.at(x, y), band_px_));
      const float after = before + added - before * added;
      if (!(added > 0)) continue;
      shares[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] = added / after;
      alpha[x] = to_byte(kOpaque * after);
    }
  }
  return shares;
}

void Composition::blend(CellPlace cell, const CellShares& shares, const PicturePlanes& from,
                        const NeighbourFit& fit) {
  const PixelBox box = grid_.pixels(cell);
  const CellPatch luma_off(grid_, fit.difference[0], cell);
  for (int y = 0; y < box.y_end - box.y_begin; ++y) {
    const std::uint8_t* const given = row_of(from[0], box.y_begin + y) + box.x_begin;
    std::uint8_t* const there = row_of(picture_->luma(), box.y_begin + y) + box.x_begin;
    for (int x = 0; x < box.x_end - box.x_begin; ++x) {
      mix_in(there[x], shares[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)],
             fit.tone.luma(given[x]) + luma_off.at(x, y));
    }
  }
  const PixelBox chroma = chroma_box(box);
  const std::array<CellPatch, 2> chroma_off = {CellPatch(grid_, fit.difference[1], cell),
                                               CellPatch(grid_, fit.difference[2], cell)};
  for (int y = 0; y < chroma.y_end - chroma.y_begin; ++y) {
    const auto first = std::ptrdiff_t{2} * chroma.x_begin;
    const std::uint8_t* const given = row_of(from[1], chroma.y_begin + y) + first;
    std::uint8_t* const there = row_of(picture_->chroma(), chroma.y_begin + y) + first;
    for (int x = 0; x < chroma.x_end - chroma.x_begin; ++x) {
      const float share = share_of_chroma(shares, box, x, y);
      for (std::size_t i = 0; i < chroma_off.size(); ++i) {
        const auto at = std::ptrdiff_t{2} * x + static_cast<std::ptrdiff_t>(i);
        mix_in(there[at], share, fit.tone.chroma(given[at], i) + chroma_off[i].at(2 * x, 2 * y));
      }
    }
  }
}

std::uint8_t Composition::least_alpha(const PixelBox& box) const {
  auto least = static_cast<std::uint8_t>(kOpaque);
  for (int y = box.y_begin; y < box.y_end; ++y) {
    const std::uint8_t* const row = alpha_at(box.x_begin, y);
    least = std::min(least, *std::min_element(row, row + (box.x_end - box.x_begin)));
  }
  return least;
}

std::array<NodeField, 3> Composition::continuation() const {
  std::vector<CellValues> cells(grid_.cells());
  for (const CellPlace& cell : open_) {
    if (!is_whole(grid_, cell) || least_alpha(grid_.pixels(cell)) < kMostlyThere) continue;
    const CellLook look = look_at(planes(), grid_, cell);
    CellValues& known = cells[grid_.index(cell)];
    known.values << look.mean_luma(), look.chroma[0], look.chroma[1], 0;
    known.weight = 1;
  }
  const bool is_any_known = std::any_of(cells.begin(), cells.end(),
                                        [](const CellValues& cell) { return cell.weight > 0; });
  if (!is_any_known) cells.front() = {{black_, 128, 128, 0}, 1};
  extend(grid_, cells);
  return fields_of(grid_, cells);
}

std::int64_t Composition::blur_the_rest() {
  const std::array<NodeField, 3> continued = continuation();
  std::int64_t blurred_px = 0;
  for (const CellPlace& cell : open_) {
    if (least_alpha(grid_.pixels(cell)) < kOpaque) blurred_px += blur(cell, continued);
  }
  return blurred_px;
}

std::int64_t Composition::blur(CellPlace cell, const std::array<NodeField, 3>& continuation) {
  const PixelBox box = grid_.pixels(cell);
  const CellPatch luma(grid_, continuation[0], cell);
  std::int64_t blurred_px = 0;
  CellShares shares{};
  for (int y = 0; y < box.y_end - box.y_begin; ++y) {
    const std::uint8_t* const alpha = alpha_at(box.x_begin, box.y_begin + y);
    std::uint8_t* const there = row_of(picture_->luma(), box.y_begin + y) + box.x_begin;
    for (int x = 0; x < box.x_end - box.x_begin; ++x) {
      const float share = 1 - static_cast<float>(alpha[x]) / kOpaque;
      shares[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] = share;
      mix_in(there[x], share, luma.at(x, y));
      if (alpha[x] < kMostlyThere) ++blurred_px;
    }
  }
  const PixelBox chroma = chroma_box(box);
  const std::array<CellPatch, 2> patches = {CellPatch(grid_, continuation[1], cell),
                                            CellPatch(grid_, continuation[2], cell)};
  for (int y = 0; y < chroma.y_end - chroma.y_begin; ++y) {
    std::uint8_t* const there =
        row_of(picture_->chroma(), chroma.y_begin + y) + std::ptrdiff_t{2} * chroma.x_begin;
    for (int x = 0; x < chroma.x_end - chroma.x_begin; ++x) {
      const float share = share_of_chroma(shares, box, x, y);
      mix_in(there[2 * x], share, patches[0].at(2 * x, 2 * y));
      mix_in(there[2 * x + 1], share, patches[1].at(2 * x, 2 * y));
    }
  }
  return blurred_px;
}

Nv12Buffer Composition::take() {
  Nv12Buffer picture = std::move(*picture_);
  picture_.reset();
  return picture;
}

}  // namespace gimbal
