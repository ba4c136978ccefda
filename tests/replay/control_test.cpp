// A running daemon, asked as a person asks it: gimbalctl status, set, reload, metrics.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/run_program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::StartsWith;

constexpr int kLimit_s = 100;

class Control : public ::testing::Test {
 protected:
  void SetUp() override {
    simulate("session", "200");
    folder_.write("run.toml",
                  "outputs = [\"videoconvert ! fakesink sync=false\"]\n[replay]\nsession = "
                  "\"session\"\n[control]\nsocket = \"c.sock\"\n");
    folder_.write("more.toml", "");
  }

  void simulate(const std::string& name, const std::string& gyro_rate_hz) const {
    const auto simulated = test::run_program(
        {GIMBALCTL, "simulate", "-o", (folder_.path() / name).string(), "--size", "320x240",
         "--duration", "2", "--motion", "walk", "--gyro-rate", gyro_rate_hz, "--quiet"},
        kLimit_s);
    ASSERT_EQ(simulated.exit_status, 0) << simulated.standard_error;
  }

  /// Runs a script of the shell beside a daemon: `ctl` asks it, each into the file named first.
  test::ProgramRun beside_a_daemon(const std::string& script) const {
    const std::string begin =
        "cd '" + folder_.path().string() +
        "'\n"
        "ctl() { name=$1; shift; \"$1\" \"$2\" --socket c.sock $3 $4 > $name 2>&1; "
        "echo $? >> $name; }\n"
        "\"$0\" --config run.toml --config more.toml & daemon=$!\n"
        "for i in $(seq 300); do \"$1\" status --json --socket c.sock 2> none | "
        "grep -q q_world_imu && break; sleep 0.1; done\n";
    return test::run_program(
        {"sh", "-c", begin + script + "\nkill -TERM $daemon; wait $daemon", GIMBALD, GIMBALCTL},
        kLimit_s);
  }

  [[nodiscard]] std::string read(const std::string& name) const {
    std::ifstream file(folder_.path() / name);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  test::TemporaryFolder folder_;
};

TEST_F(Control, StatusTellsAPersonAndAProgram) {
  const auto ran = beside_a_daemon("ctl people \"$1\" status; ctl program \"$1\" status --json");
  ASSERT_EQ(ran.exit_status, 0) << ran.standard_error;
  EXPECT_THAT(read("people"), HasSubstr("all is well"));
  EXPECT_THAT(read("people"), HasSubstr("320x240 at 30 fps"));
  std::string text = read("program");
  ASSERT_THAT(text, ::testing::EndsWith("}\n0\n"));
  text.resize(text.size() - 2);
  const json status = json::parse(text);
  EXPECT_GT(status["frames"]["out"], 0);
  EXPECT_TRUE(status["degraded"].empty());
  EXPECT_NEAR(status["time_offset"]["in_use_s"].get<double>(), 0, 0.01);
  const auto q = status["orientation"]["q_world_imu"].get<std::vector<double>>();
  ASSERT_EQ(q.size(), 4U);
  EXPECT_NEAR(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1, 1e-9);
  // A hand that walks holds its camera about level.
  EXPECT_NEAR(status["orientation"]["degrees"]["elevation"].get<double>(), 0, 15);
  EXPECT_NEAR(status["orientation"]["degrees"]["roll"].get<double>(), 0, 15);
}

TEST_F(Control, StatusNamesAnImuThatIsTooSlowForTheReadout) {
  simulate("slow", "50");
  folder_.write("more.toml", "[replay]\nsession = \"slow\"\n");
  const auto ran = beside_a_daemon(
      "for i in $(seq 300); do ctl told \"$1\" status; grep -q 'fewer than two' told && break; "
      "sleep 0.1; done");
  ASSERT_EQ(ran.exit_status, 0) << ran.standard_error;
  EXPECT_THAT(read("told"), HasSubstr("fewer than two samples while a picture is read out"));
}

TEST_F(Control, SettingsChangeAndWrongOnesDoNot) {
  const auto ran = beside_a_daemon(
      "ctl good \"$1\" set amount=0.5 zoom=1.2\n"
      "ctl bad \"$1\" set amount=0.7 border=round\n"
      "ctl other \"$1\" set warper=cpu\n"
      "ctl word \"$1\" set amount\n"
      "ctl after \"$1\" status");
  ASSERT_EQ(ran.exit_status, 0) << ran.standard_error;
  EXPECT_THAT(read("good"), HasSubstr("amount 0.5"));
  EXPECT_THAT(read("good"), HasSubstr("zoom 1.2"));
  EXPECT_EQ(
      read("bad"),
      "gimbalctl: set, line 2: border is \"round\"; allowed are \"black\", \"blur\", \"crop\", "
      "\"extend\", \"fill\", \"mirror\"\n2\n");
  EXPECT_THAT(read("other"), HasSubstr("\"warper\" is not known"));
  EXPECT_THAT(read("word"), HasSubstr("write KEY=VALUE"));
  EXPECT_THAT(read("after"), HasSubstr("amount 0.5"));
}

TEST_F(Control, ReloadTellsWhatChangedAndWhatWaits) {
  const auto ran = beside_a_daemon(
      "printf '[stabilization]\\namount = 0.5\\nwarper = \"cpu\"\\n' > more.toml\n"
      "ctl good \"$1\" reload\n"
      "printf '[stabilization]\\namount = 5\\n' > more.toml\n"
      "ctl bad \"$1\" reload");
  ASSERT_EQ(ran.exit_status, 0) << ran.standard_error;
  EXPECT_EQ(read("good"), "changed      amount\nat restart   stabilization.warper\n0\n");
  EXPECT_EQ(read("bad"),
            "gimbalctl: more.toml, line 2: stabilization.amount must be from 0 to 1\n2\n");
}

TEST_F(Control, MetricsAreAsPrometheusReadsThem) {
  const auto ran = beside_a_daemon("ctl metrics \"$1\" metrics");
  ASSERT_EQ(ran.exit_status, 0) << ran.standard_error;
  const std::string text = read("metrics");
  EXPECT_THAT(text, HasSubstr("# TYPE gimbald_frames_in_total counter\n"));
  std::istringstream lines(text);
  std::string family;
  int samples = 0;
  for (std::string line; std::getline(lines, line) && line != "0";) {
    if (line.starts_with("# TYPE ")) {
      family = line.substr(7, line.rfind(' ') - 7);
    } else if (!line.starts_with('#')) {
      EXPECT_THAT(line, StartsWith(family));
      EXPECT_THAT(line, MatchesRegex("gimbald_[a-z_]+(\\{.*\\})? [-+.0-9e]+"));
      ++samples;
    }
  }
  EXPECT_GT(samples, 50);
}

TEST_F(Control, ByTcpTheTokenCounts) {
  folder_.write("more.toml", "[control]\nlisten = \"127.0.0.1:18410\"\ntoken = \"word\"\n");
  folder_.write("wrong", "wrong\n");
  folder_.write("right", "word\n");
  const auto ran = beside_a_daemon(
      "\"$1\" status --tcp 127.0.0.1:18410 --token-file wrong > refused 2>&1\n"
      "\"$1\" status --tcp 127.0.0.1:18410 --token-file right > told 2>&1");
  ASSERT_EQ(ran.exit_status, 0) << ran.standard_error;
  EXPECT_THAT(read("refused"), HasSubstr("the token is missing or wrong"));
  EXPECT_THAT(read("told"), HasSubstr("all is well"));
}

TEST_F(Control, WithoutADaemonItSaysSo) {
  const auto asked = test::run_program(
      {GIMBALCTL, "status", "--socket", (folder_.path() / "none.sock").string()}, kLimit_s);
  EXPECT_EQ(asked.exit_status, 2);
  EXPECT_THAT(asked.standard_error, HasSubstr("no daemon listens here"));
}

TEST_F(Control, ASecondDaemonDoesNotTakeTheSocket) {
  const auto ran = beside_a_daemon(
      "\"$0\" --config run.toml > second 2>&1; echo $? >> second; ctl first \"$1\" status");
  ASSERT_EQ(ran.exit_status, 0) << ran.standard_error;
  EXPECT_THAT(read("second"), HasSubstr("another gimbald listens there"));
  EXPECT_THAT(read("second"), ::testing::EndsWith("\n2\n"));
  EXPECT_THAT(read("first"), HasSubstr("all is well"));
}

}  // namespace
}  // namespace gimbal
