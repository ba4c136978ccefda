// The rows of an area, for one instruction set: Highway's sources include this file once for each
// (hence no #pragma once).

#if defined(GIMBALD_TRAPEZOID_ROWS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GIMBALD_TRAPEZOID_ROWS_INL_HPP
#undef GIMBALD_TRAPEZOID_ROWS_INL_HPP
#else
#define GIMBALD_TRAPEZOID_ROWS_INL_HPP
#endif

#include <hwy/highway.h>

#include <span>

#include "pipeline/warp/trapezoid.hpp"

HWY_BEFORE_NAMESPACE();
namespace gimbal {
namespace HWY_NAMESPACE {
namespace {

/// As for_each_span, inlined, so that what `paint` keeps in registers stays there.
template <class Paint>
HWY_INLINE void for_each_row(std::span<const Trapezoid> area, int width, const Paint& paint) {
  for (Trapezoid rest : area) {
    for (; !rest.rows().empty(); rest.drop_rows(1)) {
      const Span span = rest.top(width);
      if (span.x_begin != span.x_end) paint(span);
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace gimbal
HWY_AFTER_NAMESPACE();

#endif  // the instruction set's own include guard
