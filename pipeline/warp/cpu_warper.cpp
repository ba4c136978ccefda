#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "pipeline/warp/band_workers.hpp"
#include "pipeline/warp/black_level.hpp"
#include "pipeline/warp/picture_pool.hpp"
#include "pipeline/warp/plane_drawing.hpp"
#include "pipeline/warp/span_painter.hpp"
#include "pipeline/warp/warp_input.hpp"
#include "pipeline/warp/warper.hpp"

namespace gimbal {
namespace {

/// More threads share what the memory can deliver; they cost more to wake than they save.
constexpr int kMostThreads = 4;

/// Tall enough to cost more than handing them out, short enough that all threads end together.
constexpr int kBandRows = 128;

int chosen_threads(std::optional<int> threads) {
  const int cores = static_cast<int>(std::thread::hardware_concurrency());
  return std::max(1, threads.value_or(std::min(cores, kMostThreads)));
}

int band_count(ImageSize size) {
  return (size.height + kBandRows - 1) / kBandRows;
}

RowRange band_rows(int band, ImageSize size) {
  return {band * kBandRows, std::min((band + 1) * kBandRows, size.height)};
}

class CpuWarper final : public Warper {
 public:
  explicit CpuWarper(std::optional<int> threads) : workers_(chosen_threads(threads)) {}

  Result<VideoFrame> warp(const VideoFrame& source, const WarpMesh& mesh) override {
    if (auto checked = check_warp_input(source, mesh); !checked) {
      return tl::unexpected(checked.error());
    }
    Nv12Buffer picture = pool_.take(mesh.output_size);
    const BlackLevel black = black_level(source.color);
    const PlaneDrawing luma(mesh, Plane::luma, source, picture.luma(), {black.luma, black.luma});
    const PlaneDrawing chroma(mesh, Plane::chroma, source, picture.chroma(), black.chroma);
    const int luma_bands = band_count(luma.size());
    workers_.share(luma_bands + band_count(chroma.size()), [&](int band) {
      if (band < luma_bands) return luma.draw(band_rows(band, luma.size()));
      chroma.draw(band_rows(band - luma_bands, chroma.size()));
    });
    return pool_.publish(std::move(picture), source.stamp, source.color);
  }

  [[nodiscard]] std::string name() const override { return "cpu"; }
  [[nodiscard]] std::string renderer() const override {
    return vector_instructions() + ", threads: " + std::to_string(workers_.threads());
  }

 private:
  PicturePool pool_;
  BandWorkers workers_;
};

}  // namespace

std::unique_ptr<Warper> make_cpu_warper(std::optional<int> threads) {
  return std::make_unique<CpuWarper>(threads);
}

}  // namespace gimbal
