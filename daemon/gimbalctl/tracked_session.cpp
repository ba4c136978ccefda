#include "daemon/gimbalctl/tracked_session.hpp"

#include <cstdint>
#include <utility>

#include "daemon/gimbalctl/warnings.hpp"
#include "drivers/replay/replay_camera.hpp"
#include "drivers/replay/stamped_log.hpp"
#include "pipeline/sync/feature_tracker.hpp"

namespace gimbal {
namespace {

/// A calibration's nominal rate may be missing or wrong; stamps tell.
double rate_of(const std::vector<FrameStamp>& frames) {
  const double step_s = to_seconds(median_step(frames));
  return step_s > 0 ? 1 / step_s : 30;
}

}  // namespace

Result<JointData> track_session(const Session& session, ProgressStyle progress) {
  if (session.video.empty()) return bad_input(session.folder.string() + ": there is no video");
  if (!session.camera) {
    return bad_input(session.folder.string() +
                     ": session.toml needs K under [camera], to within 10 %");
  }
  JointData data;
  data.camera = *session.camera;
  data.camera.fps = rate_of(session.frames);
  data.gyro = session.gyro;
  const SensorDuration delay = session.imu.delay.value_or(SensorDuration::zero());
  for (GyroSample& sample : data.gyro) sample.time -= delay;

  ReplayCamera camera(session.video, session.frames, data.camera.fps);
  if (auto started = camera.start(); !started) return tl::unexpected(started.error());
  FeatureTracker tracker;
  ProgressBar bar("track", static_cast<std::int64_t>(session.frames.size()), progress);
  while (true) {
    const auto frame = camera.read();
    if (!frame) return tl::unexpected(frame.error());
    if (!*frame) break;
    tracker.push(**frame);
    data.frames.push_back((*frame)->stamp);
    bar.advance();
  }
  print_warnings(camera.warnings());
  data.tracks = tracker.take();
  return data;
}

}  // namespace gimbal
