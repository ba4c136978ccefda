#include <algorithm>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "pipeline/pixels/nv12_frame.hpp"
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

int chosen_threads(std::optional<int> threads) {
  const int cores = static_cast<int>(std::thread::hardware_concurrency());
  return std::max(1, threads.value_or(std::min(cores, kMostThreads)));
}

class CpuWarper final : public Warper {
 public:
  CpuWarper(std::optional<int> threads, Interpolation interpolation)
      : luma_(Plane::luma, interpolation),
        chroma_(Plane::chroma, interpolation),
        workers_(chosen_threads(threads)) {}

  Result<void> begin(const VideoFrame& source, const WarpMesh& mesh) override {
    if (auto checked = check_warp_input(source, mesh); !checked) return checked;
    if (source.native) return begin(as_nv12(source), mesh);
    Nv12Buffer picture = pool_.take(mesh.output_size);
    const BlackLevel black = black_level(source.color);
    luma_.begin(mesh, source, picture.luma(), {black.luma, black.luma});
    chroma_.begin(mesh, source, picture.chroma(), black.chroma);
    draw();
    drawn_ = pool_.publish(std::move(picture), source.stamp, source.color);
    return {};
  }

  Result<VideoFrame> finish() override { return std::exchange(drawn_, {}); }
  [[nodiscard]] std::size_t most_in_flight() const override { return 1; }

  [[nodiscard]] std::int64_t bytes_copied() const override { return 0; }
  [[nodiscard]] std::string name() const override { return "cpu"; }
  [[nodiscard]] std::string renderer() const override {
    return vector_instructions() + ", threads: " + std::to_string(workers_.threads());
  }

 private:
  /// A plane is cut by whoever draws its first band.
  void draw() {
    std::once_flag luma_is_cut;
    std::once_flag chroma_is_cut;
    workers_.share(luma_.bands() + chroma_.bands(), [&](int band) {
      if (band < luma_.bands()) {
        std::call_once(luma_is_cut, [this] { luma_.cut(); });
        return luma_.draw(band);
      }
      std::call_once(chroma_is_cut, [this] { chroma_.cut(); });
      chroma_.draw(band - luma_.bands());
    });
  }

  PlaneDrawing luma_;
  PlaneDrawing chroma_;
  PicturePool pool_;
  VideoFrame drawn_;
  BandWorkers workers_;
};

}  // namespace

std::unique_ptr<Warper> make_cpu_warper(std::optional<int> threads, Interpolation interpolation) {
  return std::make_unique<CpuWarper>(threads, interpolation);
}

}  // namespace gimbal
