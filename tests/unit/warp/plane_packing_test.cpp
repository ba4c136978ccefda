// Planes brought to other texels and back, as GPUs want it that know few formats.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "pipeline/warp/dma_buf_texture.hpp"
#include "pipeline/warp/draw_plane.hpp"
#include "pipeline/warp/egl_context.hpp"
#include "pipeline/warp/plane_format.hpp"
#include "pipeline/warp/plane_packer.hpp"
#include "pipeline/warp/plane_readback.hpp"
#include "pipeline/warp/plane_unpacker.hpp"
#include "pipeline/warp/plane_upload.hpp"
#include "pipeline/warp/test_pattern.hpp"

namespace gimbal {
namespace {

struct Case {
  PlaneView view = PlaneView::pixels;
  Plane plane = Plane::luma;
  ImageSize size;
};

/// The pattern's rows as texels of the view, padded to whole texels.
std::vector<std::uint8_t> pattern_texels(const Case& c) {
  const ImageSize texels = texels_of(c.view, c.plane, c.size);
  const std::ptrdiff_t stride = std::ptrdiff_t{texels.width} * bytes_per_texel(c.view, c.plane);
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(stride * texels.height));
  draw_pattern({bytes.data(), stride}, c.size, c.plane);
  return bytes;
}

GlTexture texture_with(const std::vector<std::uint8_t>& bytes, ImageSize size,
                       const TextureFormat& format) {
  GlTexture texture = make_texture(size, format, GL_NEAREST);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, size.width, size.height, format.format, GL_UNSIGNED_BYTE,
                  bytes.data());
  return texture;
}

/// To a texel a pixel, and back.
void expect_same_after_round_trip(const Case& c, int gles_version) {
  const int bytes = bytes_per_texel(c.view, c.plane);
  const TextureFormat format = bytes == 4 ? kRgbaFormat : TextureFormat{GL_R8, GL_RED, 1};
  const ImageSize texels = texels_of(c.view, c.plane, c.size);
  const GlTexture from = texture_with(pattern_texels(c), texels, format);
  auto unpacker = PlaneUnpacker::create(c.plane, c.size, gles_version, bytes).value();
  const GLuint pixels = unpacker.unpack(from.name(), texels);
  glBindTexture(GL_TEXTURE_2D, pixels);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);

  const GlTexture to = make_texture(texels, format, GL_NEAREST);
  const GlFramebuffer target = make_framebuffer(to);
  ASSERT_TRUE(is_complete(target));
  auto packer = PlanePacker::create(c.plane, bytes).value();
  packer.pack(pixels, plane_size(c.size, c.plane), target.name(), texels);
  std::vector<std::uint8_t> rgba(static_cast<std::size_t>(texels.width) *
                                 static_cast<std::size_t>(texels.height) * 4);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, texels.width, texels.height, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
  std::vector<std::uint8_t> bytes_read;
  for (std::size_t i = 0; i < rgba.size(); ++i) {
    if (bytes == 4 || i % 4 == 0) bytes_read.push_back(rgba[i]);
  }
  EXPECT_TRUE(
      shows_pattern({bytes_read.data(), std::ptrdiff_t{texels.width} * bytes}, c.size, c.plane))
      << c.size.width << " wide, " << bytes << " bytes a texel, plane "
      << static_cast<int>(c.plane);
}

TEST(PlanePacking, AllBytesComeBackWhereTheyWere) {
  const auto context = EglContext::create(GlesVersion::best).value();
  if (context->major_version() < 3) GTEST_SKIP() << "this renderer has no GLES 3";
  for (const ImageSize size : {ImageSize{13, 6}, ImageSize{640, 360}, ImageSize{1282, 722},
                               ImageSize{1920, 1080}, ImageSize{3840, 20}}) {
    expect_same_after_round_trip({PlaneView::bytes, Plane::chroma, size}, 3);
    expect_same_after_round_trip({PlaneView::packed, Plane::luma, size}, 3);
    expect_same_after_round_trip({PlaneView::packed, Plane::chroma, size}, 3);
  }
}

/// The pattern is drawn as it is, then black by another; both are read when both are drawn.
void expect_same_when_read(Plane plane, ImageSize size, int gles_version, Readback readback) {
  auto painter =
      MeshPainter::create(texture_channels(gles_version), Interpolation::bilinear).value();
  PlaneUpload upload(plane, size, gles_version);
  std::vector<PlaneReadback> drawn;
  const Nv12Buffer picture(size);
  const MutablePlane memory = plane_of(picture, plane);
  for (int i = 0; i < 2; ++i) {
    drawn.push_back(PlaneReadback::create(plane, size, gles_version, readback).value());
    draw_pattern(memory, size, plane);
    const auto bytes = memory.stride_bytes * plane_size(size, plane).height;
    if (i == 1) std::fill_n(memory.data, bytes, std::uint8_t{0});
    draw_plane(painter, identity_mesh(size), plane, ChromaSiting::left, {0, 0},
               {upload.upload({memory.data, memory.stride_bytes}), drawn.back().framebuffer()});
    drawn.back().begin(memory.stride_bytes);
  }
  for (std::size_t i = 0; i < 2; ++i) {
    ASSERT_TRUE(drawn[i].finish(memory));
    EXPECT_EQ(shows_pattern({memory.data, memory.stride_bytes}, size, plane), i == 0)
        << size.width << " wide, plane " << static_cast<int>(plane) << ", GLES " << gles_version
        << ", way " << static_cast<int>(readback);
  }
}

TEST(PlaneReadback, GivesWhatWasDrawn) {
  for (const GlesVersion version : {GlesVersion::best, GlesVersion::gles2}) {
    const auto context = EglContext::create(version).value();
    for (const ImageSize size : {ImageSize{13, 6}, ImageSize{640, 360}, ImageSize{641, 361}}) {
      for (const Plane plane : {Plane::luma, Plane::chroma}) {
        expect_same_when_read(plane, size, context->major_version(), Readback::packed);
        if (context->major_version() < 3) continue;
        expect_same_when_read(plane, size, context->major_version(), Readback::direct);
        expect_same_when_read(plane, size, context->major_version(), Readback::buffered);
      }
    }
  }
}

}  // namespace
}  // namespace gimbal
