#include "pipeline/warp/gles_plane.hpp"

#include <cstddef>
#include <cstring>
#include <utility>

namespace gimbal {
namespace {

constexpr TextureFormat kRgba = {GL_RGBA, GL_RGBA, 4};

TextureFormat source_format(Plane plane, int gles_version) {
  if (gles_version >= 3) {
    return plane == Plane::luma ? TextureFormat{GL_R8, GL_RED, 1} : TextureFormat{GL_RG8, GL_RG, 2};
  }
  return plane == Plane::luma ? TextureFormat{GL_LUMINANCE, GL_LUMINANCE, 1}
                              : TextureFormat{GL_LUMINANCE_ALPHA, GL_LUMINANCE_ALPHA, 2};
}

/// Whether the bound framebuffer can be read in this format; RGBA is the only one promised.
bool can_read(GLenum format) {
  GLint read_format = 0;
  GLint read_type = 0;
  glGetIntegerv(GL_IMPLEMENTATION_COLOR_READ_FORMAT, &read_format);
  glGetIntegerv(GL_IMPLEMENTATION_COLOR_READ_TYPE, &read_type);
  return read_format == static_cast<GLint>(format) && read_type == GL_UNSIGNED_BYTE;
}

}  // namespace

std::string texture_channels(int gles_version) {
  return gles_version >= 3 ? "rg" : "ra";
}

GlesPlane::GlesPlane(Plane plane, ImageSize source, ImageSize output, int gles_version)
    : plane_(plane),
      gles_version_(gles_version),
      source_size_(plane_size(source, plane)),
      output_size_(plane_size(output, plane)),
      format_(source_format(plane, gles_version)),
      source_(make_texture(source_size_, format_, GL_LINEAR)) {}

void GlesPlane::make_target(const TextureFormat& format) {
  target_ = make_texture(output_size_, format, GL_NEAREST);
  framebuffer_ = make_framebuffer(target_);
}

Result<GlesPlane> GlesPlane::create(Plane plane, ImageSize source, ImageSize output,
                                    int gles_version, Readback readback) {
  GlesPlane made(plane, source, output, gles_version);
  made.make_target(readback == Readback::direct ? made.format_ : kRgba);
  if (!is_complete(made.framebuffer_)) return failed("gles: the driver cannot draw into a texture");
  if (readback == Readback::direct) {
    if (!can_read(made.format_.format)) return failed("gles: the driver reads back only RGBA");
    return made;
  }
  auto packer = PlanePacker::create(plane);
  if (!packer) return tl::unexpected(packer.error());
  made.packer_ = std::move(*packer);
  return made;
}

void GlesPlane::upload(ConstPlane source) {
  const auto put = [&](const void* pixels) {
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, source_size_.width, source_size_.height, format_.format,
                    GL_UNSIGNED_BYTE, pixels);
  };
  const std::ptrdiff_t row_bytes = std::ptrdiff_t{source_size_.width} * format_.bytes_per_pixel;
  glBindTexture(GL_TEXTURE_2D, source_.name());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  if (source.stride_bytes == row_bytes) return put(source.data);
  if (gles_version_ >= 3 && source.stride_bytes > row_bytes &&
      source.stride_bytes % format_.bytes_per_pixel == 0) {
    const auto row_pixels = static_cast<GLint>(source.stride_bytes / format_.bytes_per_pixel);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, row_pixels);
    put(source.data);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
    return;
  }
  rows_.resize(static_cast<std::size_t>(row_bytes * source_size_.height));
  for (int y = 0; y < source_size_.height; ++y) {
    std::memcpy(rows_.data() + y * row_bytes, source.data + y * source.stride_bytes,
                static_cast<std::size_t>(row_bytes));
  }
  put(rows_.data());
}

void GlesPlane::draw(MeshPainter& painter, const WarpMesh& mesh, ChromaSiting siting,
                     std::array<std::uint8_t, 2> background) {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  glViewport(0, 0, output_size_.width, output_size_.height);
  glClearColor(static_cast<float>(background[0]) / 255, static_cast<float>(background[1]) / 255, 0,
               1);
  glClear(GL_COLOR_BUFFER_BIT);
  glBindTexture(GL_TEXTURE_2D, source_.name());
  painter.draw(mesh, plane_vertices(mesh, plane_, siting), source_size_, output_size_);
}

void GlesPlane::read(MutablePlane output) {
  if (packer_) {
    packer_->read(target_, output_size_, output);
  } else {
    read_directly(output);
  }
}

void GlesPlane::read_directly(MutablePlane output) {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glPixelStorei(GL_PACK_ROW_LENGTH,
                static_cast<GLint>(output.stride_bytes / format_.bytes_per_pixel));
  glReadPixels(0, 0, output_size_.width, output_size_.height, format_.format, GL_UNSIGNED_BYTE,
               output.data);
  glPixelStorei(GL_PACK_ROW_LENGTH, 0);
}

}  // namespace gimbal
