#include "drivers/v4l2/node_access.hpp"

#include <gmock/gmock.h>
#include <grp.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>

#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

using ::testing::HasSubstr;

class NodeAccess : public ::testing::Test {
 protected:
  [[nodiscard]] std::string node_with_mode(mode_t mode) const {
    const std::string path = folder_.path() / "video0";
    std::ofstream{path};
    EXPECT_EQ(::chmod(path.c_str(), mode), 0);
    return path;
  }

  test::TemporaryFolder folder_;
};

TEST_F(NodeAccess, NamesTheGroupThatTheNodeBelongsTo) {
  const std::string path = node_with_mode(0660);
  const group* video = ::getgrnam("video");
  const bool is_given =
      video != nullptr && ::chown(path.c_str(), static_cast<uid_t>(-1), video->gr_gid) == 0;
  struct stat node {};
  ASSERT_EQ(::stat(path.c_str(), &node), 0);
  const std::string name = is_given ? "video" : ::getgrgid(node.st_gid)->gr_name;
  EXPECT_THAT(why_not_open(path, EACCES), HasSubstr("add the user to group " + name + " "));
}

TEST_F(NodeAccess, AGroupThatMayNotIsNotNamed) {
  EXPECT_THAT(why_not_open(node_with_mode(0600), EACCES), HasSubstr("mode 600"));
}

TEST_F(NodeAccess, OtherReasonsAreTold) {
  EXPECT_THAT(why_not_open("/dev/video9", ENOENT), HasSubstr("no such device"));
  EXPECT_THAT(why_not_open("/dev/video9", ENODEV), HasSubstr("gone"));
  EXPECT_THAT(why_not_open("/dev/video9", EPERM), HasSubstr("DeviceAllow="));
  EXPECT_THAT(why_not_open("/dev/video9", EMFILE), HasSubstr("Too many open files"));
}

}  // namespace
}  // namespace gimbal
