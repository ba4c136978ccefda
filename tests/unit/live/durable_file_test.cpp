#include "daemon/durable_file.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(DurableFile, HoldsWhatWasAppended) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "log";
  std::string expected;
  {
    auto file = DurableFile::create(path);
    ASSERT_TRUE(file) << file.error().message;
    for (int i = 0; i < 1000; ++i) {
      const std::string line = std::to_string(i) + "\n";
      ASSERT_TRUE(file->append(line));
      expected += line;
    }
    ASSERT_TRUE(file->sync());
    EXPECT_EQ(text_of(path), expected);
  }
}

TEST(DurableFile, DoesNotTouchWhatIsThere) {
  const test::TemporaryFolder folder;
  folder.write("log", "precious");
  const auto file = DurableFile::create(folder.path() / "log");
  ASSERT_FALSE(file);
  EXPECT_EQ(text_of(folder.path() / "log"), "precious");
}

TEST(ReplaceFile, SaysWhereItCannotWrite) {
  const test::TemporaryFolder folder;
  const auto replaced = replace_file(folder.path() / "none/file", "text");
  ASSERT_FALSE(replaced);
  EXPECT_NE(replaced.error().message.find("none/file"), std::string::npos);
}

TEST(ReplaceFile, TakesABareName) {
  const test::TemporaryFolder folder;
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  const auto replaced = replace_file("bare.toml", "text");
  std::filesystem::current_path(before);
  EXPECT_TRUE(replaced);
  EXPECT_EQ(text_of(folder.path() / "bare.toml"), "text");
}

TEST(ReplaceFile, PutsTheNewTextInPlace) {
  const test::TemporaryFolder folder;
  folder.write("session.toml", "old, and much longer");
  ASSERT_TRUE(replace_file(folder.path() / "session.toml", "new"));
  EXPECT_EQ(text_of(folder.path() / "session.toml"), "new");
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "session.toml.new"));
}

}  // namespace
}  // namespace gimbal
