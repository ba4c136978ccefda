#include "pipeline/warp/readback_probe.hpp"

#include <cstdlib>

namespace gimbal {
namespace {

constexpr ImageSize kProbeSize{13, 6};  // odd, and no multiple of what is packed into a texel

int row_bytes(Plane plane) {
  return plane == Plane::luma ? kProbeSize.width : 2 * chroma_size(kProbeSize).width;
}

/// A byte that tells its place: all of a plane differ, and so do neighbours by more than rounding.
std::uint8_t pattern_at(int x, int y) {
  return static_cast<std::uint8_t>(3 * x + 41 * y + 5);
}

MutablePlane plane_of(const Nv12Buffer& picture, Plane plane) {
  return plane == Plane::luma ? picture.luma() : picture.chroma();
}

void fill_with_pattern(const Nv12Buffer& picture, Plane plane) {
  const MutablePlane memory = plane_of(picture, plane);
  for (int y = 0; y < plane_size(kProbeSize, plane).height; ++y) {
    std::uint8_t* row = memory.data + y * memory.stride_bytes;
    for (int x = 0; x < row_bytes(plane); ++x) row[x] = pattern_at(x, y);
  }
}

bool shows_pattern(const Nv12Buffer& picture, Plane plane) {
  const MutablePlane memory = plane_of(picture, plane);
  for (int y = 0; y < plane_size(kProbeSize, plane).height; ++y) {
    const std::uint8_t* row = memory.data + y * memory.stride_bytes;
    for (int x = 0; x < row_bytes(plane); ++x) {
      if (std::abs(row[x] - pattern_at(x, y)) > 1) return false;
    }
  }
  return true;
}

/// One cell that leaves every pixel where it is.
WarpMesh identity_mesh() {
  WarpMesh mesh;
  mesh.source_size = kProbeSize;
  mesh.output_size = kProbeSize;
  mesh.vertex_columns = 2;
  mesh.vertex_rows = 2;
  const float right = static_cast<float>(kProbeSize.width) - 0.5F;
  const float bottom = static_cast<float>(kProbeSize.height) - 0.5F;
  for (const float y : {-0.5F, bottom}) {
    for (const float x : {-0.5F, right}) mesh.vertices.push_back({{x, y}, {x, y}});
  }
  mesh.triangles = {0, 1, 2, 1, 3, 2};
  return mesh;
}

/// What an unusable format left behind must not be laid to the next drawing. A lost context reports
/// errors without end.
void forget_errors() {
  for (int i = 0; i < 8 && glGetError() != GL_NO_ERROR; ++i) {
  }
}

bool draws_pattern(MeshPainter& painter, Plane plane, int gles_version, Readback readback) {
  auto drawn = GlesPlane::create(plane, kProbeSize, kProbeSize, gles_version, readback);
  if (!drawn) return false;
  const Nv12Buffer picture(kProbeSize);
  fill_with_pattern(picture, plane);
  const MutablePlane source = plane_of(picture, plane);
  drawn->upload({source.data, source.stride_bytes});
  drawn->draw(painter, identity_mesh(), ChromaSiting::left, {0, 0});
  const Nv12Buffer result(kProbeSize);
  drawn->read(plane_of(result, plane));
  return glGetError() == GL_NO_ERROR && shows_pattern(result, plane);
}

}  // namespace

Result<Readback> choose_readback(MeshPainter& painter, int gles_version) {
  for (const Readback readback : {Readback::direct, Readback::packed}) {
    if (readback == Readback::direct && gles_version < 3) continue;
    const bool works = draws_pattern(painter, Plane::luma, gles_version, readback) &&
                       draws_pattern(painter, Plane::chroma, gles_version, readback);
    forget_errors();
    if (works) return readback;
  }
  return failed(
      "gles: the driver does not give a test picture back as it was drawn; update the driver or "
      "use "
      "the cpu warper");
}

}  // namespace gimbal
