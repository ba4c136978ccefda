#pragma once

#include <filesystem>
#include <string>

#include "daemon/gimbalctl/svg_plot.hpp"
#include "pipeline/sample/calibration.hpp"
#include "pipeline/sync/synchronization.hpp"

namespace gimbal {

/// For people: a line each for what was found, with twice its standard deviation, and one at the
/// end that says whether to trust it.
[[nodiscard]] std::string describe(const Synchronization& found, const CameraCalibration& camera);

/// For programs, see gimbalctl(1). What is not known is null.
[[nodiscard]] std::string to_json(const Synchronization& found, const CameraCalibration& camera);

/// J(t_d): figure 2.4 of the thesis.
[[nodiscard]] Plot offset_plot(const Synchronization& found);

}  // namespace gimbal
