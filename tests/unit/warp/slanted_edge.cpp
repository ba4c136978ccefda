#include "tests/unit/warp/slanted_edge.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

namespace gimbal::warp_scene {
namespace {

using Eigen::Vector2d;

constexpr double kBinsPerPixel = 4;  // as the standard has it

/// Mean level of the pixels in each bin of distance from the edge.
std::vector<double> edge_spread(const VideoFrame& picture, const Vector2d& point_px,
                                const Vector2d& normal, double reach_px) {
  const auto bins = static_cast<std::size_t>(2 * reach_px * kBinsPerPixel);
  std::vector<double> sums(bins);
  std::vector<double> counts(bins);
  for (int y = 0; y < picture.size.height; ++y) {
    for (int x = 0; x < picture.size.width; ++x) {
      const double distance = normal.dot(Vector2d(x, y) - point_px) + reach_px;
      if (!(distance >= 0 && distance < 2 * reach_px)) continue;
      const auto bin = std::min(static_cast<std::size_t>(distance * kBinsPerPixel), bins - 1);
      sums[bin] += picture.planes[0].data[y * picture.planes[0].stride_bytes + x];
      counts[bin] += 1;
    }
  }
  for (std::size_t i = 0; i < bins; ++i) sums[i] /= counts[i];
  return sums;
}

/// The line spread's share at a frequency, without what bins and differences take from it.
double contrast(const std::vector<double>& line_spread, double cycles_per_px) {
  const double step = 2 * std::numbers::pi * cycles_per_px / kBinsPerPixel;
  std::complex<double> sum = 0;
  double whole = 0;
  for (std::size_t i = 0; i < line_spread.size(); ++i) {
    sum += line_spread[i] * std::polar(1.0, -step * static_cast<double>(i));
    whole += line_spread[i];
  }
  const double half = step / 2;
  const double bin = std::sin(half) / half;    // the mean over a bin
  return std::abs(sum) / whole / (bin * bin);  // and the difference of two bins
}

}  // namespace

double SlantedEdge::level(const Vector2d& at) const {
  const double distance = normal.dot(at - point_px);
  return 128 + 80 * std::erf(distance / (std::numbers::sqrt2 * blur_px));
}

VideoFrame draw_edge(const SlantedEdge& edge, ImageSize size) {
  Nv12Buffer picture(size);
  for (int y = 0; y < size.height; ++y) {
    std::uint8_t* row = picture.luma().data + y * picture.luma().stride_bytes;
    for (int x = 0; x < size.width; ++x) {
      row[x] = static_cast<std::uint8_t>(std::lround(edge.level(Vector2d(x, y))));
    }
  }
  for (int y = 0; y < chroma_size(size).height; ++y) {
    std::fill_n(picture.chroma().data + y * picture.chroma().stride_bytes,
                2 * chroma_size(size).width, std::uint8_t{128});
  }
  return std::move(picture).publish({}, {});
}

double mtf50(const VideoFrame& picture, const Vector2d& point_px, const Vector2d& normal,
             double reach_px) {
  const std::vector<double> spread = edge_spread(picture, point_px, normal, reach_px);
  std::vector<double> line(spread.size() - 1);
  for (std::size_t i = 0; i < line.size(); ++i) line[i] = spread[i + 1] - spread[i];
  constexpr double kStep = 0.001;
  double frequency = kStep;
  while (frequency < 2 && contrast(line, frequency) > 0.5) frequency += kStep;
  return frequency;
}

}  // namespace gimbal::warp_scene
