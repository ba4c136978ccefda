#include "daemon/gimbalctl/simulation.hpp"

#include <fmt/format.h>

#include <memory>

#include "daemon/gimbalctl/simulated_devices.hpp"
#include "daemon/gimbalctl/simulated_files.hpp"
#include "drivers/replay/session.hpp"

namespace gimbal {
Result<void> simulate(const SimulationOptions& options) {
  if (Result<void> checked = check(options); !checked) return checked;
  Result<Session> session = load_camera(options);
  if (!session) return tl::unexpected(session.error());
  const Result<Motion> made_motion = make_motion(options);
  if (!made_motion) return tl::unexpected(made_motion.error());
  const auto motion = std::make_shared<const Motion>(*made_motion);
  const auto camera = make_camera(options, *session->camera, motion);
  if (!camera) return tl::unexpected(camera.error());
  const auto imu = make_imu(options, session->imu, *motion);
  if (!imu) return tl::unexpected(imu.error());

  if (Result<void> made = make_session_folder(options.output); !made) return made;
  if (Result<void> written = write_video(**camera, options); !written) return written;
  session->folder = options.output;
  session->video = options.output / "video.mkv";
  session->quality = fmt::format("{}x{}@{:g}", session->camera->size.width,
                                 session->camera->size.height, session->camera->fps);
  for (std::size_t i = 0; i < (*camera)->frame_count(); ++i) {
    session->frames.push_back((*camera)->stamp(i));
  }
  session->gyro = (*imu)->gyro();
  session->accel = (*imu)->accel();
  session->notes = {fmt::format("Simulated by gimbalctl: motion {}, scene {}, seed {}.",
                                options.motion, options.scene, options.seed),
                    "truth.csv: q_world_imu at the gyroscope's stamps.",
                    "truth_rows.csv: q_world_camera in the middle of the exposure of lines."};
  if (Result<void> written = write_session(*session); !written) return written;
  return write_imu_truth(**imu, session->imu.R_camera_imu, *motion, options.output / "truth.csv")
      .and_then(
          [&] { return write_row_truth(**camera, *motion, options.output / "truth_rows.csv"); });
}

}  // namespace gimbal
