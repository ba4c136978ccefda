#include "daemon/gimbalctl/live_status.hpp"

#include <fmt/format.h>

#include <map>
#include <string_view>
#include <vector>

namespace gimbal {
namespace {

using Json = nlohmann::ordered_json;

/// The value at a path such as "/frames/in", or what stands for it.
template <typename T>
T at(const Json& json, const char* path, T otherwise) {
  const Json::json_pointer pointer(path);
  if (!json.contains(pointer) || json[pointer].is_null()) return otherwise;
  try {
    return json[pointer].get<T>();
  } catch (const Json::exception&) {
    return otherwise;
  }
}

std::string text_at(const Json& json, const char* path) {
  return at<std::string>(json, path, "");
}

std::uint64_t count_at(const Json& json, const char* path) {
  return at<std::uint64_t>(json, path, 0);
}

double number_at(const Json& json, const char* path) {
  return at<double>(json, path, 0);
}

std::string line(std::string_view title, const std::string& text) {
  return fmt::format("{:<13}{}\n", title, text);
}

std::string state_for_people(const Json& status) {
  static const std::map<std::string, const char*> kStates = {
      {"no-camera", "no camera: the stream shows a picture that says so"},
      {"no-imu", "no IMU"},
      {"passing-through", "no samples come: pictures pass through as the camera takes them"},
      {"imu-too-slow",
       "the IMU delivers fewer than two samples while a picture is read out: raise its rate"},
      {"implausible-samples", "the samples are not plausible"},
      {"output-failed", "an output has failed"},
      {"recording-failed", "the last recording ended by itself"}};
  std::vector<std::string> states;
  if (status.contains("degraded")) {
    for (const Json& state : status["degraded"]) {
      const auto known = kStates.find(state.get<std::string>());
      states.push_back(known != kStates.end() ? known->second : state.get<std::string>());
    }
  }
  return states.empty() ? "all is well" : fmt::format("{}", fmt::join(states, "; "));
}

std::string source_for_people(const Json& source, const std::string& well) {
  const std::string obstacle = text_at(source, "/obstacle");
  std::string text = obstacle.empty() ? well : "does not deliver: " + obstacle;
  if (const auto restarts = count_at(source, "/restarts")) {
    text += fmt::format("; brought back {} times", restarts);
  }
  if (const auto lost = count_at(source, "/lost")) text += fmt::format("; {} lost", lost);
  return text;
}

std::string orientation_for_people(const Json& status) {
  if (!status.contains("orientation") || status["orientation"].is_null()) return "not known yet";
  return fmt::format("{:.1f} deg up, rolled {:.1f} deg clockwise, heading {:.1f} deg",
                     number_at(status, "/orientation/degrees/elevation"),
                     number_at(status, "/orientation/degrees/roll"),
                     number_at(status, "/orientation/degrees/heading"));
}

std::string time_offset_for_people(const Json& offset) {
  std::string text = fmt::format("{:.1f} ms in use", 1e3 * number_at(offset, "/in_use_s"));
  const std::string verdict = text_at(offset, "/verdict");
  if (verdict.empty()) return text;
  if (verdict != "ok") return text + "; cannot be told at present";
  return text + fmt::format("; tracked: {:.2f} ms ± {:.2f}, {:+.1f} ms a minute",
                            1e3 * number_at(offset, "/time_offset_s"),
                            1e3 * number_at(offset, "/time_offset_sigma_s"),
                            1e3 * number_at(offset, "/drift_s_per_min"));
}

std::string frames_for_people(const Json& status) {
  std::string text =
      fmt::format("{} in, {} out", count_at(status, "/frames/in"), count_at(status, "/frames/out"));
  const auto add = [&](const char* path, const char* cause) {
    if (const auto count = count_at(status, path)) text += fmt::format("; {} {}", count, cause);
  };
  add("/frames/dropped/no_orientation", "dropped for want of orientation");
  add("/frames/dropped/before_drawing", "dropped because drawing is too slow");
  add("/frames/dropped/out_of_order", "dropped because they came out of order");
  add("/frames/dropped/off_clock", "dropped because their stamps are ahead of time");
  add("/frames/no_signal", "pictures that say \"no signal\"");
  return text;
}

std::string recording_for_people(const Json& recording) {
  const std::string folder = text_at(recording, "/folder");
  if (folder.empty()) return "none";
  std::string text = fmt::format(
      "{}{}: {} frames, {} samples", at<bool>(recording, "/is_recording", false) ? "" : "ended, ",
      folder, count_at(recording, "/frames"), count_at(recording, "/samples"));
  if (const auto dropped = count_at(recording, "/frames_dropped")) {
    text += fmt::format(", {} frames dropped", dropped);
  }
  const std::string failure = text_at(recording, "/failure");
  return failure.empty() ? text : text + "; " + failure;
}

std::string output_for_people(const Json& output) {
  std::string text =
      fmt::format("{}: {} frames", text_at(output, "/name"), count_at(output, "/written"));
  if (const auto dropped = count_at(output, "/dropped"))
    text += fmt::format(", {} dropped", dropped);
  if (const auto state = text_at(output, "/state"); state != "working") text += "; " + state;
  return text;
}

}  // namespace

std::string settings_for_people(const Json& settings) {
  std::vector<std::string> all;
  for (const auto& [key, value] : settings.items()) {
    all.push_back(
        fmt::format("{} {}", key, value.is_string() ? value.get<std::string>() : value.dump()));
  }
  return line("settings", fmt::format("{}", fmt::join(all, ", ")));
}

std::string status_for_people(const Json& status) {
  const Json none = Json::object();
  const auto part = [&](const char* key) { return status.contains(key) ? status[key] : none; };
  const Json camera = part("camera");
  std::string text = line("state", state_for_people(status));
  text += line("camera",
               source_for_people(
                   camera, fmt::format("{}x{} at {:.4g} fps", count_at(camera, "/width"),
                                       count_at(camera, "/height"), number_at(camera, "/fps"))));
  const Json imu = part("imu");
  text += line(
      "IMU", source_for_people(imu, fmt::format("{} samples, {:.1f} Hz", count_at(imu, "/samples"),
                                                number_at(imu, "/rate_hz"))));
  if (const auto off = count_at(imu, "/samples_off_clock")) {
    text += line("", fmt::format("{} samples left out: stamps far from CLOCK_MONOTONIC", off));
  }
  for (const Json& remark : at<Json>(imu, "/remarks", Json::array())) {
    text += line("", remark.get<std::string>());
  }
  if (const auto suspicion = text_at(status, "/suspicion"); !suspicion.empty()) {
    text += line("", suspicion);
  }
  text += line("orientation", orientation_for_people(status));
  text += line("time offset", time_offset_for_people(part("time_offset")));
  text += line("frames", frames_for_people(status));
  text += line("age", fmt::format("{:.1f} ms when drawn (median), {:.1f} ms (99 %)",
                                  1e3 * number_at(status, "/age_s/median"),
                                  1e3 * number_at(status, "/age_s/p99")));
  text += line("drawn by", text_at(status, "/renderer"));
  if (const auto transfers = text_at(status, "/transfers"); !transfers.empty()) {
    text += line("pictures", transfers);
  }
  text += settings_for_people(part("settings"));
  for (const Json& output : part("outputs")) text += line("output", output_for_people(output));
  text += line("recording", recording_for_people(part("recording")));
  return text;
}

std::string recording_line(const Json& recording) {
  return line("recording", recording_for_people(recording));
}

std::string reload_for_people(const Json& report) {
  const auto list = [&](const char* key) {
    std::vector<std::string> keys;
    if (report.contains(key)) keys = report[key].get<std::vector<std::string>>();
    return keys.empty() ? std::string("nothing") : fmt::format("{}", fmt::join(keys, ", "));
  };
  return line("changed", list("applied")) + line("at restart", list("at_next_start"));
}

}  // namespace gimbal
