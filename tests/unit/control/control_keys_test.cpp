#include "daemon/control_keys.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ostream>

#include "daemon/stabilization_keys.hpp"
#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

using ::testing::HasSubstr;

Result<ControlSettings> read(const std::string& text) {
  auto table = TomlTable::parse(text, "test.toml");
  if (!table) return tl::unexpected(table.error());
  ControlSettings settings;
  read_control(*table, settings);
  if (auto sound = verdict(*table); !sound) return tl::unexpected(sound.error());
  return settings;
}

TEST(ControlKeys, SocketTcpAndToken) {
  const test::TemporaryFolder folder;
  folder.write("token", "word\nsecond line\n");
  const auto settings = read("socket = \"/x/y\"\nlisten = \"[::1]:8410\"\ntoken_file = \"" +
                             (folder.path() / "token").string() + "\"\n");
  ASSERT_TRUE(settings) << settings.error().message;
  EXPECT_EQ(settings->socket, "/x/y");
  ASSERT_TRUE(settings->tcp);
  EXPECT_EQ(settings->tcp->address, "::1");
  EXPECT_EQ(settings->tcp->port, 8410);
  EXPECT_EQ(settings->tcp->token, "word");
}

struct BadControl {
  const char* name;
  const char* text;
  const char* message;
};

void PrintTo(const BadControl& bad, std::ostream* out) {
  *out << bad.name;
}

class BadControlTest : public ::testing::TestWithParam<BadControl> {};

TEST_P(BadControlTest, IsRefusedWithItsLine) {
  const auto settings = read(GetParam().text);
  ASSERT_FALSE(settings);
  EXPECT_THAT(settings.error().message, HasSubstr("test.toml, line "));
  EXPECT_THAT(settings.error().message, HasSubstr(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    Control, BadControlTest,
    ::testing::Values(
        BadControl{"NoToken", "listen = \"127.0.0.1:8410\"\n", "needs token_file"},
        BadControl{"EmptyToken", "listen = \"127.0.0.1:8410\"\ntoken = \"\"\n", "needs token_file"},
        BadControl{"NoPort", "listen = \"127.0.0.1\"\ntoken = \"x\"\n", "is not ADDRESS:PORT"},
        BadControl{"LargePort", "listen = \"127.0.0.1:70000\"\ntoken = \"x\"\n",
                   "is not ADDRESS:PORT"},
        BadControl{"NoAddress", "listen = \":80\"\ntoken = \"x\"\n", "is not ADDRESS:PORT"},
        BadControl{"TokenAlone", "token = \"x\"\n", "is for TCP"},
        BadControl{"NoTokenFile", "listen = \"127.0.0.1:1\"\ntoken_file = \"/nowhere\"\n",
                   "cannot be read"}),
    [](const auto& bad) -> std::string { return bad.param.name; });

}  // namespace
}  // namespace gimbal
