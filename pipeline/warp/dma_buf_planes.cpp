#include "pipeline/warp/dma_buf_planes.hpp"

#include <cstddef>
#include <utility>

#include "pipeline/warp/plane_format.hpp"

namespace gimbal {
namespace {

constexpr std::array kPlanes = {Plane::luma, Plane::chroma};

bool holds_pixels(PlaneView view, Plane plane) {
  return bytes_per_texel(view, plane) == bytes_per_texel(PlaneView::pixels, plane);
}

DmaBufTexels texels(PlaneView view, Plane plane, ImageSize size, const DmaBufPicture& picture) {
  const auto index = static_cast<std::size_t>(plane);
  return {picture.planes[index], picture.stride_bytes[index], texels_of(view, plane, size),
          bytes_per_texel(view, plane)};
}

}  // namespace

Result<DmaBufSources> DmaBufSources::create(PlaneView view, ImageSize picture, int gles_version) {
  DmaBufSources made(view, picture);
  for (const Plane plane : kPlanes) {
    if (holds_pixels(view, plane)) continue;
    auto unpacker =
        PlaneUnpacker::create(plane, picture, gles_version, bytes_per_texel(view, plane));
    if (!unpacker) return tl::unexpected(unpacker.error());
    made.unpackers_[static_cast<std::size_t>(plane)] = std::move(*unpacker);
  }
  return made;
}

Result<std::array<GLuint, 2>> DmaBufSources::textures(DmaBufTextures& imports,
                                                      const DmaBufPicture& picture) {
  std::array<GLuint, 2> textures{};
  for (const Plane plane : kPlanes) {
    const auto index = static_cast<std::size_t>(plane);
    auto& unpacker = unpackers_[index];
    const DmaBufTexels memory = texels(view_, plane, picture_, picture);
    const auto texture = imports.source(memory, unpacker ? GL_NEAREST : GL_LINEAR);
    if (!texture) return tl::unexpected(texture.error());
    textures[index] = unpacker ? unpacker->unpack(*texture, memory.size) : *texture;
  }
  return textures;
}

Result<DmaBufTargets> DmaBufTargets::create(PlaneView view, ImageSize picture, int gles_version) {
  DmaBufTargets made(view, picture);
  for (const Plane plane : kPlanes) {
    if (holds_pixels(view, plane)) continue;
    auto packer = PlanePacker::create(plane, bytes_per_texel(view, plane));
    if (!packer) return tl::unexpected(packer.error());
    const TextureFormat format =
        gles_version >= 3 ? plane_format(plane, gles_version) : kRgbaFormat;
    GlTexture drawn = make_texture(plane_size(picture, plane), format, GL_NEAREST);
    GlFramebuffer framebuffer = make_framebuffer(drawn);
    if (!is_complete(framebuffer)) return failed("gles: the driver cannot draw into a texture");
    made.detours_[static_cast<std::size_t>(plane)] =
        Detour{std::move(drawn), std::move(framebuffer), std::move(*packer)};
  }
  return made;
}

Result<std::array<GLuint, 2>> DmaBufTargets::framebuffers(DmaBufTextures& imports,
                                                          const DmaBufPicture& picture) {
  std::array<GLuint, 2> framebuffers{};
  for (const Plane plane : kPlanes) {
    const auto index = static_cast<std::size_t>(plane);
    const auto target = imports.target(texels(view_, plane, picture_, picture));
    if (!target) return tl::unexpected(target.error());
    framebuffers[index] = detours_[index] ? detours_[index]->framebuffer.name() : *target;
  }
  return framebuffers;
}

Result<void> DmaBufTargets::finish(DmaBufTextures& imports, const DmaBufPicture& picture) {
  for (const Plane plane : kPlanes) {
    auto& detour = detours_[static_cast<std::size_t>(plane)];
    if (!detour) continue;
    const DmaBufTexels memory = texels(view_, plane, picture_, picture);
    const auto target = imports.target(memory);
    if (!target) return tl::unexpected(target.error());
    detour->packer.pack(detour->drawn.name(), plane_size(picture_, plane), *target, memory.size);
  }
  return {};
}

}  // namespace gimbal
