#pragma once

#include <libcamera/libcamera.h>

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "drivers/libcamera/libcamera_camera.hpp"
#include "drivers/libcamera/picture_layout.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// A request that libcamera has completed.
struct CapturedPicture {
  std::size_t buffer = 0;
  std::uint32_t sequence = 0;
  bool is_damaged = false;
  std::optional<SensorDuration> stamp;  ///< SensorTimestamp, since its clock's epoch
  std::optional<SensorDuration> exposure;
  std::optional<SensorDuration> frame_duration;
};

/// Where a plane is mapped, and in which dma-buf it lies.
struct MappedPlane {
  ConstPlane plane;
  int fd = -1;  ///< belongs to the session
  std::ptrdiff_t offset_bytes = 0;
};

/// A camera that runs into mapped buffers. Frames may hold buffers longer than that; they hold the
/// session with them. `stop` and `give_back` may come from any thread.
class CameraSession : public std::enable_shared_from_this<CameraSession> {
 public:
  /// Acquires, sets up and starts a camera.
  [[nodiscard]] static Result<std::shared_ptr<CameraSession>> start(
      std::shared_ptr<libcamera::CameraManager> manager, std::shared_ptr<libcamera::Camera> camera,
      const LibcameraSettings& settings);

  CameraSession(const CameraSession&) = delete;
  CameraSession& operator=(const CameraSession&) = delete;
  ~CameraSession();

  [[nodiscard]] const LibcameraPictures& pictures() const { return pictures_; }
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

  /// The next picture; nothing once stopped. Fails when the camera is gone, or silent for longer
  /// than `silence_limit`. Its buffer is to be lent or given back.
  [[nodiscard]] Result<std::optional<CapturedPicture>> next(SensorDuration silence_limit);

  /// Ready to be read until the buffer is given back.
  [[nodiscard]] const std::vector<MappedPlane>& planes(std::size_t buffer) const {
    return buffers_[buffer].planes;
  }

  /// Keeps a buffer, and the session, until the last copy of what is returned goes; nothing where
  /// the camera would be left with too few to go on.
  [[nodiscard]] std::shared_ptr<const void> lend(std::size_t buffer);

  void give_back(std::size_t buffer);

  void stop();
  [[nodiscard]] bool has_stopped() const;

 private:
  struct Mapping {
    void* memory = nullptr;
    std::size_t bytes = 0;
    libcamera::SharedFD fd;  ///< kept open for who imports it
  };
  struct Buffer {
    std::vector<Mapping> mappings;
    std::vector<MappedPlane> planes;
  };

  CameraSession(std::shared_ptr<libcamera::CameraManager> manager,
                std::shared_ptr<libcamera::Camera> camera);

  [[nodiscard]] Result<void> configure(const LibcameraSettings& settings);
  [[nodiscard]] Result<void> map_buffers();
  [[nodiscard]] Result<void> map_buffer(const libcamera::FrameBuffer& buffer);
  [[nodiscard]] Result<Mapping*> mapping_of(Buffer& buffer, const libcamera::SharedFD& fd,
                                            std::size_t bytes);
  [[nodiscard]] Result<void> begin(const LibcameraSettings& settings);
  void set_rate(libcamera::ControlList& controls, double fps);
  void completed(libcamera::Request* request);
  void disconnected();
  void tear_down();

  std::shared_ptr<libcamera::CameraManager> manager_;
  LibcameraPictures pictures_;
  std::vector<std::string> warnings_;
  std::vector<Buffer> buffers_;
  libcamera::Stream* stream_ = nullptr;

  /// For what follows, and never taken by libcamera's thread: stopping waits for that thread.
  mutable std::mutex camera_mutex_;
  std::shared_ptr<libcamera::Camera> camera_;
  std::unique_ptr<libcamera::CameraConfiguration> configuration_;
  std::unique_ptr<libcamera::FrameBufferAllocator> allocator_;
  std::vector<std::unique_ptr<libcamera::Request>> requests_;
  bool is_acquired_ = false;
  bool is_running_ = false;

  mutable std::mutex mutex_;  ///< for what follows; may be taken inside of the other
  std::condition_variable changed_;
  std::deque<CapturedPicture> captured_;
  std::size_t queued_ = 0;
  bool is_stopped_ = false;
  bool is_disconnected_ = false;
};

}  // namespace gimbal
