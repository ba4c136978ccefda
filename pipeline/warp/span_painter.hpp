#pragma once

#include <span>
#include <string>

#include "pipeline/warp/interpolation.hpp"
#include "pipeline/warp/plane_vertices.hpp"
#include "pipeline/warp/span.hpp"
#include "pipeline/warp/trapezoid.hpp"

namespace gimbal {

/// Draws samples of the source into the output, row by row of each trapezoid as far as it lies
/// within the output's width, all by one map (steps at most 2^14 pixels), with the widest vectors
/// that the processor has. Within one level of the exact value. Fastest while the map turns rows by
/// less than about 4 degrees.
void paint_area(Plane plane, Interpolation interpolation, const SourcePlane& source,
                const AffineMap& map, std::span<const Trapezoid> area, const OutputPlane& output);

/// The instruction set that this is done with here, such as "AVX2".
[[nodiscard]] std::string vector_instructions();

}  // namespace gimbal
