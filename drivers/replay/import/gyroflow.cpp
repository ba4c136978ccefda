#include <utility>

#include "drivers/replay/gcsv.hpp"
#include "drivers/replay/import/importer.hpp"

namespace gimbal {

namespace {

Result<Session> read_recording(const std::filesystem::path& input) {
  auto recording = read_gyroflow_recording(input, gcsv_beside(input));
  if (!recording) return tl::unexpected(recording.error());
  auto& [session, logs] = *recording;
  session.frames = std::move(logs.frames.samples);
  session.gyro = std::move(logs.gyro.samples);
  session.accel = std::move(logs.accel.samples);
  return std::move(session);
}

bool has_log_beside(const std::filesystem::path& input) {
  const std::filesystem::path log = gcsv_beside(input);
  return !log.empty() && log != input;
}

}  // namespace

const Importer kGyroflowImporter{"video with a Gyroflow log (.gcsv) beside it", has_log_beside,
                                 read_recording};

}  // namespace gimbal
