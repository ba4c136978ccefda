#include "daemon/gimbalctl/path_log.hpp"

#include <fmt/format.h>

#include <utility>

#include "drivers/replay/decimal_time.hpp"

namespace gimbal {

Result<PathLog> PathLog::open(const std::filesystem::path& file) {
  std::ofstream stream(file);
  if (!stream) {
    return bad_input(
        fmt::format("{}: cannot write the path log (does the folder exist?)", file.string()));
  }
  stream << "index,t_s,qw,qx,qy,qz,fx,fy,cx,cy,border_px\n";
  return PathLog(file, std::move(stream));
}

PathLog::PathLog(std::filesystem::path file, std::ofstream stream)
    : file_(std::move(file)), stream_(std::move(stream)) {}

void PathLog::write(const VirtualCamera& camera, std::int64_t border_px) {
  const Eigen::Quaterniond& q = camera.q_world_camera;
  const PinholeIntrinsics& k = camera.intrinsics;
  stream_ << fmt::format("{},{},{:.9f},{:.9f},{:.9f},{:.9f},{:.4f},{:.4f},{:.4f},{:.4f},{}\n",
                         camera.stamp.index, format_seconds(camera.stamp.time.time_since_epoch()),
                         q.w(), q.x(), q.y(), q.z(), k.fx, k.fy, k.cx, k.cy, border_px);
}

Result<void> PathLog::finish() {
  stream_.close();
  if (!stream_) return failed(fmt::format("{}: the path log could not be written", file_.string()));
  return {};
}

}  // namespace gimbal
