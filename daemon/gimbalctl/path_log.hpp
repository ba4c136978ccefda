#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>

#include "pipeline/sample/result.hpp"
#include "pipeline/sample/virtual_camera.hpp"

namespace gimbal {

/// The virtual camera of every written frame, so that anyone can check the picture: a CSV file with
/// `index,t_s,qw,qx,qy,qz,fx,fy,cx,cy,border_px`. t_s is the frame's stamp as recorded, q is
/// q_world_camera, fx to cy are in pixels, border_px counts output pixels without a source.
/// World z is up; of a recording without an accelerometer the world is the real camera of the first
/// frame, in the middle of the exposure of its reference row.
class PathLog {
 public:
  [[nodiscard]] static Result<PathLog> open(const std::filesystem::path& file);

  void write(const VirtualCamera& camera, std::int64_t border_px);

  /// Fails if anything could not be written.
  [[nodiscard]] Result<void> finish();

 private:
  PathLog(std::filesystem::path file, std::ofstream stream);

  std::filesystem::path file_;
  std::ofstream stream_;
};

}  // namespace gimbal
