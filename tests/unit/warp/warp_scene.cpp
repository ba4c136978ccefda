#include "tests/unit/warp/warp_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <numbers>
#include <random>

namespace gimbal::warp_scene {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// Noise of all scales: a random lattice for each power of two, the coarser the stronger.
class OctaveNoise {
 public:
  explicit OctaveNoise(unsigned seed) : generator_(seed) {
    for (auto& lattice : lattices_) {
      lattice.resize(kPeriod * kPeriod);
      for (double& value : lattice) value = std::uniform_real_distribution(-1.0, 1.0)(generator_);
    }
  }

  /// Nearest lattice value of each octave: edges at all scales, and every pixel differs.
  [[nodiscard]] double at(int x, int y) const {
    double sum = 0;
    for (std::size_t octave = 0; octave < lattices_.size(); ++octave) {
      const std::size_t column = static_cast<std::size_t>(x >> octave) % kPeriod;
      const std::size_t row = static_cast<std::size_t>(y >> octave) % kPeriod;
      sum += lattices_[octave][row * kPeriod + column];
    }
    return sum;
  }

 private:
  static constexpr std::size_t kPeriod = 61;
  std::mt19937 generator_;
  std::array<std::vector<double>, 7> lattices_;
};

std::uint8_t to_byte(double value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
}

/// A gradient, with noise of all scales, cut by black and white bars.
std::uint8_t texture(const OctaveNoise& noise, int x, int y, ImageSize size) {
  if ((x / 37 + y / 53) % 7 == 0) return 0;
  if ((x / 23 + y / 71) % 11 == 0) return 255;
  return to_byte(255.0 * (x + y) / (size.width + size.height) + 30 * noise.at(x, y));
}

/// Bytes of a row, and rows, of each plane.
std::vector<ImageSize> planes_of(NativeFormat format, ImageSize size) {
  const ImageSize chroma = chroma_size(size);
  switch (format) {
    case NativeFormat::i420:
      return {size, chroma, chroma};
    case NativeFormat::yuyv:
    case NativeFormat::uyvy:
      return {{4 * chroma.width, size.height}};
    default:
      return {{3 * size.width, size.height}};
  }
}

}  // namespace

PinholeIntrinsics ipod_intrinsics(ImageSize size) {
  const double x = size.width / 1280.0;
  const double y = size.height / 720.0;
  return {1223.0 * x, 1217.5 * y, 650.4 * x, 345.3 * y};
}

Lens ipod_lens(ImageSize size) {
  const PinholeIntrinsics k = ipod_intrinsics(size);
  LensParameters parameters;
  parameters.K << k.fx, 0, k.cx, 0, k.fy, k.cy, 0, 0, 1;
  return Lens::create(parameters).value();
}

WarpMesh shaky_mesh(ImageSize source, ImageSize output, Border border, View view) {
  const auto q_world_camera = [&](double line) {
    const double readout = line / source.height - 0.5;
    return Eigen::AngleAxisd(3 * kDegree, Eigen::Vector3d::UnitZ()) *
           Eigen::Quaterniond(
               Eigen::AngleAxisd(readout * 2 * kDegree, Eigen::Vector3d(0.6, 0.8, 0)));
  };
  VirtualCamera camera;
  camera.intrinsics = ipod_intrinsics(output);
  const double zoom = view == View::zoomed_in ? 1.15 : 0.6;
  camera.intrinsics.fx *= zoom;
  camera.intrinsics.fy *= zoom;
  return build_warp_mesh(ipod_lens(source), source, ReadoutDirection::top_down, q_world_camera,
                         camera, output, border, {});
}

WarpMesh mesh_of_map(ImageSize source, ImageSize output, Border border,
                     const std::function<Eigen::Vector2d(Eigen::Vector2d)>& output_of) {
  // The grid of a camera that stands still, with the map put in the place of its output.
  VirtualCamera camera;
  camera.intrinsics = ipod_intrinsics(source);
  const auto still = [](double) { return Eigen::Quaterniond::Identity(); };
  WarpMesh mesh = build_warp_mesh(ipod_lens(source), source, ReadoutDirection::top_down, still,
                                  camera, output, border, {});
  for (MeshVertex& vertex : mesh.vertices) {
    vertex.output_px = output_of(vertex.source_px.cast<double>()).cast<float>();
  }
  return mesh;
}

VideoFrame make_picture(ImageSize size, const ColorInfo& color) {
  const OctaveNoise luma_noise(1);
  const OctaveNoise u_noise(2);
  const OctaveNoise v_noise(3);
  Nv12Buffer picture(size);
  for (int y = 0; y < size.height; ++y) {
    std::uint8_t* row = picture.luma().data + y * picture.luma().stride_bytes;
    for (int x = 0; x < size.width; ++x) row[x] = texture(luma_noise, x, y, size);
  }
  const ImageSize chroma = chroma_size(size);
  for (int y = 0; y < chroma.height; ++y) {
    std::uint8_t* row = picture.chroma().data + y * picture.chroma().stride_bytes;
    for (int x = 0; x < chroma.width; ++x) {
      row[2 * x] = texture(u_noise, x, y, chroma);
      row[2 * x + 1] = texture(v_noise, x, y, chroma);
    }
  }
  return std::move(picture).publish({7, SensorTime(SensorDuration(123456789)), {}}, color);
}

VideoFrame native_picture(NativeFormat format, ImageSize size, int padding) {
  auto memory = std::make_shared<std::vector<std::vector<std::uint8_t>>>();
  VideoFrame frame;
  frame.size = size;
  frame.color = {"bt709", ChromaSiting::left};
  frame.native = NativePicture{format, {}};
  std::size_t index = 0;
  for (const ImageSize plane : planes_of(format, size)) {
    const VideoFrame scene = make_picture(plane, {});
    const std::ptrdiff_t stride = plane.width + padding;
    std::vector<std::uint8_t>& bytes =
        memory->emplace_back(static_cast<std::size_t>(stride * plane.height), 0xEE);
    for (int y = 0; y < plane.height; ++y) {
      const std::uint8_t* row = scene.planes[0].data + y * scene.planes[0].stride_bytes;
      // Each plane the other way round than the one before, so that none can stand for another.
      if (index % 2 == 0) {
        std::copy_n(row, plane.width, bytes.data() + y * stride);
      } else {
        std::reverse_copy(row, row + plane.width, bytes.data() + y * stride);
      }
    }
    frame.native->planes[index++] = {bytes.data(), stride};
  }
  frame.storage = memory;
  return frame;
}

VideoFrame with_strides(const VideoFrame& frame, std::ptrdiff_t luma_stride,
                        std::ptrdiff_t chroma_stride) {
  const std::array<std::ptrdiff_t, 2> strides = {luma_stride, chroma_stride};
  const std::array<int, 2> rows = {frame.size.height, chroma_size(frame.size).height};
  auto memory = std::make_shared<std::array<std::vector<std::uint8_t>, 2>>();
  VideoFrame copy = frame;
  for (int plane = 0; plane < 2; ++plane) {
    const auto p = static_cast<std::size_t>(plane);
    const std::vector<std::uint8_t> bytes = plane_bytes(frame, plane);
    const std::size_t row_bytes = bytes.size() / static_cast<std::size_t>(rows[p]);
    const std::ptrdiff_t distance = std::abs(strides[p]);
    (*memory)[p].resize(static_cast<std::size_t>(distance * rows[p]));
    std::uint8_t* first = (*memory)[p].data() + (strides[p] < 0 ? distance * (rows[p] - 1) : 0);
    for (int y = 0; y < rows[p]; ++y) {
      std::memcpy(first + y * strides[p], bytes.data() + static_cast<std::size_t>(y) * row_bytes,
                  row_bytes);
    }
    copy.planes[p] = {first, strides[p]};
  }
  copy.storage = memory;
  return copy;
}

std::vector<std::uint8_t> plane_bytes(const VideoFrame& frame, int plane) {
  const ImageSize chroma = chroma_size(frame.size);
  const int row_bytes = plane == 0 ? frame.size.width : 2 * chroma.width;
  const int rows = plane == 0 ? frame.size.height : chroma.height;
  const ConstPlane& memory = frame.planes[static_cast<std::size_t>(plane)];
  std::vector<std::uint8_t> bytes;
  bytes.reserve(static_cast<std::size_t>(row_bytes) * static_cast<std::size_t>(rows));
  for (int y = 0; y < rows; ++y) {
    const std::uint8_t* row = memory.data + y * memory.stride_bytes;
    bytes.insert(bytes.end(), row, row + row_bytes);
  }
  return bytes;
}

int largest_difference(const VideoFrame& a, const VideoFrame& b) {
  int largest = 0;
  for (int plane = 0; plane < 2; ++plane) {
    const std::vector<std::uint8_t> bytes_a = plane_bytes(a, plane);
    const std::vector<std::uint8_t> bytes_b = plane_bytes(b, plane);
    EXPECT_EQ(bytes_a.size(), bytes_b.size());
    for (std::size_t i = 0; i < bytes_a.size(); ++i) {
      largest = std::max(largest, std::abs(bytes_a[i] - bytes_b[i]));
    }
  }
  return largest;
}

}  // namespace gimbal::warp_scene
