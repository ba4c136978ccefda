#include "daemon/gimbalctl/flash_recording.hpp"

namespace gimbal {

Result<FlashRecording> record_flashes(const CameraOptions& /*camera*/, const std::string& /*line*/,
                                      double /*hz*/, ProgressStyle /*progress*/) {
  return bad_input(
      "--gpio: built without libgpiod; install libgpiod-dev and build it again, or record a "
      "session "
      "while something else flashes the light");
}

}  // namespace gimbal
