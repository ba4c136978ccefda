#include "pipeline/warp/native_input.hpp"

#include <cstddef>
#include <utility>

#include "pipeline/warp/plane_format.hpp"

namespace gimbal {
namespace {

constexpr std::array kPlanes = {Plane::luma, Plane::chroma};

/// A texture that holds a plane of the picture as it lies.
struct NativeTexture {
  ImageSize size;
  TextureFormat format;
  GLint filter;
};

/// A texel is a pixel; of 4:2:2 it has two bytes, and a group is whole even where the last pixel is
/// not.
std::vector<NativeTexture> textures_of(NativeFormat format, ImageSize picture, int gles_version) {
  const ImageSize chroma = chroma_size(picture);
  const TextureFormat byte = plane_format(Plane::luma, gles_version);
  const TextureFormat pair = plane_format(Plane::chroma, gles_version);
  switch (format) {
    case NativeFormat::i420:
      // Luma is drawn from as it is.
      return {{picture, byte, GL_LINEAR}, {chroma, byte, GL_NEAREST}, {chroma, byte, GL_NEAREST}};
    case NativeFormat::yuyv:
    case NativeFormat::uyvy:
      return {{{2 * chroma.width, picture.height}, pair, GL_NEAREST}};
    case NativeFormat::rgb:
    case NativeFormat::bgr:
      break;
  }
  return {{picture, rgb_format(gles_version), GL_NEAREST}};
}

}  // namespace

Result<NativeInput> NativeInput::create(NativeFormat format, ImageSize picture, int gles_version) {
  NativeInput made(format);
  for (const NativeTexture& texture : textures_of(format, picture, gles_version)) {
    made.uploads_.emplace_back(texture.size, texture.format, texture.filter, gles_version);
  }
  for (const Plane plane : kPlanes) {
    if (format == NativeFormat::i420 && plane == Plane::luma) continue;
    auto converter = PlaneConverter::create(format, plane, picture, gles_version,
                                            texture_channels(gles_version));
    if (!converter) return tl::unexpected(converter.error());
    made.converters_[static_cast<std::size_t>(plane)] = std::move(*converter);
  }
  return made;
}

std::array<GLuint, 2> NativeInput::bring(const std::array<ConstPlane, 3>& planes) {
  std::vector<GLuint> uploaded;
  for (std::size_t i = 0; i < uploads_.size(); ++i) {
    uploaded.push_back(uploads_[i].upload(planes[i]));
  }
  auto& [luma, chroma] = converters_;
  if (!luma) {
    return {uploaded[0], chroma->convert(std::span(uploaded).subspan(1), uploads_[1].size())};
  }
  return {luma->convert(uploaded, uploads_[0].size()),
          chroma->convert(uploaded, uploads_[0].size())};
}

std::int64_t NativeInput::bytes_per_picture() const {
  std::int64_t bytes = 0;
  for (const PlaneUpload& upload : uploads_) bytes += upload.bytes_per_picture();
  return bytes;
}

}  // namespace gimbal
