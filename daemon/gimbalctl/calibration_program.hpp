#pragma once

namespace gimbal {

/// Turns into the program of the commands that need OpenCV or Ceres, if the arguments are for one
/// of these and it is there: it lies beside this program where both were built, and in libexec
/// where they are installed. Else returns, and these commands say what is missing.
void become_calibration_program(int argc, char** argv);

}  // namespace gimbal
