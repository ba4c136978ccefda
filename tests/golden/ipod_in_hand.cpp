#include "tests/golden/ipod_in_hand.hpp"

#include <filesystem>
#include <stdexcept>

#include "drivers/replay/session.hpp"
#include "drivers/synthetic/recorded_motion.hpp"

namespace gimbal::test {

CameraCalibration ipod_touch() {
  CameraCalibration camera;
  camera.size = {1280, 720};
  camera.fps = 30;
  camera.lens.K << 1223.0, 0, 650.4, 0, 1217.5, 345.3, 0, 0, 1;  // thesis (2.6)
  camera.readout = std::chrono::milliseconds(30);
  return camera;
}

ImuCalibration phone_axes() {
  ImuCalibration imu;
  imu.R_camera_imu << 0, -1, 0, -1, 0, 0, 0, 0, -1;
  return imu;
}

Motion hand_motion(double start_s, double duration_s) {
  const auto session = open_session(std::filesystem::path(GIMBALD_MOTIONS) / "iphone-handheld");
  if (!session) throw std::runtime_error(session.error().message);
  auto motion =
      make_recorded_motion({session->gyro, session->accel, phone_axes().R_camera_imu},
                           duration_from_seconds(start_s), duration_from_seconds(duration_s));
  if (!motion) throw std::runtime_error(motion.error().message);
  return *motion;
}

}  // namespace gimbal::test
