#include "pipeline/warp/plane_readback.hpp"

#include <utility>

namespace gimbal {
namespace {

/// Whether the bound framebuffer can be read in this format; RGBA is the only one promised.
bool can_read(GLenum format) {
  GLint read_format = 0;
  GLint read_type = 0;
  glGetIntegerv(GL_IMPLEMENTATION_COLOR_READ_FORMAT, &read_format);
  glGetIntegerv(GL_IMPLEMENTATION_COLOR_READ_TYPE, &read_type);
  return read_format == static_cast<GLint>(format) && read_type == GL_UNSIGNED_BYTE;
}

}  // namespace

PlaneReadback::PlaneReadback(Plane plane, ImageSize picture, const TextureFormat& format)
    : size_(plane_size(picture, plane)),
      format_(format),
      drawn_(make_texture(size_, format, GL_NEAREST)),
      framebuffer_(make_framebuffer(drawn_)) {}

Result<PlaneReadback> PlaneReadback::create(Plane plane, ImageSize picture, int gles_version,
                                            Readback readback) {
  const bool is_packed = readback == Readback::packed;
  PlaneReadback made(plane, picture, is_packed ? kRgbaFormat : plane_format(plane, gles_version));
  if (!is_complete(made.framebuffer_)) return failed("gles: the driver cannot draw into a texture");
  if (!is_packed) {
    if (!can_read(made.format_.format)) return failed("gles: the driver reads back only RGBA");
    if (readback == Readback::buffered) made.buffer_.emplace();
    return made;
  }
  auto packer = PlanePacker::create(plane, kRgbaFormat.bytes_per_pixel);
  if (!packer) return tl::unexpected(packer.error());
  made.packed_ = Packed{std::move(*packer), {}, {}, {}};
  return made;
}

void PlaneReadback::begin(std::ptrdiff_t stride_bytes) {
  if (packed_) pack(stride_bytes);
  if (!buffer_) return;
  buffer_->fill(bytes_spanned(stride_bytes), [&] { read_pixels(stride_bytes, nullptr); });
}

Result<void> PlaneReadback::finish(MutablePlane output) {
  if (buffer_) return buffer_->copy_to(output.data, bytes_spanned(output.stride_bytes));
  read_pixels(output.stride_bytes, output.data);
  return {};
}

void PlaneReadback::pack(std::ptrdiff_t stride_bytes) {
  // As wide as the output's rows with their padding: then one call reads all of them.
  const ImageSize packed_size = {static_cast<int>(stride_bytes) / kRgbaFormat.bytes_per_pixel,
                                 size_.height};
  if (packed_->size != packed_size) {
    packed_->texture = make_texture(packed_size, kRgbaFormat, GL_NEAREST);
    packed_->framebuffer = make_framebuffer(packed_->texture);
    packed_->size = packed_size;
  }
  packed_->packer.pack(drawn_.name(), size_, packed_->framebuffer.name(), packed_size);
}

void PlaneReadback::read_pixels(std::ptrdiff_t stride_bytes, std::uint8_t* to) const {
  if (packed_) {
    glBindFramebuffer(GL_FRAMEBUFFER, packed_->framebuffer.name());
    glReadPixels(0, 0, packed_->size.width, packed_->size.height, GL_RGBA, GL_UNSIGNED_BYTE, to);
    return;
  }
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glPixelStorei(GL_PACK_ROW_LENGTH, static_cast<GLint>(stride_bytes / format_.bytes_per_pixel));
  glReadPixels(0, 0, size_.width, size_.height, format_.format, GL_UNSIGNED_BYTE, to);
  glPixelStorei(GL_PACK_ROW_LENGTH, 0);
}

/// From the first byte of the first row to the last byte of the last one.
std::size_t PlaneReadback::bytes_spanned(std::ptrdiff_t stride_bytes) const {
  const std::ptrdiff_t row_bytes = std::ptrdiff_t{size_.width} * format_.bytes_per_pixel;
  return static_cast<std::size_t>(stride_bytes * (size_.height - 1) + row_bytes);
}

}  // namespace gimbal
