#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/intrinsics/board.hpp"
#include "pipeline/intrinsics/coverage.hpp"
#include "pipeline/intrinsics/lens_fit.hpp"

namespace gimbal {

/// How well one picture fits.
struct ViewError {
  std::string name;
  std::size_t corners = 0;
  double rms_px = 0;
};

/// A camera's lens, and whether to trust it.
struct Intrinsics {
  /// Why it is not to be trusted, in one line; empty if it is.
  std::string reason;
  std::optional<LensFit> fit;       ///< of the views that agree
  std::vector<BoardView> views;     ///< those
  std::vector<ViewError> errors;    ///< of those, in the same order
  std::vector<ViewError> left_out;  ///< views that contradict the others, the worst first
  Coverage coverage;                ///< by the views that agree
};

/// A lens of this model by views of a board. Views whose error is several times the
/// median are left out.
[[nodiscard]] Intrinsics calibrate_intrinsics(std::vector<BoardView> views, ImageSize size,
                                              LensModel model);

}  // namespace gimbal
