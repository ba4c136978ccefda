#include "drivers/synthetic/picture_renderer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <thread>
#include <utility>

#include "drivers/synthetic/random.hpp"

namespace gimbal {
namespace {

/// BT.709's transfer function, from linear light to the signal.
float transfer(float light) {
  return light < 0.018F ? 4.5F * light : 1.099F * std::pow(light, 0.45F) - 0.099F;
}

/// The transfer function by a table over the square root of light, where it is nearly straight.
class TransferTable {
 public:
  TransferTable() {
    for (std::size_t i = 0; i < kSteps; ++i) {
      const float root = (static_cast<float>(i) + 0.5F) / kSteps;
      table_[i] = transfer(root * root);
    }
  }

  [[nodiscard]] float operator()(float light) const {
    constexpr float kBelowOne = 1.0F - 1e-6F;
    return table_[static_cast<std::size_t>(std::sqrt(std::clamp(light, 0.0F, kBelowOne)) * kSteps)];
  }

 private:
  static constexpr std::size_t kSteps = 4096;  // a sixteenth of a luma step each
  std::array<float, kSteps> table_{};
};

const TransferTable& transfer_table() {
  static const TransferTable table;
  return table;
}

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::clamp(value + 0.5F, 0.0F, 255.0F));
}

/// Chroma of every pixel, before it is halved.
struct FullChroma {
  explicit FullChroma(ImageSize size)
      : width(size.width),
        pairs(static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height)) {}

  [[nodiscard]] const std::array<float, 2>& at(int x, int y) const {
    return pairs[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                 static_cast<std::size_t>(x)];
  }
  std::array<float, 2>& at(int x, int y) {
    return pairs[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                 static_cast<std::size_t>(x)];
  }

  int width;
  std::vector<std::array<float, 2>> pairs;
};

/// Writes a line as BT.709 with video range (ITU-R BT.709-6, items 3.2 to 3.4 and 4.6).
void encode_line(std::span<const Light> light, LineAxis axis, int line, const MutablePlane& luma,
                 FullChroma& chroma) {
  const TransferTable& signal_of = transfer_table();
  for (std::size_t i = 0; i < light.size(); ++i) {
    const int x = axis == LineAxis::rows ? static_cast<int>(i) : line;
    const int y = axis == LineAxis::rows ? line : static_cast<int>(i);
    const float red = signal_of(light[i].x());
    const float green = signal_of(light[i].y());
    const float blue = signal_of(light[i].z());
    const float signal = 0.2126F * red + 0.7152F * green + 0.0722F * blue;
    luma.data[y * luma.stride_bytes + x] = to_byte(16.0F + 219.0F * signal);
    chroma.at(x, y) = {128.0F + 224.0F / 1.8556F * (blue - signal),
                       128.0F + 224.0F / 1.5748F * (red - signal)};
  }
}

/// One row of halved chroma, sited on the left luma column and between the rows.
void halve_chroma_row(const FullChroma& full, ImageSize size, int row, const MutablePlane& chroma) {
  const int top = 2 * row;
  const int bottom = std::min(top + 1, size.height - 1);
  for (int i = 0; i < chroma_size(size).width; ++i) {
    const int left = std::max(2 * i - 1, 0);
    const int right = std::min(2 * i + 1, size.width - 1);
    std::uint8_t* const pair = chroma.data + row * chroma.stride_bytes + std::ptrdiff_t{2} * i;
    for (std::size_t c = 0; c < 2; ++c) {
      const auto across = [&](int y) {
        return full.at(left, y)[c] + 2.0F * full.at(2 * i, y)[c] + full.at(right, y)[c];
      };
      pair[c] = to_byte((across(top) + across(bottom)) / 8.0F);
    }
  }
}

/// Calls `work` for each of `count` items, on all cores.
void for_each_in_parallel(int count, const std::function<void(int)>& work) {
  const int threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  const auto share = [&](int thread) {
    for (int i = count * thread / threads; i < count * (thread + 1) / threads; ++i) work(i);
  };
  std::vector<std::jthread> others;
  for (int thread = 1; thread < threads; ++thread) others.emplace_back(share, thread);
  share(0);
}

}  // namespace

PictureRenderer::PictureRenderer(std::shared_ptr<const Panorama> panorama, RayTable rays,
                                 const std::optional<PixelNoise>& noise)
    : panorama_(std::move(panorama)), rays_(std::move(rays)) {
  if (noise) noise_.emplace(*noise);
}

ColorInfo PictureRenderer::color() {
  return {"bt709", ChromaSiting::left};
}

VideoFrame PictureRenderer::draw(const FrameStamp& stamp, const LineExposure& exposure,
                                 std::uint64_t noise_seed) const {
  const ImageSize size = rays_.size();
  Nv12Buffer picture(size);
  FullChroma full_chroma(size);
  for_each_in_parallel(line_count(size, rays_.axis()), [&](int line) {
    const RayLine rays = rays_.line(line);
    std::vector<Light> light(rays.x.size(), Light::Zero());
    const std::vector<Eigen::Matrix3f> poses = exposure(line);
    for (const Eigen::Matrix3f& R_world_camera : poses) {
      panorama_->add_light(rays, R_world_camera, 1.0F / static_cast<float>(poses.size()), light);
    }
    if (noise_) noise_->add(light, stream_seed(noise_seed, static_cast<std::uint64_t>(line)));
    encode_line(light, rays_.axis(), line, picture.luma(), full_chroma);
  });
  for_each_in_parallel(chroma_size(size).height, [&](int row) {
    halve_chroma_row(full_chroma, size, row, picture.chroma());
  });
  return std::move(picture).publish(stamp, color());
}

VideoFrame render_global_shutter(std::shared_ptr<const Panorama> panorama,
                                 const VirtualCamera& camera, ImageSize size) {
  const PictureRenderer renderer(std::move(panorama), RayTable(camera.intrinsics, size),
                                 std::nullopt);
  const Eigen::Matrix3f R_world_camera = camera.q_world_camera.toRotationMatrix().cast<float>();
  return renderer.draw(
      camera.stamp, [&](int) { return std::vector{R_world_camera}; }, 0);
}

}  // namespace gimbal
