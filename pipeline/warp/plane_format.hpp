#pragma once

#include <string>

#include "pipeline/warp/gl_objects.hpp"
#include "pipeline/warp/plane_vertices.hpp"

namespace gimbal {

inline constexpr TextureFormat kRgbaFormat = {GL_RGBA, GL_RGBA, 4};

/// How a plane lies in a texture, a texel a pixel, in this version of GLES.
[[nodiscard]] TextureFormat plane_format(Plane plane, int gles_version);

/// Three bytes a texel.
[[nodiscard]] TextureFormat rgb_format(int gles_version);

/// Where textures of plane_format have their two values: GLES 2 has luminance and alpha.
[[nodiscard]] std::string texture_channels(int gles_version);

/// Where a plane has them that was imported, or unpacked from a texture that was.
inline constexpr const char* kImportedChannels = "rg";

}  // namespace gimbal
