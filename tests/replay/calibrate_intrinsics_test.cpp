#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "drivers/replay/session_toml.hpp"
#include "drivers/replay/still.hpp"
#include "tests/support/rendered_board.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using Json = nlohmann::json;

constexpr int kLimit_s = 60;
constexpr ImageSize kSize = {480, 360};
const CalibrationBoard kBoard{BoardKind::checkerboard, 7, 5, 0, ""};

Lens lens() {
  LensParameters parameters;
  parameters.model = LensModel::brown;
  parameters.K << 390, 0, 243.2, 0, 392, 177.6, 0, 0, 1;
  parameters.distortion = {-0.25, 0.08, 0.0006, -0.0004, 0};
  return *Lens::create(parameters);
}

test::ProgramRun calibrate(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {GIMBALCTL, "calibrate", "intrinsics"});
  return test::run_program(arguments, kLimit_s);
}

void expect_truth(const test::ProgramRun& run) {
  ASSERT_EQ(run.exit_status, 0) << run.standard_error << run.standard_output;
  const Json found = Json::parse(run.standard_output);
  EXPECT_EQ(found["verdict"], "ok");
  const Eigen::Matrix3d K = lens().parameters().K;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      const double truth = K(static_cast<int>(row), static_cast<int>(column));
      EXPECT_NEAR(found["K"][row][column], truth, 0.003 * 390);
    }
  }
  EXPECT_LT(found["error_px"], 0.12);
}

class CalibrateIntrinsics : public ::testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_.path() / name).string();
  }

  [[nodiscard]] static std::vector<VideoFrame> pictures(int count,
                                                        const test::BoardPoses& how = {}) {
    static const test::BoardRenderer renderer(lens(), kSize, test::board_texture(kBoard), {0.7, 2});
    std::vector<VideoFrame> frames;
    std::uint64_t seed = 5;
    for (const auto& pose : test::board_poses(kBoard, lens(), kSize, count, seed, how)) {
      frames.push_back(renderer.render(pose, ++seed));
    }
    return frames;
  }

  /// Without a board.
  [[nodiscard]] static VideoFrame empty_picture() {
    const test::BoardRenderer renderer(lens(), kSize, [](const Eigen::Vector2d&) { return 90.0; },
                                       {0, 4});
    return renderer.render(test::board_poses(kBoard, lens(), kSize, 1, 1).front(), 3);
  }

  void write_pictures(const std::vector<VideoFrame>& frames) const {
    fs::create_directories(path("pictures"));
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const auto written =
          write_still(frames[i], path("pictures/p" + std::to_string(10 + i) + ".png"));
      ASSERT_TRUE(written) << written.error().message;
    }
  }

  /// Each picture for half a second at ten a second.
  void write_video(const std::string& name, const std::vector<VideoFrame>& frames) const {
    std::string video = "YUV4MPEG2 W480 H360 F10:1 Ip A1:1 C420 XCOLORRANGE=FULL\n";
    for (const VideoFrame& frame : frames) {
      for (int repeat = 0; repeat < 5; ++repeat) {
        video += "FRAME\n";
        for (int y = 0; y < kSize.height; ++y) {
          const auto* const row = frame.planes[0].data + y * frame.planes[0].stride_bytes;
          video.append(row, row + kSize.width);
        }
        video += std::string(kSize.width * kSize.height / 2, '\x80');
      }
    }
    folder_.write(name, video);
  }

  test::TemporaryFolder folder_;
};

TEST_F(CalibrateIntrinsics, TellsTheLensFromPicturesAndWritesAProfile) {
  std::vector<VideoFrame> frames = pictures(15);
  frames.push_back(empty_picture());
  write_pictures(frames);
  folder_.write("pictures/notes.txt", "taken by hand\n");
  const auto run = calibrate({path("pictures"), "--board", "checkerboard:7x5", "--json", "--plot",
                              path("corners.svg"), "--write", path("lens.toml")});
  expect_truth(run);
  EXPECT_EQ(Json::parse(run.standard_output)["views"].size(), 15U);
  EXPECT_TRUE(fs::exists(path("corners.svg")));
  const auto profile = read_session_toml(path("lens.toml"));
  ASSERT_TRUE(profile) << profile.error().message;
  ASSERT_TRUE(profile->session.camera);
  EXPECT_EQ(profile->session.camera->size, kSize);
  EXPECT_EQ(profile->session.camera->lens.model, LensModel::brown);
  EXPECT_NEAR(profile->session.camera->lens.K(0, 0), 390, 0.003 * 390);
  EXPECT_EQ(profile->session.camera->lens.distortion.size(), 5U);

  const auto again =
      calibrate({path("pictures"), "--board", "checkerboard:7x5", "--write", path("lens.toml")});
  EXPECT_EQ(again.exit_status, 2);
  EXPECT_THAT(again.standard_error, HasSubstr("is there already"));
  const auto drawn =
      calibrate({path("pictures"), "--board", "checkerboard:7x5", "--plot", path("corners.svg")});
  EXPECT_EQ(drawn.exit_status, 2);
  EXPECT_THAT(drawn.standard_error, HasSubstr("is there already"));
}

TEST_F(CalibrateIntrinsics, KeepsWhatElseAReplacedProfileSays) {
  write_pictures(pictures(15));
  folder_.write("lens.toml", "device = \"mine\"\n[camera]\nreadout_s = 0.017\n");
  const std::vector<std::string> replace = {path("pictures"), "--board", "checkerboard:7x5",
                                            "--json",         "--write", path("lens.toml"),
                                            "--overwrite"};
  expect_truth(calibrate(replace));
  const auto profile = read_session_toml(path("lens.toml"));
  ASSERT_TRUE(profile) << profile.error().message;
  EXPECT_EQ(profile->session.device, "mine");
  EXPECT_EQ(profile->session.camera->readout, std::chrono::milliseconds(17));
  EXPECT_NEAR(profile->session.camera->lens.K(0, 0), 390, 0.003 * 390);

  folder_.write("lens.toml", "no TOML");
  const auto refused = calibrate(replace);
  EXPECT_EQ(refused.exit_status, 2);
  EXPECT_THAT(refused.standard_error, HasSubstr("lens.toml: is no TOML"));
}

TEST_F(CalibrateIntrinsics, TellsTheLensFromAVideo) {
  write_video("board.y4m", pictures(16));
  const auto run = calibrate({path("board.y4m"), "--board", "checkerboard:7x5", "--json"});
  expect_truth(run);
  // Of each picture that lasts half a second one view is enough.
  EXPECT_LE(Json::parse(run.standard_output)["views"].size(), 16U);
}

#ifdef GIMBALD_HAS_CHARUCO
TEST_F(CalibrateIntrinsics, TellsTheLensFromACharucoBoard) {
  const CalibrationBoard board{BoardKind::charuco, 7, 6, 0.75, "DICT_5X5_100"};
  const test::BoardRenderer renderer(lens(), kSize, test::board_texture(board), {0.5, 2});
  std::vector<VideoFrame> frames;
  for (const auto& pose : test::board_poses(board, lens(), kSize, 16, 3, {.share = 0.6})) {
    frames.push_back(renderer.render(pose, frames.size()));
  }
  write_pictures(frames);
  expect_truth(calibrate({path("pictures"), "--board", "charuco:7x6", "--square", "40", "--marker",
                          "30", "--dictionary", "DICT_5X5_100", "--json"}));
}
#endif

// What a session.toml says beside the lens stays.
TEST_F(CalibrateIntrinsics, KeepsWhatASessionSays) {
  write_video("session/video.mkv", pictures(16));
  folder_.write("session/session.toml",
                "device = \"board\"\n[camera]\nreadout_s = 0.021\ntime_offset_s = 0.003\n");
  std::string frames = "index,t_s\n";
  for (int i = 0; i < 80; ++i)
    frames += std::to_string(i) + "," + std::to_string(5 + 0.1 * i) + "\n";
  folder_.write("session/frames.csv", frames);
  const auto run = calibrate(
      {path("session"), "--board", "checkerboard:7x5", "--json", "--write", path("found.toml")});
  expect_truth(run);
  const auto profile = read_session_toml(path("found.toml"));
  ASSERT_TRUE(profile && profile->session.camera);
  EXPECT_EQ(to_seconds(profile->session.camera->readout), 0.021);
  EXPECT_NEAR(profile->session.camera->lens.K(1, 1), 392, 0.003 * 390);
}

TEST_F(CalibrateIntrinsics, CannotTellFromWhatDoesNotSuffice) {
  write_pictures(pictures(4));
  const auto few = calibrate({path("pictures"), "--board", "checkerboard:7x5", "--json"});
  EXPECT_EQ(few.exit_status, 2);
  EXPECT_THAT(few.standard_error, HasSubstr("cannot tell: only 4 pictures"));
  EXPECT_EQ(Json::parse(few.standard_output)["verdict"], "cannot-tell");
  const auto other = calibrate({path("pictures"), "--board", "checkerboard:9x7"});
  EXPECT_EQ(other.exit_status, 2);
  EXPECT_THAT(other.standard_error, HasSubstr("found in none of 4 pictures"));
}

TEST_F(CalibrateIntrinsics, RefusesBadInput) {
  const auto refusal = [&](std::vector<std::string> arguments) {
    const auto run = calibrate(arguments);
    EXPECT_EQ(run.exit_status, 2) << run.standard_error;
    return run.standard_error;
  };
  fs::create_directories(path("nothing"));
  folder_.write("text.png", "this is no picture\n");
  EXPECT_THAT(refusal({path("nothing"), "--board", "checkerboard:7x5"}), HasSubstr("no pictures"));
  EXPECT_THAT(refusal({path("missing.png"), "--board", "checkerboard:7x5"}),
              HasSubstr("missing.png"));
  EXPECT_THAT(refusal({path("text.png"), "--board", "checkerboard:7x5"}), HasSubstr("text.png"));
  EXPECT_THAT(refusal({path("text.png"), "--board", "9x6"}), HasSubstr("inner corners"));
  EXPECT_THAT(refusal({path("text.png"), "--board", "charuco:5x7"}), HasSubstr("--marker"));
  EXPECT_THAT(refusal({"--board", "checkerboard:7x5"}), HasSubstr("--camera"));
  EXPECT_THAT(refusal({path("text.png"), "--camera", "/dev/video0", "--board", "checkerboard:7x5"}),
              HasSubstr("either"));
  EXPECT_THAT(refusal({"--camera", "/dev/no-camera", "--board", "checkerboard:7x5"}),
              HasSubstr("/dev/no-camera"));
  EXPECT_THAT(refusal({"--camera", "/dev/no-camera", "--control", "exposure", "--board",
                       "checkerboard:7x5"}),
              HasSubstr("NAME=NUMBER"));
}

TEST_F(CalibrateIntrinsics, RefusesPicturesOfSeveralSizes) {
  write_pictures(pictures(1));
  ASSERT_TRUE(write_still(empty_picture(), path("pictures/q.png"), 240));
  const auto run = calibrate({path("pictures"), "--board", "checkerboard:7x5"});
  EXPECT_EQ(run.exit_status, 2);
  EXPECT_THAT(run.standard_error, HasSubstr("q.png: is 240x180, but those before are 480x360"));
}

}  // namespace
}  // namespace gimbal
