// What a running daemon records, held against what it saw: a recording that is played to it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "drivers/replay/replay_camera.hpp"
#include "drivers/replay/session.hpp"
#include "drivers/replay/video_probe.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

using ::testing::HasSubstr;

constexpr int kLimit_s = 100;

class LiveRecording : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto simulated =
        test::run_program({GIMBALCTL, "simulate", "-o", (folder_.path() / "session").string(),
                           "--size", "320x240", "--duration", "4", "--motion", "walk", "--quiet"},
                          kLimit_s);
    ASSERT_EQ(simulated.exit_status, 0) << simulated.standard_error;
    folder_.write("run.toml",
                  "outputs = [\"videoconvert ! fakesink sync=false\"]\n"
                  "[replay]\nsession = \"session\"\n[control]\nsocket = \"c.sock\"\n"
                  "[recording]\nfolder = \"takes\"\nmin_free_mb = 0\n");
  }

  /// Runs a script of the shell beside a daemon, which is $daemon; `ctl` asks it.
  test::ProgramRun beside_a_daemon(const std::string& script) const {
    const std::string begin = "cd '" + folder_.path().string() +
                              "'\n"
                              "ctl() { \"$gimbalctl\" \"$@\" --socket c.sock; }\n"
                              "gimbalctl=$1\n"
                              "comes() { for i in $(seq 300); do \"$@\" > none 2>&1 && return; "
                              "sleep 0.1; done; false; }\n"
                              "has_frames() { ctl status --json | tr -d '\\n ' | "
                              "grep -qE '\"is_recording\":true.*\"frames\":('\"$1\"')'; }\n"
                              "sees() { ctl status --json | grep -q q_world_imu; }\n"
                              "\"$0\" --config run.toml 2> log & daemon=$!\n"
                              "comes sees\n";
    return test::run_program({"sh", "-c", begin + script, GIMBALD, GIMBALCTL}, kLimit_s);
  }

  [[nodiscard]] std::string read(const std::string& name) const {
    std::ifstream file(folder_.path() / name);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  /// The one session that was recorded.
  [[nodiscard]] std::filesystem::path take() const {
    std::vector<std::filesystem::path> takes;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path() / "takes")) {
      takes.push_back(entry.path());
    }
    EXPECT_EQ(takes.size(), 1U);
    return takes.empty() ? std::filesystem::path() : takes[0];
  }

  test::TemporaryFolder folder_;
};

double seconds_between(SensorTime a, SensorTime b) {
  return to_seconds(b - a);
}

/// Which sample of the recording that was played is the first of those that were recorded.
template <typename Sample, typename Value>
std::size_t place_of(const Sample& first, const std::vector<Sample>& played, Value value) {
  const auto found = std::ranges::find_if(
      played, [&](const Sample& sample) { return sample.*value == first.*value; });
  EXPECT_NE(found, played.end());
  return static_cast<std::size_t>(found - played.begin());
}

/// All that came between the first and the last that was recorded, with the same numbers and the
/// same distances in time, as long as the played recording does not begin anew: after `last_frame`.
template <typename Sample, typename Value>
void expect_same(const std::vector<Sample>& recorded, std::vector<Sample> played, Value value,
                 SensorTime last_frame) {
  std::erase_if(played, [&](const Sample& sample) { return sample.time > last_frame; });
  ASSERT_GT(recorded.size(), 50U);
  const std::size_t first = place_of(recorded[0], played, value);
  const std::size_t count = std::min(recorded.size(), played.size() - first);
  for (std::size_t i = 0; i < count; ++i) {
    ASSERT_EQ(recorded[i].*value, played[first + i].*value) << i;
    ASSERT_EQ((recorded[i].time - recorded[0].time).count(),
              (played[first + i].time - played[first].time).count())
        << i;
  }
}

std::vector<VideoFrame> pictures_of(const Session& session, std::size_t count) {
  ReplayCamera camera(session.video, session.frames, session.camera->fps);
  EXPECT_TRUE(camera.start());
  std::vector<VideoFrame> pictures;
  while (pictures.size() < count) {
    auto frame = camera.read();
    if (!frame || !*frame) break;
    pictures.push_back(**frame);
  }
  return pictures;
}

double psnr_db(const VideoFrame& a, const VideoFrame& b) {
  double sum = 0;
  for (int y = 0; y < a.size.height; ++y) {
    for (int x = 0; x < a.size.width; ++x) {
      const double difference =
          a.planes[0].data[y * a.planes[0].stride_bytes + x] -
          static_cast<double>(b.planes[0].data[y * b.planes[0].stride_bytes + x]);
      sum += difference * difference;
    }
  }
  const double mean = sum / (a.size.width * a.size.height);
  return 10 * std::log10(255.0 * 255.0 / std::max(mean, 1e-9));
}

TEST_F(LiveRecording, HoldsWhatTheSourcesDelivered) {
  const auto ran = beside_a_daemon(
      "ctl record start > begun; ctl record start > twice 2>&1; echo $? >> twice\n"
      "comes has_frames '[3-9]?[3-9][0-9]'; ctl record stop > ended\n"
      "ctl record stop > none 2>&1; echo $? >> none\n"
      "kill -TERM $daemon; wait $daemon");
  ASSERT_EQ(ran.exit_status, 0) << ran.standard_error << read("log");
  EXPECT_THAT(read("twice"), HasSubstr("is being recorded already\n2\n"));
  EXPECT_THAT(read("none"), HasSubstr("nothing is being recorded\n2\n"));
  EXPECT_THAT(read("ended"), HasSubstr("ended, takes/20"));

  const auto recorded = open_session(take());
  ASSERT_TRUE(recorded) << recorded.error().message;
  const auto played = open_session(folder_.path() / "session");
  ASSERT_TRUE(played);
  const SensorTime last_frame = played->frames.back().time;
  expect_same(recorded->gyro, played->gyro, &GyroSample::gyro_rad_s, last_frame);
  expect_same(recorded->accel, played->accel, &AccelSample::accel_m_s2, last_frame);
  EXPECT_EQ(recorded->camera->lens.K, played->camera->lens.K);
  EXPECT_EQ(recorded->camera->readout, played->camera->readout);
  EXPECT_EQ(recorded->imu.R_camera_imu, played->imu.R_camera_imu);
  const auto video = probe_video(recorded->video);
  ASSERT_TRUE(video) << video.error().message;
  EXPECT_EQ(video->frame_count, std::ssize(recorded->frames));
  EXPECT_TRUE(std::filesystem::exists(take() / "thumbnail.jpg"));

  // The frames' own: their distances tell which of the played ones they are.
  const auto gyro_first = place_of(recorded->gyro[0], played->gyro, &GyroSample::gyro_rad_s);
  const SensorDuration shift = recorded->gyro[0].time - played->gyro[gyro_first].time;
  const auto first = std::ranges::find_if(played->frames, [&](const FrameStamp& stamp) {
    return stamp.time + shift == recorded->frames[0].time;
  });
  ASSERT_NE(first, played->frames.end());
  const auto skipped = static_cast<std::size_t>(first - played->frames.begin());
  const auto seen = pictures_of(*recorded, 10);
  const auto given = pictures_of(*played, skipped + 10);
  for (std::size_t i = 0; i < seen.size() && skipped + i < given.size(); ++i) {
    EXPECT_GT(psnr_db(seen[i], given[skipped + i]), 33) << i;
  }
}

TEST_F(LiveRecording, AnEndOfTheDaemonFinishesIt) {
  const auto ran = beside_a_daemon(
      "ctl record start; comes has_frames '[3-9][0-9]'; kill -TERM $daemon; wait $daemon");
  ASSERT_EQ(ran.exit_status, 0) << ran.standard_error << read("log");
  const auto recorded = open_session(take());
  ASSERT_TRUE(recorded) << recorded.error().message;
  const auto video = probe_video(recorded->video);
  ASSERT_TRUE(video);
  EXPECT_EQ(video->frame_count, std::ssize(recorded->frames));
  EXPECT_THAT(read(std::filesystem::relative(take() / "session.toml", folder_.path()).string()),
              ::testing::Not(HasSubstr("duration_s = 0\n")));
}

TEST_F(LiveRecording, OutlivesADaemonThatIsKilled) {
  const auto ran = beside_a_daemon(
      "ctl record start; comes has_frames '[6-9][0-9]'; ctl status --json > before\n"
      "kill -KILL $daemon; wait $daemon; \"$gimbalctl\" sessions list takes > listed; echo $? >> "
      "listed\n"
      "\"$gimbalctl\" stabilize takes/* -o steady.mkv --quiet --warper cpu > told 2>&1; echo $? >> "
      "told");
  ASSERT_EQ(ran.exit_status, 0) << ran.standard_error << read("log");
  EXPECT_THAT(read("listed"), HasSubstr("\n0\n"));
  EXPECT_THAT(read("told"), ::testing::EndsWith("0\n"));
  const auto recorded = open_session(take());
  ASSERT_TRUE(recorded) << recorded.error().message;
  const std::string before = read("before");
  const std::size_t at = before.rfind("\"frames\": ");
  ASSERT_NE(at, std::string::npos);
  const long frames = std::stol(before.substr(at + 10));
  constexpr long kFps = 30;
  const auto video = probe_video(recorded->video);
  ASSERT_TRUE(video) << video.error().message;
  EXPECT_GE(video->frame_count, frames - kFps);
  EXPECT_GE(std::ssize(recorded->frames), frames - kFps);
  EXPECT_GE(seconds_between(recorded->gyro.front().time, recorded->gyro.back().time),
            static_cast<double>(frames) / static_cast<double>(kFps) - 1.2);
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "steady.mkv"));
}

TEST_F(LiveRecording, AFullDiskEndsTheRecordingAlone) {
  // A limit of what one process may write to a file stands for the disk; SIGXFSZ is ignored as the
  // daemon would not get it from a disk.
  const auto ran = beside_a_daemon(
      "kill -TERM $daemon; wait $daemon; rm -f c.sock\n"
      "sh -c 'trap \"\" XFSZ; ulimit -f 400; exec \"$0\" --config run.toml' \"$0\" 2> log & "
      "daemon=$!\n"
      "comes sees; ctl record start > begun\n"
      "failed() { ctl status | grep -q 'the last recording ended by itself'; }\n"
      "comes failed; ctl status > after; ctl status --json > first; sleep 1\n"
      "ctl status --json > later; kill -TERM $daemon; wait $daemon");
  ASSERT_EQ(ran.exit_status, 0) << ran.standard_error << read("log");
  EXPECT_THAT(read("after"), HasSubstr("the last recording ended by itself"));
  EXPECT_THAT(read("log"), HasSubstr("the stream goes on"));
  EXPECT_NE(read("first"), read("later")) << "frames still come";
  const auto recorded = open_session(take());
  ASSERT_TRUE(recorded) << recorded.error().message;
  EXPECT_GT(recorded->frames.size(), 5U);
}

TEST_F(LiveRecording, AFolderThatCannotBeWrittenIsNamed) {
  folder_.write("run.toml",
                "outputs = [\"videoconvert ! fakesink sync=false\"]\n"
                "[replay]\nsession = \"session\"\n[control]\nsocket = \"c.sock\"\n"
                "[recording]\nfolder = \"/proc/takes\"\n");
  const auto ran = beside_a_daemon(
      "ctl record start > refused 2>&1; echo $? >> refused; kill -TERM $daemon; wait $daemon");
  ASSERT_EQ(ran.exit_status, 0) << ran.standard_error << read("log");
  EXPECT_THAT(read("refused"), HasSubstr("/proc/takes: no session can be made there"));
  EXPECT_THAT(read("refused"), ::testing::EndsWith("\n2\n"));
}

}  // namespace
}  // namespace gimbal
