#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

using test::TemporaryFolder;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

struct CommandRun {
  int status = -1;
  std::string out;
  std::string err;
};

/// Runs gimbalctl with the words given, as a script outside the project would.
CommandRun gimbalctl(const TemporaryFolder& folder, const std::string& words) {
  const std::string err = (folder.path() / "stderr").string();
  const std::string line = std::string(GIMBALCTL) + " " + words + " 2>" + err;
  CommandRun run;
  std::FILE* const pipe = ::popen(line.c_str(), "r");
  std::array<char, 4096> buffer{};
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
    run.out.append(buffer.data(), count);
  }
  run.status = WEXITSTATUS(::pclose(pipe));
  std::ifstream file(err);
  run.err = {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  return run;
}

/// Half a second of log, ten frames, a steady version with a report and one without.
void write_session(const TemporaryFolder& folder) {
  std::string gyro = "t_s,x,y,z\n";
  for (int i = 0; i < 50; ++i) gyro += std::to_string(i * 0.01) + ",0,0,0\n";
  std::string frames = "index,t_s\n";
  for (int i = 0; i < 10; ++i) frames += std::to_string(i) + "," + std::to_string(i * 0.04) + "\n";
  folder.write("walk/session.toml",
               "device = \"iPod\"\nrecorded_at = \"2011-03-01T12:00:00Z\"\nquality = \"720p\"\n"
               "[camera]\nwidth = 1280\nheight = 720\nfps = 25.0\nreadout_s = 0.03\n"
               "K = [[1223.0, 0, 650.4], [0, 1217.5, 345.3], [0, 0, 1]]\n");
  folder.write("walk/gyro.csv", gyro);
  folder.write("walk/frames.csv", frames);
  folder.write("walk/video.mkv", "pictures");
  folder.write("walk/thumbnail.jpg", "picture");
  folder.write("walk/stabilized/half.mp4", std::string(1'500'000, 'x'));
  folder.write("walk/stabilized/half.mp4.json", "{\"zoom\": 1.15, \"amount\": 0.5}");
  folder.write("walk/stabilized/other.mkv", "x");
  folder.write("walk/stabilized/other.mkv.json", "[not a report");
  folder.write("walk/stabilized/notes.txt", "x");
  std::filesystem::create_symlink("/nowhere/gone.mp4", folder.path() / "walk/stabilized/gone.mp4");
}

TEST(SessionsCommand, ShowsWhatASessionHolds) {
  const TemporaryFolder folder;
  write_session(folder);
  const CommandRun run = gimbalctl(folder, "sessions show " + (folder.path() / "walk").string());
  EXPECT_EQ(run.status, 0);
  EXPECT_THAT(run.err, "");
  EXPECT_THAT(
      run.out,
      AllOf(HasSubstr("iPod"), HasSubstr("2011-03-01T12:00:00Z"), HasSubstr("720p"),
            HasSubstr("1280x720 at 25.00 fps, readout 30.00 ms"),
            HasSubstr("50 at 100.0 Hz, 0.000 to 0.490 s"), HasSubstr("10 at 25.0 Hz"),
            HasSubstr("duration     0.36 s"), HasSubstr("video.mkv"), HasSubstr("thumbnail.jpg")));
  EXPECT_THAT(run.out, AllOf(HasSubstr("half.mp4 (1.5 MB, amount 0.50, zoom 1.150)"),
                             HasSubstr("other.mkv (0.0 MB)"), Not(HasSubstr("notes.txt")),
                             Not(HasSubstr("gone.mp4"))));
}

TEST(SessionsCommand, ShowsTheSameToPrograms) {
  const TemporaryFolder folder;
  write_session(folder);
  const CommandRun run =
      gimbalctl(folder, "sessions show --json " + (folder.path() / "walk").string());
  ASSERT_EQ(run.status, 0);
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_EQ(json.at("device"), "iPod");
  EXPECT_NEAR(json.at("duration_s").get<double>(), 0.36, 1e-9);
  EXPECT_EQ(json.at("camera").at("width"), 1280);
  EXPECT_EQ(json.at("camera").at("K").at(0).at(2), 650.4);
  EXPECT_EQ(json.at("gyro").at("count"), 50);
  EXPECT_NEAR(json.at("gyro").at("rate_hz").get<double>(), 100, 1e-6);
  EXPECT_TRUE(json.at("accel").is_null());
  ASSERT_EQ(json.at("stabilized").size(), 2U);
  EXPECT_EQ(json.at("stabilized").at(0).at("zoom"), 1.15);
  EXPECT_TRUE(json.at("stabilized").at(1).at("zoom").is_null());
  EXPECT_TRUE(json.at("warnings").empty());
}

TEST(SessionsCommand, ListsAFolderAndSaysWhichCannotBeOpened) {
  const TemporaryFolder folder;
  write_session(folder);
  folder.write("broken/session.toml", "width = = 3\n");
  folder.write("not-a-session/file", "x");
  const CommandRun run = gimbalctl(folder, "sessions list " + folder.path().string());
  EXPECT_EQ(run.status, 0);
  EXPECT_THAT(run.out, AllOf(HasSubstr("walk  2011-03-01T12:00:00Z  0.4 s  10 frames  iPod"),
                             HasSubstr("broken  cannot be opened: "), HasSubstr("line 1"),
                             Not(HasSubstr("not-a-session"))));
}

TEST(SessionsCommand, EndsWithTwoAndOneLineForBadInput) {
  const TemporaryFolder folder;
  write_session(folder);
  const std::string walk = (folder.path() / "walk").string();
  for (const std::string& words :
       {std::string("sessions"), std::string("sessions show"),
        std::string("sessions show /nowhere"), std::string("sessions list /nowhere"),
        "sessions import " + walk, "sessions import " + walk + " -o " + walk,
        std::string("sessions import /nowhere -o ") + walk, "sessions show --unknown " + walk}) {
    const CommandRun run = gimbalctl(folder, words);
    EXPECT_EQ(run.status, 2) << words;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_EQ(run.out, "") << words;
  }
}

TEST(SessionsCommand, ImportsIntoASessionThatItCanShow) {
  const TemporaryFolder folder;
  std::string log;
  for (int i = 0; i < 20; ++i) {
    log += std::to_string(98'765'432'109'876 + i * 2'500'000LL) + " 0.1 0.2 0.3 0.5 9.7 1.0\n";
  }
  folder.write("imu.txt", log);
  const std::string session = (folder.path() / "s").string();
  const CommandRun run = gimbalctl(
      folder, "sessions import " + (folder.path() / "imu.txt").string() + " -o " + session);
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("20 at 400.0 Hz"));
  EXPECT_EQ(gimbalctl(folder, "sessions show " + session).out, run.out);
}

}  // namespace
}  // namespace gimbal
