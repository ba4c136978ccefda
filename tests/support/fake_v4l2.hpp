#pragma once

#include <linux/videodev2.h>

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "drivers/v4l2/v4l2_device.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal::test {

/// Whether pictures come at their instants, or as soon as they are waited for, on a clock that
/// jumps there.
enum class FakePace : std::uint8_t { real, simulated };

struct FakeFormat {
  std::uint32_t fourcc;
  std::vector<ImageSize> sizes;
  std::vector<std::uint32_t> rates_hz;
};

struct FakeControl {
  std::uint32_t id = 0;
  std::string name;
  std::uint32_t type = V4L2_CTRL_TYPE_INTEGER;
  std::int64_t minimum = 0;
  std::int64_t maximum = 0;
  std::int64_t value = 0;
  std::uint32_t flags = 0;
  std::map<std::int64_t, std::string> menu = {};
  /// While this control has this value, the one of that id is inactive.
  std::optional<std::pair<std::uint32_t, std::int64_t>> inactive_while = {};
};

/// What the driver says of a picture; a script may change it.
struct FakePicture {
  std::uint32_t sequence = 0;
  std::uint32_t flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  SensorDuration stamp{};
  std::optional<std::uint32_t> bytes_used;  ///< of each memory; the whole, if not set
  int dequeue_error = 0;
  bool never_comes = false;
};

/// A camera that a V4L2 driver would show, to the letter of the kernel's documents as far as the
/// driver under test goes. To be described before it is opened.
class FakeCamera : public std::enable_shared_from_this<FakeCamera> {
 public:
  std::string name = "Fake Camera";
  std::string bus = "fake:0";
  std::uint32_t capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  std::vector<FakeFormat> formats = {{V4L2_PIX_FMT_NV12, {{64, 48}}, {30}}};
  std::vector<FakeControl> controls;
  std::uint32_t field = V4L2_FIELD_NONE;
  std::uint32_t colorspace = V4L2_COLORSPACE_REC709;
  std::uint32_t stride_alignment = 1;
  bool exports_dma_buf = true;
  FakePace pace = FakePace::simulated;
  /// What each clock is ahead of CLOCK_MONOTONIC; a clock that is missing does not exist.
  std::map<KernelClock, SensorDuration> clocks = {{KernelClock::monotonic, {}}};
  /// Changes what the n-th picture since the stream began is.
  std::function<void(std::uint32_t n, FakePicture& picture)> script;
  /// Bytes of a memory of the n-th picture, if not `default_bytes`.
  std::function<std::vector<std::uint8_t>(std::uint32_t n, std::size_t memory)> content;

  /// A byte of a picture, for who has no `content`.
  [[nodiscard]] static std::uint8_t default_byte(std::uint32_t n, std::size_t memory,
                                                 std::size_t at) {
    return static_cast<std::uint8_t>(n * 17 + memory * 101 + at * 31 + at / 251);
  }

  void unplug();
  void plug_in();

  [[nodiscard]] std::size_t queued() const;
  [[nodiscard]] bool is_streaming() const;
  [[nodiscard]] std::int64_t value_of(const std::string& control) const;

  [[nodiscard]] std::unique_ptr<V4l2Device> open();

 private:
  class Device;
  struct Buffer {
    std::vector<int> memories;  ///< descriptors of memfd_create(2)
    bool is_queued = false;
  };

  [[nodiscard]] int handle(const Device* who, unsigned long code, void* argument);
  [[nodiscard]] bool has_planes() const;
  [[nodiscard]] SensorDuration now() const;
  [[nodiscard]] SensorDuration period() const;
  [[nodiscard]] const FakeFormat* find_format(std::uint32_t fourcc) const;
  [[nodiscard]] FakeControl* find_control(std::uint32_t id);
  [[nodiscard]] std::uint32_t flags_of(const FakeControl& control);

  int query_capability(v4l2_capability& capability) const;
  int list_format(v4l2_fmtdesc& listed) const;
  int list_size(v4l2_frmsizeenum& listed) const;
  int list_interval(v4l2_frmivalenum& listed) const;
  int get_format(v4l2_format& format) const;
  int set_format(v4l2_format& format);
  int parameters(v4l2_streamparm& parameters, bool is_set);
  int query_control(v4l2_query_ext_ctrl& listed);
  int query_menu(v4l2_querymenu& entry);
  int get_control(v4l2_ext_controls& all);
  int set_control(v4l2_ext_controls& all);
  int request_buffers(const Device* who, v4l2_requestbuffers& wanted);
  int query_buffer(v4l2_buffer& buffer) const;
  int export_buffer(v4l2_exportbuffer& exported) const;
  int queue_buffer(v4l2_buffer& buffer);
  int dequeue_buffer(v4l2_buffer& buffer);
  int stream(const Device* who, bool is_on);
  void free_buffers();
  [[nodiscard]] std::vector<std::uint32_t> strides() const;
  [[nodiscard]] std::vector<std::uint32_t> sizes() const;
  [[nodiscard]] V4l2Device::Wakeup wait(const Device* who, SensorDuration limit);
  void take_picture();
  void fill(std::uint32_t index);
  [[nodiscard]] std::uint8_t* map(std::size_t bytes, std::int64_t offset);

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool is_unplugged_ = false;
  const Device* owner_ = nullptr;
  std::uint32_t fourcc_ = 0;
  ImageSize size_;
  std::uint32_t rate_hz_ = 0;
  std::vector<Buffer> buffers_;
  std::deque<std::uint32_t> queue_;
  bool is_streaming_ = false;
  std::uint32_t taken_ = 0;
  SensorDuration simulated_now_ = std::chrono::hours(5);
  SensorDuration next_due_{};
  std::optional<FakePicture> ready_;
};

/// A machine with such cameras.
class FakeV4l2System final : public V4l2System {
 public:
  std::map<std::string, std::shared_ptr<FakeCamera>> cameras;  ///< by path
  std::map<std::string, std::string> refused;                  ///< by path: why
  std::shared_ptr<FakeCamera> sensor;
  std::string users;

  [[nodiscard]] std::vector<std::string> nodes() const override;
  [[nodiscard]] Result<std::unique_ptr<V4l2Device>> open(const std::string& path) const override;
  [[nodiscard]] std::unique_ptr<V4l2Device> open_sensor(const std::string& path) const override;
  [[nodiscard]] std::string users_of(const std::string&) const override { return users; }
};

}  // namespace gimbal::test
