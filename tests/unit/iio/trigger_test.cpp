#include "drivers/iio/trigger.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

namespace fs = std::filesystem;

/// A device without a trigger, as sysfs shows it.
class Trigger : public ::testing::Test {
 protected:
  Trigger() {
    put(device_ / "name", "bmi160");
    put(current_, "\n");
  }

  static void put(const fs::path& file, const std::string& text) {
    fs::create_directories(file.parent_path());
    std::ofstream(file) << text;
  }

  static std::string get(const fs::path& file) {
    std::ifstream stream(file);
    std::string text;
    std::getline(stream, text);
    return text;
  }

  void add_trigger(const std::string& folder, const std::string& name) const {
    put(folders_.devices / folder / "name", name + "\n");
  }

  [[nodiscard]] Result<void> prepare(const std::string& wanted) const {
    return prepare_trigger(folders_, "iio:device4", wanted, 200);
  }

  test::TemporaryFolder folder_;
  IioFolders folders_{folder_.path() / "devices", folder_.path() / "hrtimer"};
  fs::path device_ = folders_.devices / "iio:device4";
  fs::path current_ = device_ / "trigger" / "current_trigger";
};

TEST_F(Trigger, TheOneThatIsSetIsKeptAndItsRateSet) {
  put(current_, "board-timer\n");
  add_trigger("trigger0", "board-timer");
  put(folders_.devices / "trigger0" / "sampling_frequency", "100.000\n");
  EXPECT_EQ(trigger_state(folders_, "iio:device4"), TriggerState::set);
  ASSERT_TRUE(prepare(""));
  EXPECT_EQ(get(current_), "board-timer");
  EXPECT_EQ(get(folders_.devices / "trigger0" / "sampling_frequency"), "200.000");
}

TEST_F(Trigger, TheDevicesOwnIsTakenBeforeATimer) {
  add_trigger("trigger0", "bmi160-dev3");
  add_trigger("trigger1", "bmi160-dev4");
  EXPECT_EQ(trigger_state(folders_, "iio:device4"), TriggerState::own);
  ASSERT_TRUE(prepare(""));
  EXPECT_EQ(get(current_), "bmi160-dev4");
}

TEST_F(Trigger, ATimersIsMade) {
  fs::create_directories(folders_.timer_triggers);
  EXPECT_EQ(trigger_state(folders_, "iio:device4"), TriggerState::timer);
  ASSERT_TRUE(prepare(""));
  EXPECT_TRUE(fs::is_directory(folders_.timer_triggers / "gimbald-4"));
  EXPECT_EQ(get(current_), "gimbald-4");
}

TEST_F(Trigger, WithoutTheModuleTheErrorNamesIt) {
  EXPECT_EQ(trigger_state(folders_, "iio:device4"), TriggerState::impossible);
  const auto prepared = prepare("");
  ASSERT_FALSE(prepared);
  EXPECT_NE(prepared.error().message.find("iio-trig-hrtimer"), std::string::npos);
}

TEST_F(Trigger, TheOneThatIsNamedReplacesTheOneThatIsSet) {
  put(current_, "bmi160-dev4\n");
  add_trigger("trigger0", "bmi160-dev4");
  EXPECT_FALSE(prepare("sync"));
  add_trigger("trigger1", "sync");
  ASSERT_TRUE(prepare("sync"));
  EXPECT_EQ(get(current_), "sync");
}

TEST_F(Trigger, ADeviceWithoutTriggersIsLeftAlone) {
  fs::remove_all(current_.parent_path());
  EXPECT_EQ(trigger_state(folders_, "iio:device4"), TriggerState::not_needed);
  EXPECT_TRUE(prepare(""));
  EXPECT_FALSE(fs::exists(current_));
}

}  // namespace
}  // namespace gimbal
