#pragma once

#include <span>
#include <string>

#include "pipeline/warp/interpolation.hpp"
#include "pipeline/warp/plane_vertices.hpp"
#include "pipeline/warp/span.hpp"

namespace gimbal {

/// Draws samples of the source along spans of the output, all of one map (steps at most 2^14
/// pixels), with the widest vectors that the processor has. Within one level of the exact value.
/// Fastest where neighbouring spans come one after the other, and while the map turns rows by less
/// than about 4 degrees.
void paint_spans(Plane plane, Interpolation interpolation, const SourcePlane& source,
                 const AffineMap& map, std::span<const Span> spans, MutablePlane output);

/// The instruction set that this is done with here, such as "AVX2".
[[nodiscard]] std::string vector_instructions();

}  // namespace gimbal
