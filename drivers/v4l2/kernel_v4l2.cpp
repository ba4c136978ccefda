#include <fcntl.h>
#include <fmt/format.h>
#include <linux/media.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include "drivers/stop_event.hpp"
#include "drivers/v4l2/node_access.hpp"
#include "drivers/v4l2/v4l2_device.hpp"

namespace gimbal {
namespace {

namespace fs = std::filesystem;

/// Owns a descriptor.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }

  [[nodiscard]] int get() const { return fd_; }
  [[nodiscard]] bool is_open() const { return fd_ >= 0; }

 private:
  int fd_;
};

Descriptor open_node(const std::string& path) {
  return Descriptor(::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC));
}

int retry_ioctl(int fd, unsigned long code, void* argument) {
  int status = 0;
  do {
    status = ::ioctl(fd, code, argument);
  } while (status != 0 && errno == EINTR);
  return status == 0 ? 0 : errno;
}

class KernelDevice final : public V4l2Device {
 public:
  explicit KernelDevice(Descriptor node) : node_(std::move(node)) {}

  int request(unsigned long code, void* argument) override {
    return retry_ioctl(node_.get(), code, argument);
  }

  std::uint8_t* map(std::size_t bytes, std::int64_t offset) override {
    void* memory = ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED, node_.get(), offset);
    return memory == MAP_FAILED ? nullptr : static_cast<std::uint8_t*>(memory);
  }

  void unmap(std::uint8_t* memory, std::size_t bytes) override { ::munmap(memory, bytes); }

  Wakeup wait(SensorDuration limit) override {
    using std::chrono::steady_clock;
    const auto deadline = steady_clock::now() + limit;
    for (;;) {
      const auto left =
          std::chrono::ceil<std::chrono::milliseconds>(deadline - steady_clock::now());
      std::array<pollfd, 2> watched = {{{node_.get(), POLLIN, 0}, {cancelled_.fd(), POLLIN, 0}}};
      const int ready = ::poll(watched.data(), watched.size(),
                               static_cast<int>(std::max<std::int64_t>(0, left.count())));
      if (ready < 0 && errno == EINTR) continue;
      if (ready < 0) return Wakeup::error;
      if (watched[1].revents != 0) return Wakeup::cancelled;
      if ((watched[0].revents & (POLLERR | POLLHUP | POLLNVAL)) != 0) return Wakeup::error;
      return ready > 0 ? Wakeup::picture : Wakeup::timeout;
    }
  }

  void cancel() override { cancelled_.set(); }

  [[nodiscard]] std::optional<SensorDuration> read_clock(KernelClock clock) const override {
    return read_kernel_clock(clock);
  }

 private:
  Descriptor node_;
  StopEvent cancelled_;
};

/// Nothing, with errno set, if that fails.
std::unique_ptr<V4l2Device> open_device(const std::string& path) {
  Descriptor node = open_node(path);
  if (!node.is_open()) return nullptr;
  return std::make_unique<KernelDevice>(std::move(node));
}

std::optional<int> number_of(std::string_view name, std::string_view prefix) {
  if (!name.starts_with(prefix)) return std::nullopt;
  name.remove_prefix(prefix.size());
  int number = 0;
  const auto parsed = std::from_chars(name.data(), name.data() + name.size(), number);
  if (parsed.ec != std::errc() || parsed.ptr != name.data() + name.size()) return std::nullopt;
  return number;
}

std::vector<fs::path> entries_of(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    entries.push_back(it->path());
  }
  return entries;
}

/// The media device that a video node's driver has registered beside it.
std::optional<std::string> media_node_of(const std::string& path) {
  std::error_code error;
  const fs::path node = fs::canonical(path, error);
  if (error) return std::nullopt;
  for (const fs::path& entry : entries_of("/sys/class/video4linux" / node.filename() / "device")) {
    const std::string name = entry.filename();
    if (number_of(name, "media")) return "/dev/" + name;
  }
  return std::nullopt;
}

struct MediaGraph {
  std::vector<media_v2_entity> entities;
  std::vector<media_v2_interface> interfaces;
  std::vector<media_v2_link> links;
};

template <typename T>
std::uint64_t address_of(std::vector<T>& list) {
  return reinterpret_cast<std::uint64_t>(list.data());
}

/// Asked twice, as the kernel has it (media-ioc-g-topology): for the counts, then for the lists.
std::optional<MediaGraph> read_graph(int media) {
  media_v2_topology topology{};
  if (retry_ioctl(media, MEDIA_IOC_G_TOPOLOGY, &topology) != 0) return std::nullopt;
  MediaGraph graph;
  graph.entities.resize(topology.num_entities);
  graph.interfaces.resize(topology.num_interfaces);
  graph.links.resize(topology.num_links);
  topology.ptr_entities = address_of(graph.entities);
  topology.ptr_interfaces = address_of(graph.interfaces);
  topology.ptr_links = address_of(graph.links);
  topology.num_pads = 0;
  if (retry_ioctl(media, MEDIA_IOC_G_TOPOLOGY, &topology) != 0) return std::nullopt;
  return graph;
}

/// The only sensor's interface, which a link joins to it.
std::optional<media_v2_intf_devnode> sensor_node(const MediaGraph& graph) {
  const auto is_sensor = [](const media_v2_entity& e) {
    return e.function == MEDIA_ENT_F_CAM_SENSOR;
  };
  if (std::ranges::count_if(graph.entities, is_sensor) != 1) return std::nullopt;
  const std::uint32_t sensor = std::ranges::find_if(graph.entities, is_sensor)->id;
  for (const media_v2_link& link : graph.links) {
    constexpr auto kTypeMask = static_cast<std::uint32_t>(MEDIA_LNK_FL_LINK_TYPE);
    const bool is_interface = (link.flags & kTypeMask) == MEDIA_LNK_FL_INTERFACE_LINK;
    if (!is_interface || link.sink_id != sensor) continue;
    const std::uint32_t id = link.source_id;
    const auto found = std::ranges::find_if(
        graph.interfaces, [id](const media_v2_interface& i) { return i.id == id; });
    if (found != graph.interfaces.end()) return found->devnode;
  }
  return std::nullopt;
}

/// Under /dev, by the name that the kernel gave it.
std::optional<std::string> path_of(const media_v2_intf_devnode& node) {
  std::ifstream file(fmt::format("/sys/dev/char/{}:{}/uevent", std::uint32_t{node.major},
                                 std::uint32_t{node.minor}));
  constexpr std::string_view kKey = "DEVNAME=";
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with(kKey)) return "/dev/" + line.substr(kKey.size());
  }
  return std::nullopt;
}

bool holds_open(const fs::path& process, const fs::path& node) {
  return std::ranges::any_of(entries_of(process / "fd"), [&](const fs::path& entry) {
    std::error_code error;
    return fs::read_symlink(entry, error) == node;
  });
}

class KernelSystem final : public V4l2System {
 public:
  [[nodiscard]] std::vector<std::string> nodes() const override {
    std::vector<std::pair<int, std::string>> found;
    for (const fs::path& entry : entries_of("/dev")) {
      if (const auto number = number_of(entry.filename().string(), "video")) {
        found.emplace_back(*number, entry.string());
      }
    }
    std::ranges::sort(found);
    std::vector<std::string> paths;
    paths.reserve(found.size());
    for (auto& [number, path] : found) paths.push_back(std::move(path));
    return paths;
  }

  [[nodiscard]] Result<std::unique_ptr<V4l2Device>> open(const std::string& path) const override {
    if (auto device = open_device(path)) return device;
    return bad_input(path + ": " + why_not_open(path, errno));
  }

  [[nodiscard]] std::unique_ptr<V4l2Device> open_sensor(const std::string& path) const override {
    const auto media_path = media_node_of(path);
    if (!media_path) return nullptr;
    const Descriptor media = open_node(*media_path);
    const auto graph = media.is_open() ? read_graph(media.get()) : std::nullopt;
    const auto node = graph ? sensor_node(*graph) : std::nullopt;
    const auto sensor_path = node ? path_of(*node) : std::nullopt;
    return sensor_path ? open_device(*sensor_path) : nullptr;
  }

  [[nodiscard]] std::string users_of(const std::string& path) const override {
    std::error_code error;
    const fs::path node = fs::canonical(path, error);
    if (error) return {};
    std::string users;
    for (const fs::path& process : entries_of("/proc")) {
      const auto pid = number_of(process.filename().string(), "");
      if (!pid || *pid == ::getpid() || !holds_open(process, node)) continue;
      std::ifstream comm(process / "comm");
      std::string name;
      std::getline(comm, name);
      users += fmt::format("{}{} (pid {})", users.empty() ? "" : ", ", name, *pid);
    }
    return users;
  }
};

}  // namespace

std::shared_ptr<const V4l2System> kernel_v4l2() {
  return std::make_shared<KernelSystem>();
}

}  // namespace gimbal
