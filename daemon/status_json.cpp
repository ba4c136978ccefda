#include "daemon/status_json.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

namespace gimbal {
namespace {

using Json = nlohmann::ordered_json;

Json as_json(const SourceStatus& source) {
  return {{"delivers", source.obstacle.empty()},
          {"obstacle", source.obstacle.empty() ? Json(nullptr) : Json(source.obstacle)},
          {"restarts", source.restarts},
          {"lost", source.lost}};
}

Json as_json(const Eigen::Quaterniond& q) {
  return Json::array({q.w(), q.x(), q.y(), q.z()});
}

double in_degrees(double rad) {
  return rad * 180 / std::numbers::pi;
}

/// Where the camera looks, for people: how far up, how far turned about the line of sight, and
/// which way round, from where it looked at the start. World z is up; the camera's axes are x
/// right, y down, z forward.
Json angles_as_json(const Eigen::Quaterniond& q_world_camera) {
  const Eigen::Matrix3d R = q_world_camera.toRotationMatrix();
  const Eigen::Vector3d forward = R.col(2);
  const double up = std::clamp(forward.z(), -1.0, 1.0);
  // The camera's right side and its upper side, seen against the vertical.
  return {{"heading", in_degrees(std::atan2(forward.y(), forward.x()))},
          {"elevation", in_degrees(std::asin(up))},
          {"roll", in_degrees(std::atan2(-R(2, 0), -R(2, 1)))}};
}

Json as_json(const CameraAttitude& attitude, const ImuCalibration& imu) {
  const Eigen::Quaterniond q_world_imu =
      attitude.q_world_camera * Eigen::Quaterniond(imu.R_camera_imu);
  return {{"t_s", seconds_since_epoch(attitude.time)},
          {"q_world_camera", as_json(attitude.q_world_camera)},
          {"q_world_imu", as_json(q_world_imu)},
          {"degrees", angles_as_json(attitude.q_world_camera)}};
}

Json as_json(const LiveCounts& counts) {
  return {{"in", counts.frames_in},
          {"out", counts.frames_out},
          {"dropped",
           {{"no_orientation", counts.dropped_without_orientation},
            {"before_drawing", counts.dropped_before_drawing},
            {"out_of_order", counts.dropped_out_of_order},
            {"off_clock", counts.dropped_off_clock}}},
          {"no_signal", counts.no_signal_pictures}};
}

/// `verdict` in the words of gimbalctl sync; null where the offset is not tracked.
Json time_offset_as_json(const LiveStatus& status) {
  Json json = {{"in_use_s", to_seconds(status.time_offset)},
               {"verdict", nullptr},
               {"time_offset_s", nullptr},
               {"time_offset_sigma_s", nullptr},
               {"drift_s_per_min", nullptr}};
  if (!status.tracked_offset) return json;
  const OffsetEstimate& estimate = status.tracked_offset->estimate;
  json["verdict"] = estimate.is_known ? "ok" : "cannot-tell";
  json["time_offset_s"] = to_seconds(estimate.offset);
  json["time_offset_sigma_s"] = to_seconds(estimate.sigma);
  json["drift_s_per_min"] = 60 * estimate.drift;
  return json;
}

const char* word_for(OutputState state) {
  switch (state) {
    case OutputState::starting:
      return "starting";
    case OutputState::working:
      return "working";
    case OutputState::failed:
      return "failed";
  }
  return "";
}

Json outputs_as_json(const LivePipeline& pipeline) {
  Json outputs = Json::array();
  for (const auto& output : pipeline.outputs()) {
    outputs.push_back({{"name", output->name()},
                       {"written", output->written()},
                       {"dropped", output->dropped()},
                       {"state", word_for(output->state())}});
  }
  return outputs;
}

/// With fewer than two samples while a picture is read out, what happens between its rows is not
/// seen.
bool is_too_slow(double gyro_rate_hz, SensorDuration readout) {
  constexpr double kFewest = 2;
  return gyro_rate_hz > 0 && gyro_rate_hz * to_seconds(readout) < kFewest;
}

Json degraded(const LiveStatus& status, const Supervisor& daemon) {
  const LivePipeline& pipeline = daemon.pipeline();
  Json states = Json::array();
  if (!status.camera.obstacle.empty()) states.emplace_back("no-camera");
  if (!status.imu.obstacle.empty()) states.emplace_back("no-imu");
  if (status.is_coasting) states.emplace_back("passing-through");
  if (is_too_slow(status.gyro_rate_hz, pipeline.calibration().readout)) {
    states.emplace_back("imu-too-slow");
  }
  if (!status.suspicion.empty()) states.emplace_back("implausible-samples");
  if (std::ranges::any_of(pipeline.outputs(),
                          [](const auto& o) { return o->state() == OutputState::failed; })) {
    states.emplace_back("output-failed");
  }
  if (!daemon.recorder().status().failure.empty()) states.emplace_back("recording-failed");
  return states;
}

Json limits_as_json(const std::optional<ZoomLimits>& limits) {
  return limits ? Json{limits->least, limits->most} : Json(nullptr);
}

}  // namespace

Json recording_as_json(const RecordingStatus& recording) {
  return {{"is_recording", recording.is_recording},
          {"folder", recording.folder.empty() ? Json(nullptr) : Json(recording.folder.string())},
          {"frames", recording.frames},
          {"frames_dropped", recording.frames_dropped},
          {"samples", recording.samples},
          {"samples_dropped", recording.samples_dropped},
          {"failure", recording.failure.empty() ? Json(nullptr) : Json(recording.failure)}};
}

Json live_settings_as_json(const StabilizationSettings& settings) {
  return {{"amount", settings.amount},
          {"path", name_of(settings.path, path_names())},
          {"latency_frames", settings.latency ? Json(*settings.latency) : Json(nullptr)},
          {"zoom", settings.zoom ? Json(*settings.zoom) : Json("auto")},
          {"zoom_limits", limits_as_json(settings.zoom_limits)},
          {"zoom_speed_per_s",
           settings.zoom_speed_per_s ? Json(*settings.zoom_speed_per_s) : Json(nullptr)},
          {"border", name_of(settings.border, border_names())},
          {"horizon", name_of(settings.lock.horizon, horizon_names())},
          {"horizon_range_deg", settings.lock.most_roll_rad * 180 / std::numbers::pi}};
}

Json status_as_json(const Supervisor& daemon) {
  const LivePipeline& pipeline = daemon.pipeline();
  const LiveStatus status = pipeline.status();
  const CameraCalibration& calibration = pipeline.calibration();
  Json camera = as_json(status.camera);
  camera["width"] = calibration.size.width;
  camera["height"] = calibration.size.height;
  camera["fps"] = calibration.fps;
  camera["readout_s"] = to_seconds(calibration.readout);
  Json imu = as_json(status.imu);
  imu["samples"] = status.counts.samples;
  imu["rate_hz"] = status.gyro_rate_hz > 0 ? Json(status.gyro_rate_hz) : Json(nullptr);
  imu["samples_off_clock"] = status.counts.samples_off_clock;
  imu["remarks"] = status.imu.remarks;
  const std::string transfers = pipeline.transfers();
  return {
      {"version", GIMBALD_VERSION},
      {"degraded", degraded(status, daemon)},
      {"camera", camera},
      {"imu", imu},
      {"orientation",
       status.attitude ? as_json(*status.attitude, pipeline.imu_calibration()) : Json(nullptr)},
      {"suspicion", status.suspicion.empty() ? Json(nullptr) : Json(status.suspicion)},
      {"time_offset", time_offset_as_json(status)},
      {"frames", as_json(status.counts)},
      {"age_s", {{"median", to_seconds(status.age.median)}, {"p99", to_seconds(status.age.p99)}}},
      {"renderer", pipeline.renderer()},
      {"transfers", transfers.empty() ? Json(nullptr) : Json(transfers)},
      {"settings", live_settings_as_json(daemon.settings())},
      {"outputs", outputs_as_json(pipeline)},
      {"recording", recording_as_json(daemon.recorder().status())},
  };
}

}  // namespace gimbal
