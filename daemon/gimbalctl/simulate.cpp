#include <CLI/CLI.hpp>
#include <memory>

#include "daemon/gimbalctl/commands.hpp"
#include "daemon/gimbalctl/simulation.hpp"

namespace gimbal {
namespace {

void add_motion_options(CLI::App& command, SimulationOptions& options) {
  command
      .add_option("--motion", options.motion,
                  "iphone (a real hand's), walk, run, pan, vehicle, tripod; or a session folder "
                  "whose gyroscope is followed")
      ->capture_default_str();
  command.add_option("--start", options.start_s, "Where in a recorded motion to begin, s")
      ->capture_default_str();
  command.add_option("--duration", options.duration_s, "s")->capture_default_str();
}

void add_camera_options(CLI::App& command, SimulationOptions& options) {
  command.add_option("--camera", options.camera, "session.toml with a [camera] table")
      ->capture_default_str();
  command.add_option("--size", options.size, "WIDTHxHEIGHT; the view stays as the camera has it");
  command.add_option("--fps", options.fps, "Frames a second");
  command.add_option("--readout", options.readout_ms, "First to one past the last row, ms");
  command.add_option("--readout-direction", options.readout_direction,
                     "top-down, bottom-up, left-right, right-left");
  command.add_option("--timestamp", options.timestamp,
                     "What stamps name: readout-start, exposure-start, readout-end");
  command.add_option("--time-offset", options.time_offset_ms,
                     "Added to frame stamps to get the IMU's clock, ms");
  command.add_option("--exposure", options.exposure_ms, "ms")->capture_default_str();
  command.add_option("--frame-jitter", options.frame_jitter_ms, "Of frame intervals, rms, ms")
      ->capture_default_str();
  command
      .add_option("--drop-frames", options.drop_share, "Share of frames that are lost, 0 to 0.9")
      ->capture_default_str();
  command
      .add_option("--full-well", options.full_well_electrons,
                  "Electrons of a white pixel: fewer, more noise; 0 for none")
      ->capture_default_str();
  command.add_option("--scene", options.scene, "street (made by code), or a picture to look at")
      ->capture_default_str();
}

void add_imu_options(CLI::App& command, SimulationOptions& options) {
  command.add_option("--gyro-rate", options.gyro_rate_hz, "Hz")->capture_default_str();
  command.add_option("--accel-rate", options.accel_rate_hz, "Hz")->capture_default_str();
  command.add_flag_callback(
      "--no-accel", [&options] { options.accel_rate_hz = 0; }, "No accelerometer");
  command.add_option("--gyro-noise", options.gyro_noise_rad_s, "White, rad/s/√Hz")
      ->capture_default_str();
  command.add_option("--accel-noise", options.accel_noise_m_s2, "White, m/s²/√Hz")
      ->capture_default_str();
  command.add_option("--gyro-bias", options.gyro_bias_rad_s, "X,Y,Z in IMU axes, rad/s")
      ->delimiter(',')
      ->capture_default_str();
}

}  // namespace

void add_simulate_command(CLI::App& app, CommandOutcome& outcome) {
  auto options = std::make_shared<SimulationOptions>();
  CLI::App* const command =
      app.add_subcommand("simulate", "Render a session whose every row's orientation is known");
  command->add_option("-o,--output", options->output, "New session folder")->required();
  add_motion_options(*command, *options);
  add_camera_options(*command, *options);
  add_imu_options(*command, *options);
  command->add_option("--seed", options->seed, "Another number, another recording")
      ->capture_default_str();
  command->add_flag("--quiet", options->quiet, "No progress bar");
  command->callback([options, &outcome] { outcome = simulate(*options); });
}

}  // namespace gimbal
