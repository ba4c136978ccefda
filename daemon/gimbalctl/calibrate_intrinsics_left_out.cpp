#include "daemon/gimbalctl/calibrations.hpp"

namespace gimbal {

void add_calibrate_intrinsics(CLI::App& calibrate, CommandOutcome& outcome) {
  CLI::App* const command =
      calibrate.add_subcommand("intrinsics", "The lens from views of a board (not in this build)");
  command->allow_extras();
  command->callback([&outcome] {
    outcome = bad_input(
        "calibrate intrinsics: built without OpenCV; install libopencv-calib3d-dev, "
        "libopencv-imgproc-dev and libopencv-video-dev and build it again");
  });
}

}  // namespace gimbal
