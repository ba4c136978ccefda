#include "pipeline/warp/plane_upload.hpp"

#include <cstddef>
#include <cstring>

namespace gimbal {

PlaneUpload::PlaneUpload(Plane plane, ImageSize picture, int gles_version)
    : PlaneUpload(plane_size(picture, plane), plane_format(plane, gles_version), GL_LINEAR,
                  gles_version) {}

PlaneUpload::PlaneUpload(ImageSize size, const TextureFormat& format, GLint filter,
                         int gles_version)
    : gles_version_(gles_version),
      size_(size),
      format_(format),
      filter_(filter) {}

GLuint PlaneUpload::upload(ConstPlane source) {
  GlTexture& texture = textures_[next_];
  next_ = (next_ + 1) % textures_.size();
  if (texture.name() == 0) texture = make_texture(size_, format_, filter_);
  glBindTexture(GL_TEXTURE_2D, texture.name());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  put(source);
  return texture.name();
}

void PlaneUpload::put(ConstPlane source) {
  const auto put_rows = [&](const void* pixels) {
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, size_.width, size_.height, format_.format,
                    GL_UNSIGNED_BYTE, pixels);
  };
  const std::ptrdiff_t row_bytes = std::ptrdiff_t{size_.width} * format_.bytes_per_pixel;
  if (source.stride_bytes == row_bytes) return put_rows(source.data);
  if (gles_version_ >= 3 && source.stride_bytes > row_bytes &&
      source.stride_bytes % format_.bytes_per_pixel == 0) {
    const auto row_pixels = static_cast<GLint>(source.stride_bytes / format_.bytes_per_pixel);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, row_pixels);
    put_rows(source.data);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
    return;
  }
  rows_.resize(static_cast<std::size_t>(row_bytes * size_.height));
  for (int y = 0; y < size_.height; ++y) {
    std::memcpy(rows_.data() + y * row_bytes, source.data + y * source.stride_bytes,
                static_cast<std::size_t>(row_bytes));
  }
  put_rows(rows_.data());
}

}  // namespace gimbal
