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
  const bool is_direct = readback == Readback::direct;
  PlaneReadback made(plane, picture, is_direct ? plane_format(plane, gles_version) : kRgbaFormat);
  if (!is_complete(made.framebuffer_)) return failed("gles: the driver cannot draw into a texture");
  if (is_direct) {
    if (!can_read(made.format_.format)) return failed("gles: the driver reads back only RGBA");
    return made;
  }
  auto packer = PlanePacker::create(plane, kRgbaFormat.bytes_per_pixel);
  if (!packer) return tl::unexpected(packer.error());
  made.packer_ = std::move(*packer);
  return made;
}

void PlaneReadback::read(MutablePlane output) {
  if (packer_) {
    packer_->read(drawn_, size_, output);
  } else {
    read_directly(output);
  }
}

void PlaneReadback::read_directly(MutablePlane output) {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glPixelStorei(GL_PACK_ROW_LENGTH,
                static_cast<GLint>(output.stride_bytes / format_.bytes_per_pixel));
  glReadPixels(0, 0, size_.width, size_.height, format_.format, GL_UNSIGNED_BYTE, output.data);
  glPixelStorei(GL_PACK_ROW_LENGTH, 0);
}

}  // namespace gimbal
