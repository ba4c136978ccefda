#include "pipeline/warp/packed_import.hpp"

#include <utility>

#include "pipeline/warp/plane_format.hpp"

namespace gimbal {
namespace {

constexpr std::array kPlanes = {Plane::luma, Plane::chroma};
constexpr int kBytesPerPair = 2;

/// The picture whose plane of chroma has as many pairs.
ImageSize picture_of(ImageSize pairs) {
  return {2 * pairs.width, 2 * pairs.height};
}

}  // namespace

/// Of two bytes each: a pixel's luma, and U or V.
ImageSize PackedImport::pairs() const {
  return {2 * chroma_size(layout_.size).width, layout_.size.height};
}

Result<PackedImport> PackedImport::create(PlaneView view, const PackedLayout& layout,
                                          int gles_version) {
  PackedImport made(view, layout);
  if (view == PlaneView::packed) {
    auto unpacker = PlaneUnpacker::create(Plane::chroma, picture_of(made.pairs()), gles_version,
                                          bytes_per_texel(view, Plane::chroma));
    if (!unpacker) return tl::unexpected(unpacker.error());
    made.unpacker_ = std::move(*unpacker);
  }
  for (const Plane plane : kPlanes) {
    auto converter =
        PlaneConverter::create(layout.format, plane, layout.size, gles_version, kImportedChannels);
    if (!converter) return tl::unexpected(converter.error());
    made.converters_[static_cast<std::size_t>(plane)] = std::move(*converter);
  }
  return made;
}

Result<std::array<GLuint, 2>> PackedImport::textures(DmaBufTextures& imports,
                                                     const DmaBufPlane& place) {
  const ImageSize pairs = this->pairs();
  const int bytes = bytes_per_texel(view_, Plane::chroma);
  const ImageSize texels = {pairs.width * kBytesPerPair / bytes, pairs.height};
  const auto texture = imports.source({place, layout_.stride_bytes, texels, bytes}, GL_NEAREST);
  if (!texture) return tl::unexpected(texture.error());
  const std::array<GLuint, 1> source = {unpacker_ ? unpacker_->unpack(*texture, texels) : *texture};
  return std::array<GLuint, 2>{converters_[0]->convert(source, pairs),
                               converters_[1]->convert(source, pairs)};
}

}  // namespace gimbal
