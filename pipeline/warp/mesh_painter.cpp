#include "pipeline/warp/mesh_painter.hpp"

#include <cstddef>
#include <utility>

#include "pipeline/warp/sample_grid.hpp"
#include "pipeline/warp/shaders.hpp"

namespace gimbal {
namespace {

static_assert(sizeof(MeshVertex) == 4 * sizeof(float), "read by GL as four floats");

template <typename T>
void fill_buffer(GLenum target, const GlBuffer& buffer, const std::vector<T>& contents) {
  glBindBuffer(target, buffer.name());
  glBufferData(target, static_cast<GLsizeiptr>(contents.size() * sizeof(T)), contents.data(),
               GL_STREAM_DRAW);
}

}  // namespace

MeshPainter::MeshPainter(Programs clamped, Programs mirrored)
    : clamped_(std::move(clamped)),
      mirrored_(std::move(mirrored)),
      vertices_(make_buffer()),
      triangles_(make_buffer()) {}

Result<MeshPainter> MeshPainter::create(const std::string& channels, Interpolation interpolation) {
  std::string defines = "#define CHANNELS " + channels + "\n";
  if (interpolation == Interpolation::bicubic) defines += "#define BICUBIC\n";
  auto clamped = make_programs(defines);
  if (!clamped) return tl::unexpected(clamped.error());
  auto mirrored = make_programs(defines + "#define MIRROR\n");
  if (!mirrored) return tl::unexpected(mirrored.error());
  return MeshPainter(std::move(*clamped), std::move(*mirrored));
}

Result<MeshPainter::Programs> MeshPainter::make_programs(const std::string& defines) {
  auto plain = make_program(shaders::kMeshVertex, shaders::kMeshFragment, defines);
  if (!plain) return tl::unexpected(plain.error());
  // GLES 2 promises no derivatives; without them the shader goes on with one sample a pixel.
  const std::string extension = "#extension GL_OES_standard_derivatives : enable\n";
  auto shrinking = make_program(shaders::kMeshVertex, shaders::kMeshFragment,
                                extension + "#define SHRINKING\n" + defines);
  if (!shrinking) return tl::unexpected(shrinking.error());
  return Programs{std::move(*plain), std::move(*shrinking)};
}

void MeshPainter::draw(const WarpMesh& mesh, const std::vector<MeshVertex>& vertices,
                       ImageSize source, ImageSize output) {
  const Programs& programs = mesh.border == Border::mirror ? mirrored_ : clamped_;
  const GlProgram& program = shrinks(mesh) ? programs.shrinking : programs.plain;
  glUseProgram(program.name());
  set_uniform(program, "picture_size", source);
  set_uniform(program, "source_size", source);
  set_uniform(program, "output_size", output);
  fill_buffer(GL_ARRAY_BUFFER, vertices_, vertices);
  fill_buffer(GL_ELEMENT_ARRAY_BUFFER, triangles_, mesh.triangles);
  set_attribute(program, "source_px", sizeof(MeshVertex), offsetof(MeshVertex, source_px));
  set_attribute(program, "output_px", sizeof(MeshVertex), offsetof(MeshVertex, output_px));
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(mesh.triangles.size()), GL_UNSIGNED_SHORT,
                 nullptr);
}

}  // namespace gimbal
