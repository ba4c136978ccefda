// Pictures that the GPU reads and draws where they lie. Wants memory for them, /dev/dma_heap or
// /dev/udmabuf, and a driver that imports it; what is drawn is compared with what copies show.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/pixels/nv12_frame.hpp"
#include "pipeline/warp/draw_plane.hpp"
#include "pipeline/warp/egl_context.hpp"
#include "pipeline/warp/packed_import.hpp"
#include "pipeline/warp/plane_format.hpp"
#include "pipeline/warp/plane_upload.hpp"
#include "pipeline/warp/test_pattern.hpp"
#include "pipeline/warp/transfer_probe.hpp"
#include "pipeline/warp/warper.hpp"
#include "tests/unit/warp/warp_scene.hpp"

namespace gimbal::warp_scene {
namespace {

constexpr std::array kPlanes = {Plane::luma, Plane::chroma};

ConstPlane read_only(MutablePlane plane) {
  return {plane.data, plane.stride_bytes};
}

/// The frame's rows, in memory that may be longer.
void copy_rows(const VideoFrame& frame, const Nv12Buffer& memory) {
  begin_writing(memory);
  for (const Plane plane : kPlanes) {
    const ConstPlane from = frame.planes[static_cast<std::size_t>(plane)];
    const MutablePlane to = plane_of(memory, plane);
    const ImageSize size = plane_size(frame.size, plane);
    const int row_bytes = plane == Plane::luma ? size.width : 2 * size.width;
    for (int y = 0; y < size.height; ++y) {
      std::memcpy(to.data + y * to.stride_bytes, from.data + y * from.stride_bytes,
                  static_cast<std::size_t>(row_bytes));
    }
  }
  end_writing(memory);
}

/// Rows as cameras have them: as long as the picture, or padded, with a gap before the chroma.
std::vector<PictureLayout> camera_layouts(ImageSize size) {
  const std::ptrdiff_t row = std::ptrdiff_t{2} * chroma_size(size).width;
  return {{size, row, row, row * size.height},
          {size, row + 64, row + 64, (row + 64) * (size.height + 8)},
          padded_layout(size)};
}

class DmaBufTest : public testing::TestWithParam<GlesVersion> {
 protected:
  void SetUp() override {
    auto heap = DmaBufHeap::open();
    if (!heap) GTEST_SKIP() << "no dma-bufs here: " << heap.error().message;
    heap_.emplace(std::move(*heap));
    const auto context = EglContext::create(GetParam());
    ASSERT_TRUE(context) << context.error().message;
    const auto textures = DmaBufTextures::create((*context)->display());
    if (!textures) GTEST_SKIP() << "no dma-bufs here: " << textures.error().message;
  }

  [[nodiscard]] VideoFrame in_dma_buf(const VideoFrame& frame, const PictureLayout& layout) const {
    Nv12Buffer memory = heap_->allocate(layout).value();
    copy_rows(frame, memory);
    return std::move(memory).publish(frame.stamp, frame.color);
  }

  /// A native picture of one plane.
  [[nodiscard]] VideoFrame packed_in_dma_buf(const VideoFrame& native) const {
    const ConstPlane from = native.native->planes[0];
    const ImageSize bytes{static_cast<int>(from.stride_bytes), native.size.height};
    const Nv12Buffer memory = heap_
                                  ->allocate({bytes, from.stride_bytes, from.stride_bytes,
                                              from.stride_bytes * bytes.height})
                                  .value();
    begin_writing(memory);
    std::memcpy(memory.luma().data, from.data,
                static_cast<std::size_t>(from.stride_bytes * bytes.height));
    end_writing(memory);
    VideoFrame frame = native;
    frame.native->planes[0].data = memory.luma().data;
    frame.native->dma_buf = {{(*memory.dma_buf())[0]}};
    frame.storage = std::make_shared<const VideoFrame>(Nv12Buffer(memory).publish({}, {}));
    return frame;
  }

  [[nodiscard]] std::unique_ptr<Warper> warper(ImageSize size, DmaBufUse use,
                                               Interpolation interpolation) const {
    return make_gles_warper(size, size, {interpolation, GetParam(), use}).value();
  }

  /// For all layouts and two borders.
  void expect_alike(Warper& copying, Warper& sharing, ImageSize size) const {
    const VideoFrame picture = make_picture(size, {"bt709", ChromaSiting::left});
    for (const Border border : {Border::crop, Border::mirror}) {
      const WarpMesh mesh = shaky_mesh(size, size, border, View::zoomed_out);
      const VideoFrame expected = copying.warp(picture, mesh).value();
      for (const PictureLayout& layout : camera_layouts(size)) {
        const VideoFrame drawn = sharing.warp(in_dma_buf(picture, layout), mesh).value();
        // GLES 2 copies into other formats, which are interpolated with other roundings.
        EXPECT_LE(largest_difference(drawn, expected), GetParam() == GlesVersion::best ? 1 : 2)
            << size.width << "x" << size.height << ", stride " << layout.luma_stride_bytes;
        EXPECT_TRUE(drawn.dma_buf);
      }
    }
  }

  /// A pattern drawn from one dma-buf into another.
  void expect_same_picture(MeshPainter& painter, DmaBufs& dma_bufs, PlaneView view, ImageSize size,
                           int gles_version) const {
    const Nv12Buffer from = heap_->allocate(padded_layout(size)).value();
    const Nv12Buffer to = heap_->allocate(padded_layout(size)).value();
    begin_writing(from);
    for (const Plane plane : kPlanes) draw_pattern(plane_of(from, plane), size, plane);
    end_writing(from);
    auto sources = DmaBufSources::create(view, size, gles_version).value();
    auto targets = DmaBufTargets::create(view, size, gles_version).value();
    const auto textures = sources.textures(dma_bufs.textures, dma_buf_picture(from)).value();
    const auto framebuffers = targets.framebuffers(dma_bufs.textures, dma_buf_picture(to)).value();
    for (const Plane plane : kPlanes) {
      const auto index = static_cast<std::size_t>(plane);
      draw_plane(painter, identity_mesh(size), plane, ChromaSiting::left, {0, 0},
                 {textures[index], framebuffers[index]});
    }
    ASSERT_TRUE(targets.finish(dma_bufs.textures, dma_buf_picture(to)));
    ASSERT_TRUE(dma_bufs.fences.insert().wait());
    begin_reading(to);
    for (const Plane plane : kPlanes) {
      EXPECT_TRUE(shows_pattern(read_only(plane_of(to, plane)), size, plane))
          << dma_buf_text(view) << ", plane " << static_cast<int>(plane) << ", " << size.width;
    }
    end_reading(to);
  }

  std::optional<DmaBufHeap> heap_;
};

TEST_P(DmaBufTest, ShowsWhatCopiesShow) {
  for (const auto interpolation : {Interpolation::bilinear, Interpolation::bicubic}) {
    for (const ImageSize size : {ImageSize{640, 360}, ImageSize{642, 362}, ImageSize{101, 57}}) {
      const auto sharing = warper(size, DmaBufUse::always, interpolation);
      expect_alike(*warper(size, DmaBufUse::never, interpolation), *sharing, size);
      EXPECT_EQ(sharing->bytes_copied(), 0);
      EXPECT_EQ(sharing->transfers(), "in dma-buf R8+GR88, out dma-buf R8+GR88");
    }
  }
}

TEST_P(DmaBufTest, ShowsPackedPicturesAsTheirConversion) {
  for (const ImageSize size : {ImageSize{322, 182}, ImageSize{101, 57}}) {
    const auto copying = warper(size, DmaBufUse::never, Interpolation::bilinear);
    const WarpMesh mesh = shaky_mesh(size, size, Border::crop, View::zoomed_out);
    for (const NativeFormat format : {NativeFormat::yuyv, NativeFormat::uyvy}) {
      const auto sharing = warper(size, DmaBufUse::always, Interpolation::bilinear);
      for (const int padding : {0, 64, 768 - 4 * chroma_size(size).width % 256}) {
        const VideoFrame native = native_picture(format, size, padding);
        const VideoFrame drawn = sharing->warp(packed_in_dma_buf(native), mesh).value();
        EXPECT_LE(largest_difference(drawn, copying->warp(as_nv12(native), mesh).value()), 1)
            << name_of(format) << ", " << size.width << ", padding " << padding;
        EXPECT_EQ(sharing->transfers(),
                  "in dma-buf " + std::string(name_of(format)) + ", out dma-buf R8+GR88");
      }
      EXPECT_EQ(sharing->bytes_copied(), 0);
    }
  }
}

TEST_P(DmaBufTest, CopiesFramesThatLieElsewhere) {
  const ImageSize size{320, 180};
  const VideoFrame picture = make_picture(size, {});
  const WarpMesh mesh = shaky_mesh(size, size, Border::crop, View::zoomed_in);
  const auto sharing = warper(size, DmaBufUse::always, Interpolation::bilinear);
  const VideoFrame shared = sharing->warp(in_dma_buf(picture, padded_layout(size)), mesh).value();
  const VideoFrame copied = sharing->warp(picture, mesh).value();
  EXPECT_LE(largest_difference(shared, copied), 1);
  EXPECT_EQ(sharing->bytes_copied(), nv12_bytes(size));
  EXPECT_EQ(sharing->transfers(), "in copied, out dma-buf R8+GR88");
}

TEST_P(DmaBufTest, SeesWhatACameraWritesIntoTheSameMemoryAgain) {
  const ImageSize size{320, 180};
  const WarpMesh mesh = mesh_of_map(size, size, Border::crop, same);
  const auto sharing = warper(size, DmaBufUse::always, Interpolation::bilinear);
  const Nv12Buffer memory = heap_->allocate(padded_layout(size)).value();
  std::vector<VideoFrame> held;
  for (int brightness = 0; brightness < 4; ++brightness) {
    begin_writing(memory);
    const MutablePlane luma = memory.luma();
    std::memset(luma.data, 20 + 50 * brightness,
                static_cast<std::size_t>(luma.stride_bytes * size.height));
    end_writing(memory);
    held.push_back(sharing->warp(Nv12Buffer(memory).publish({}, {}), mesh).value());
  }
  for (int brightness = 0; brightness < 4; ++brightness) {
    const std::vector<std::uint8_t> luma =
        plane_bytes(held[static_cast<std::size_t>(brightness)], 0);
    EXPECT_EQ(luma, std::vector<std::uint8_t>(luma.size(),
                                              static_cast<std::uint8_t>(20 + 50 * brightness)));
  }
}

TEST_P(DmaBufTest, UsesItsMemoryAgain) {
  const ImageSize size{320, 180};
  const WarpMesh mesh = mesh_of_map(size, size, Border::crop, same);
  const auto sharing = warper(size, DmaBufUse::always, Interpolation::bilinear);
  const VideoFrame picture = in_dma_buf(make_picture(size, {}), padded_layout(size));
  const auto* first = sharing->warp(picture, mesh).value().planes[0].data;
  const auto* second = sharing->warp(picture, mesh).value().planes[0].data;
  EXPECT_EQ(first, second);
}

TEST_P(DmaBufTest, LetsGoOfFramesThatDoNotComeAgain) {
  const ImageSize size{320, 180};
  const WarpMesh mesh = mesh_of_map(size, size, Border::crop, same);
  const auto sharing = warper(size, DmaBufUse::always, Interpolation::bilinear);
  const VideoFrame picture = make_picture(size, {});
  const VideoFrame before = sharing->warp(in_dma_buf(picture, padded_layout(size)), mesh).value();
  sharing->forget_frames();
  const VideoFrame after = sharing->warp(in_dma_buf(picture, padded_layout(size)), mesh).value();
  EXPECT_EQ(largest_difference(before, after), 0);
  EXPECT_EQ(sharing->bytes_copied(), 0);
}

TEST_P(DmaBufTest, FramesInFlightComeOutAsThoseDrawnOneByOne) {
  const ImageSize size{320, 180};
  const auto sharing = warper(size, DmaBufUse::always, Interpolation::bilinear);
  std::vector<VideoFrame> frames;
  std::vector<WarpMesh> meshes;
  std::vector<VideoFrame> expected;
  for (const Border border : {Border::crop, Border::mirror, Border::extend, Border::black}) {
    frames.push_back(in_dma_buf(make_picture(size, {}), padded_layout(size)));
    meshes.push_back(shaky_mesh(size, size, border, View::zoomed_out));
    expected.push_back(sharing->warp(frames.back(), meshes.back()).value());
  }
  ASSERT_GE(sharing->most_in_flight(), 2U);
  ASSERT_TRUE(sharing->begin(frames[0], meshes[0]));
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (i + 1 < frames.size()) {
      ASSERT_TRUE(sharing->begin(frames[i + 1], meshes[i + 1]));
    }
    EXPECT_EQ(largest_difference(sharing->finish().value(), expected[i]), 0) << i;
  }
  EXPECT_EQ(sharing->bytes_copied(), 0);
}

TEST_P(DmaBufTest, HoldsAFramesMemoryUntilItWasRead) {
  const ImageSize size{320, 180};
  const WarpMesh mesh = mesh_of_map(size, size, Border::crop, same);
  const auto sharing = warper(size, DmaBufUse::always, Interpolation::bilinear);
  std::array<std::weak_ptr<const void>, 2> memory;
  for (auto& one : memory) {
    const VideoFrame frame = in_dma_buf(make_picture(size, {}), padded_layout(size));
    one = frame.storage;
    ASSERT_TRUE(sharing->begin(frame, mesh));
  }
  EXPECT_FALSE(memory[0].expired());
  ASSERT_TRUE(sharing->finish());
  EXPECT_TRUE(memory[0].expired());
  EXPECT_FALSE(memory[1].expired());
  ASSERT_TRUE(sharing->finish());
  EXPECT_TRUE(memory[1].expired());
}

/// Views that no renderer here needs, but GPUs that draw into fewer formats do.
TEST_P(DmaBufTest, EveryViewGivesThePictureAsItIs) {
  const auto context = EglContext::create(GetParam()).value();
  auto painter = MeshPainter::create(kImportedChannels, Interpolation::bilinear).value();
  DmaBufs dma_bufs{*heap_, DmaBufTextures::create(context->display()).value(),
                   GlFences(context->display())};
  for (const ImageSize size : {ImageSize{640, 360}, ImageSize{101, 57}, ImageSize{1920, 1080}}) {
    for (const PlaneView view : {PlaneView::pixels, PlaneView::bytes, PlaneView::packed}) {
      expect_same_picture(painter, dma_bufs, view, size, context->major_version());
    }
  }
}

TEST_P(DmaBufTest, EveryViewGivesAPackedPictureAsItsConversion) {
  const auto context = EglContext::create(GetParam()).value();
  const int version = context->major_version();
  auto painter = MeshPainter::create(texture_channels(version), Interpolation::bilinear).value();
  const Readback readback = choose_readback(painter, version).value();
  DmaBufs dma_bufs{*heap_, DmaBufTextures::create(context->display()).value(),
                   GlFences(context->display())};
  for (const ImageSize size : {ImageSize{640, 360}, ImageSize{101, 57}, ImageSize{1922, 30}}) {
    const VideoFrame native = native_picture(NativeFormat::uyvy, size, 64);
    const VideoFrame expected = as_nv12(native);
    const VideoFrame memory = packed_in_dma_buf(native);
    for (const PlaneView view : {PlaneView::pixels, PlaneView::packed}) {
      auto import =
          PackedImport::create(
              view, {NativeFormat::uyvy, size, memory.native->planes[0].stride_bytes}, version)
              .value();
      const auto textures =
          import.textures(dma_bufs.textures, (*memory.native->dma_buf)[0]).value();
      for (const Plane plane : kPlanes) {
        const auto index = static_cast<std::size_t>(plane);
        auto drawn = PlaneReadback::create(plane, size, version, readback).value();
        draw_plane(painter, identity_mesh(size), plane, ChromaSiting::left, {0, 0},
                   {textures[index], drawn.framebuffer()});
        const Nv12Buffer result(size);
        const MutablePlane drawn_to = plane_of(result, plane);
        drawn.begin(drawn_to.stride_bytes);
        ASSERT_TRUE(drawn.finish(drawn_to));
        EXPECT_TRUE(
            are_alike(read_only(plane_of(result, plane)), expected.planes[index], size, plane))
            << size.width << " wide, view " << static_cast<int>(view) << ", plane " << index;
      }
    }
  }
}

TEST_P(DmaBufTest, ARendererThatReadsWronglyIsNotBelieved) {
  const auto context = EglContext::create(GetParam()).value();
  const int version = context->major_version();
  auto painter = MeshPainter::create(texture_channels(version), Interpolation::bilinear).value();
  const Readback readback = choose_readback(painter, version).value();
  DmaBufs dma_bufs{*heap_, DmaBufTextures::create(context->display()).value(),
                   GlFences(context->display())};
  const PictureLayout layout = padded_layout({320, 180});
  const PackedLayout packed = {NativeFormat::yuyv, {320, 180}, 640};
  EXPECT_EQ(choose_packed_view(dma_bufs, painter, packed, version, readback), PlaneView::pixels);
  auto right = MeshPainter::create(kImportedChannels, Interpolation::bilinear).value();
  EXPECT_EQ(choose_source_view(dma_bufs, right, layout, version, readback), PlaneView::pixels);
  auto swapped = MeshPainter::create("gr", Interpolation::bilinear).value();
  EXPECT_FALSE(choose_source_view(dma_bufs, swapped, layout, version, readback));
  EXPECT_FALSE(choose_packed_view(dma_bufs, swapped, packed, version, readback));
}

std::string version_name(const testing::TestParamInfo<GlesVersion>& version) {
  return version.param == GlesVersion::best ? "best" : "gles2";
}

INSTANTIATE_TEST_SUITE_P(Versions, DmaBufTest,
                         testing::Values(GlesVersion::best, GlesVersion::gles2), version_name);

TEST(DmaBufUse, WithoutDmaBufsPicturesAreCopied) {
  const ImageSize size{320, 180};
  const WarpMesh mesh = shaky_mesh(size, size, Border::crop, View::zoomed_in);
  const VideoFrame picture = make_picture(size, {});
  const auto copying =
      make_gles_warper(size, size, {Interpolation::bilinear, GlesVersion::best, DmaBufUse::never})
          .value();
  EXPECT_FALSE(copying->warp(picture, mesh).value().dma_buf);
  EXPECT_EQ(copying->bytes_copied(), 2 * nv12_bytes(size));
  EXPECT_EQ(copying->transfers(), "in copied, out copied");
}

}  // namespace
}  // namespace gimbal::warp_scene
