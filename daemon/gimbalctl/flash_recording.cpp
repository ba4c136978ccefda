#include "daemon/gimbalctl/flash_recording.hpp"

#include <cstddef>
#include <optional>
#include <utility>

#include "daemon/gimbalctl/line_profiles.hpp"
#include "daemon/gimbalctl/stop_request.hpp"
#include "drivers/gpio/flasher.hpp"

namespace gimbal {
namespace {

constexpr std::size_t kFrames = 150;
/// Whose exposure may still be finding itself, and which began before the light flashed.
constexpr int kFramesPassedOver = 15;

Result<VideoFrame> next_frame(CameraSource& camera, const StopRequest& stop) {
  if (stop.came()) return failed("interrupted; the light is off");
  auto frame = camera.read();
  if (!frame) return tl::unexpected(frame.error());
  if (!*frame) return failed("the camera delivers no more pictures");
  return std::move(**frame);
}

Result<FlashRecording> record(CameraSource& camera, const Flasher& light, const StopRequest& stop,
                              ProgressStyle progress) {
  ProgressBar bar("flash", kFrames, progress);
  FlashRecording recording;
  for (int i = 0; i < kFramesPassedOver; ++i) {
    if (auto frame = next_frame(camera, stop); !frame) return tl::unexpected(frame.error());
  }
  while (recording.profiles.size() < kFrames) {
    const auto frame = next_frame(camera, stop);
    if (!frame) return tl::unexpected(frame.error());
    recording.profiles.push_back(line_profile(*frame, ReadoutDirection::top_down));
    bar.advance();
  }
  const Flasher::Record kept = light.record();
  if (kept.failure) return tl::unexpected(*kept.failure);
  recording.light_hz = kept.hz;
  recording.jitter_s = kept.jitter_s;
  recording.skipped = kept.skipped;
  return recording;
}

}  // namespace

Result<FlashRecording> record_flashes(CameraSource& camera, std::unique_ptr<GpioOutput> light,
                                      double hz, ProgressStyle progress) {
  const StopRequest stop;
  if (auto started = camera.start(); !started) return tl::unexpected(started.error());
  auto flasher = Flasher::start(std::move(light), hz);
  auto recording = flasher ? record(camera, **flasher, stop, progress)
                           : Result<FlashRecording>(tl::unexpected(flasher.error()));
  if (flasher) flasher->reset();
  camera.stop();
  return recording;
}

Result<FlashRecording> record_flashes(const CameraOptions& camera, const std::string& line,
                                      double hz, ProgressStyle progress) {
  const auto address = parse_gpio_address(line);
  if (!address) return tl::unexpected(address.error());
  auto source = make_camera(camera);
  if (!source) return tl::unexpected(source.error());
  auto light = GpioOutput::open({*address});
  if (!light) return tl::unexpected(light.error());
  return record_flashes(**source, std::move(*light), hz, progress);
}

}  // namespace gimbal
