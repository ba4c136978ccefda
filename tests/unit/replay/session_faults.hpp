#pragma once

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "drivers/replay/session.hpp"
#include "tests/support/temporary_folder.hpp"

/// A good session, and ways to spoil it.
namespace gimbal::session_faults {

using Files = std::map<std::string, std::string>;

inline std::string gyro_csv(int first, int count, double factor = 1.0) {
  std::string text = "t_s,x,y,z\n";
  for (int i = first; i < first + count; ++i) {
    text += fmt::format("{},0.25,-0.5,{}\n", i * 0.01 * factor, i * 0.001);
  }
  return text;
}

inline std::string accel_csv(int first, int count) {
  std::string text = "t_s,x,y,z\n";
  for (int i = first; i < first + count; ++i) text += fmt::format("{},0,9.81,0\n", i * 0.01);
  return text;
}

inline std::string frames_csv(int count, double factor = 1.0) {
  std::string text = "index,t_s\n";
  for (int i = 0; i < count; ++i) text += fmt::format("{},{}\n", i, (0.5 + i / 30.0) * factor);
  return text;
}

/// Two seconds at 100 Hz, with thirty frames in the middle; nothing is odd about it.
inline Files good_session() {
  return {{"session.toml",
           "device = \"phone\"\n"
           "recorded_at = \"2021-07-29T03:52:25Z\"\n"
           "[camera]\n"
           "width = 640\n"
           "height = 480\n"
           "fps = 30.0\n"
           "K = [[500.0, 0, 320], [0, 500, 240], [0, 0, 1]]\n"
           "readout_s = 0.03\n"
           "[imu]\n"
           "R_camera_imu = [[0, -1, 0], [-1, 0, 0], [0, 0, -1]]\n"},
          {"gyro.csv", gyro_csv(0, 200)},
          {"accel.csv", accel_csv(0, 200)},
          {"frames.csv", frames_csv(30)},
          {"video.mkv", "not looked at here"}};
}

inline Result<Session> open(const Files& files) {
  const test::TemporaryFolder folder;
  for (const auto& [name, content] : files) folder.write(name, content);
  return open_session(folder.path());
}

inline void replace(std::string& text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
}

struct Fault {
  std::string name;
  std::function<void(Files&)> spoil;
  std::vector<std::string> said;  ///< in the error, or in one of the warnings
};

inline void PrintTo(const Fault& fault, std::ostream* out) {
  *out << fault.name;
}

inline void toml(Files& files, const std::string& from, const std::string& to) {
  replace(files["session.toml"], from, to);
}

/// Spoils the session.toml at one place.
inline std::function<void(Files&)> in_toml(const std::string& from, const std::string& to) {
  return [=](Files& files) { toml(files, from, to); };
}

inline std::function<void(Files&)> in_file(const std::string& name, const std::string& from,
                                           const std::string& to) {
  return [=](Files& files) { replace(files[name], from, to); };
}

inline std::function<void(Files&)> instead(const std::string& name, const std::string& content) {
  return [=](Files& files) { files[name] = content; };
}

inline std::string name_of(const ::testing::TestParamInfo<Fault>& parameter) {
  return parameter.param.name;
}

}  // namespace gimbal::session_faults
