#include "pipeline/warp/plane_format.hpp"

namespace gimbal {

TextureFormat plane_format(Plane plane, int gles_version) {
  if (gles_version >= 3) {
    return plane == Plane::luma ? TextureFormat{GL_R8, GL_RED, 1} : TextureFormat{GL_RG8, GL_RG, 2};
  }
  return plane == Plane::luma ? TextureFormat{GL_LUMINANCE, GL_LUMINANCE, 1}
                              : TextureFormat{GL_LUMINANCE_ALPHA, GL_LUMINANCE_ALPHA, 2};
}

TextureFormat rgb_format(int gles_version) {
  return {gles_version >= 3 ? GL_RGB8 : GL_RGB, GL_RGB, 3};
}

std::string texture_channels(int gles_version) {
  return gles_version >= 3 ? "rg" : "ra";
}

}  // namespace gimbal
