#include "daemon/control_server.hpp"

#include <gmock/gmock.h>
#include <grp.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

using ::testing::HasSubstr;

ControlAnswer echo(const std::string& method, const std::string& path, const std::string& body) {
  return {.body = method + " " + path + " " + body};
}

class Descriptor {
 public:
  explicit Descriptor(int descriptor) : descriptor_(descriptor) {}
  Descriptor(Descriptor&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  Descriptor& operator=(Descriptor&&) = delete;
  ~Descriptor() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  [[nodiscard]] int get() const { return descriptor_; }

 private:
  int descriptor_;
};

class ControlServerTest : public ::testing::Test {
 protected:
  [[nodiscard]] Result<std::unique_ptr<ControlServer>> start(
      std::optional<TcpControl> tcp = std::nullopt) const {
    return ControlServer::start({socket_, std::move(tcp)}, echo);
  }

  /// A client that writes this much and no more; what comes back, up to a second's silence.
  [[nodiscard]] std::string answer_to(const std::string& text) const {
    const Descriptor asking = connected();
    EXPECT_EQ(::send(asking.get(), text.data(), text.size(), 0), static_cast<ssize_t>(text.size()));
    const timeval patience{1, 0};
    ::setsockopt(asking.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
    std::string answer;
    std::array<char, 4096> part{};
    for (ssize_t n = 0; (n = ::recv(asking.get(), part.data(), part.size(), 0)) > 0;) {
      answer.append(part.data(), static_cast<std::size_t>(n));
    }
    return answer;
  }

  [[nodiscard]] Descriptor connected() const {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    socket_.string().copy(address.sun_path, sizeof(address.sun_path) - 1);
    Descriptor asking(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    EXPECT_EQ(::connect(asking.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)),
              0);
    return asking;
  }

  [[nodiscard]] httplib::Client client() const {
    httplib::Client client(socket_.string());
    client.set_address_family(AF_UNIX);
    client.set_default_headers({{"Host", "localhost"}});
    return client;
  }

  test::TemporaryFolder folder_;
  std::filesystem::path socket_ = folder_.path() / "deep/control.sock";
};

TEST_F(ControlServerTest, HandsRequestsOn) {
  const auto server = start();
  ASSERT_TRUE(server) << server.error().message;
  auto asking = client();
  const auto got = asking.Get("/status");
  ASSERT_TRUE(got);
  EXPECT_EQ(got->body, "GET /status ");
  const auto posted = asking.Post("/set", "{}", "application/json");
  ASSERT_TRUE(posted);
  EXPECT_EQ(posted->body, "POST /set {}");
}

TEST_F(ControlServerTest, TheSocketIsForOwnerAndGroup) {
  const auto server = start();
  ASSERT_TRUE(server);
  struct stat status {};
  ASSERT_EQ(::stat(socket_.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0660U);
  if (const group* const ours = ::getgrnam("gimbald"); ours != nullptr && ::geteuid() == 0) {
    EXPECT_EQ(status.st_gid, ours->gr_gid);
  }
}

TEST_F(ControlServerTest, LeavesNoSocketBehind) {
  { ASSERT_TRUE(start()); }
  EXPECT_FALSE(std::filesystem::exists(socket_));
}

TEST_F(ControlServerTest, TakesThePlaceOfASocketThatNobodyListensOn) {
  std::filesystem::create_directories(socket_.parent_path());
  const int left_behind = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  socket_.string().copy(address.sun_path, sizeof(address.sun_path) - 1);
  ASSERT_EQ(::bind(left_behind, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  ::close(left_behind);
  const auto server = start();
  ASSERT_TRUE(server) << server.error().message;
  EXPECT_TRUE(client().Get("/status"));
}

TEST_F(ControlServerTest, LeavesAnothersSocketAlone) {
  const auto first = start();
  ASSERT_TRUE(first);
  const auto second = start();
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().kind, Error::Kind::bad_input);
  EXPECT_THAT(second.error().message, HasSubstr("another gimbald listens"));
  EXPECT_TRUE(client().Get("/status"));
}

TEST_F(ControlServerTest, LeavesAFileThatIsNoSocketAlone) {
  folder_.write("deep/control.sock", "precious");
  const auto server = start();
  ASSERT_FALSE(server);
  EXPECT_THAT(server.error().message, HasSubstr("something else is there"));
  EXPECT_TRUE(std::filesystem::is_regular_file(socket_));
}

TEST_F(ControlServerTest, APostWithoutABodyIsHandedOn) {
  const auto server = start();
  ASSERT_TRUE(server) << server.error().message;
  EXPECT_THAT(answer_to("POST /reload HTTP/1.1\r\nHost: localhost\r\n\r\n"),
              HasSubstr("POST /reload "));
}

TEST_F(ControlServerTest, OtherMethodsAreHandedOn) {
  const auto server = start();
  ASSERT_TRUE(server) << server.error().message;
  EXPECT_THAT(answer_to("PUT /set HTTP/1.1\r\nHost: localhost\r\n\r\n"), HasSubstr("PUT /set "));
}

TEST_F(ControlServerTest, ClientsThatSayNothingDoNotKeepItFromEnding) {
  auto server = start();
  ASSERT_TRUE(server) << server.error().message;
  std::vector<Descriptor> silent;
  for (int i = 0; i < 5; ++i) silent.push_back(connected());
  const std::string begun = "POST /set HTTP/1.1\r\nHo";
  ASSERT_GT(::send(silent.back().get(), begun.data(), begun.size(), 0), 0);
  ASSERT_TRUE(client().Get("/status"));
  const auto begin = std::chrono::steady_clock::now();
  server->reset();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(3));
}

TEST_F(ControlServerTest, APortIsForOneDaemonAlone) {
  const auto first = start(TcpControl{"127.0.0.1", 0, "word"});
  ASSERT_TRUE(first) << first.error().message;
  const auto second = ControlServer::start(
      {folder_.path() / "other.sock", TcpControl{"127.0.0.1", (*first)->tcp_port(), "other"}},
      echo);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().kind, Error::Kind::bad_input);
  EXPECT_THAT(second.error().message, HasSubstr("in use"));
}

TEST_F(ControlServerTest, AskedByTcpItWantsTheToken) {
  const auto server = start(TcpControl{"127.0.0.1", 0, "word"});
  ASSERT_TRUE(server) << server.error().message;
  httplib::Client asking("127.0.0.1", (*server)->tcp_port());
  for (const char* const wrong : {"", "Bearer ", "Bearer wor", "Bearer words", "word"}) {
    const auto refused = asking.Get("/status", {{"Authorization", wrong}});
    ASSERT_TRUE(refused);
    EXPECT_EQ(refused->status, 401) << wrong;
    EXPECT_THAT(refused->body, HasSubstr("token"));
  }
  const auto answered = asking.Get("/status", {{"Authorization", "Bearer word"}});
  ASSERT_TRUE(answered);
  EXPECT_EQ(answered->status, 200);
}

TEST_F(ControlServerTest, RefusesABodyWithoutEnd) {
  const auto server = start();
  ASSERT_TRUE(server);
  const auto refused = client().Post("/set", std::string(1 << 20, 'x'), "text/plain");
  EXPECT_TRUE(!refused || refused->status == 413);
  EXPECT_TRUE(client().Get("/status"));
}

TEST_F(ControlServerTest, AClientThatSaysNothingHoldsNobodyUp) {
  auto server = start();
  ASSERT_TRUE(server);
  const int silent = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  socket_.string().copy(address.sun_path, sizeof(address.sun_path) - 1);
  ASSERT_EQ(::connect(silent, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  EXPECT_TRUE(client().Get("/status"));
  server->reset();  // and it does not keep the server from ending
  ::close(silent);
}

}  // namespace
}  // namespace gimbal
