#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "daemon/gimbalctl/camera_options.hpp"
#include "daemon/gimbalctl/progress_bar.hpp"
#include "drivers/camera_source.hpp"
#include "pipeline/calibration/flashing_light.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

class GpioOutput;

/// Pictures that were taken while a light flashed, and how it did.
struct FlashRecording {
  std::vector<LineProfile> profiles;
  double light_hz = 0;        ///< as it was kept, by the clock of the changes
  double jitter_s = 0;        ///< standard deviation of the changes' times from even ones
  std::uint64_t skipped = 0;  ///< changes that were left out since they came too late
};

/// Flashes the light `hz` times a second while the camera delivers some seconds of pictures, rows
/// from the top. The light is off afterwards, also where the camera or the line fails; a signal
/// ends it early, which fails. bad_input for a frequency that no thread keeps.
[[nodiscard]] Result<FlashRecording> record_flashes(CameraSource& camera,
                                                    std::unique_ptr<GpioOutput> light, double hz,
                                                    ProgressStyle progress);

/// The same with a camera and a line, such as "gpiochip0:17", of a command line. bad_input where
/// the line cannot be had, which is told before the camera is opened, and where libgpiod was not
/// there to build with.
[[nodiscard]] Result<FlashRecording> record_flashes(const CameraOptions& camera,
                                                    const std::string& line, double hz,
                                                    ProgressStyle progress);

}  // namespace gimbal
