#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <thread>

#include "daemon/gpio_settings.hpp"
#include "daemon/recorder.hpp"
#include "drivers/gpio/button.hpp"
#include "drivers/gpio/gpio_lines.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// What a person holds: a button that begins and ends a recording, and a light that is on while one
/// is being made and blinks when the last ended by itself. Either may be missing.
class RecordControls {
 public:
  /// Requests the lines. `recorder` lives longer.
  [[nodiscard]] static Result<std::unique_ptr<RecordControls>> start(const GpioSettings& settings,
                                                                     Recorder& recorder);

  RecordControls(std::unique_ptr<Button> button, std::unique_ptr<GpioOutput> light,
                 Recorder& recorder);
  RecordControls(const RecordControls&) = delete;
  RecordControls& operator=(const RecordControls&) = delete;
  ~RecordControls();

 private:
  void run();
  /// Whether one came within a moment.
  bool wait_for_press();
  void toggle();
  void begin_or_end();
  void show(const RecordingStatus& recording);

  std::unique_ptr<Button> button_;
  std::unique_ptr<GpioOutput> light_;
  Recorder& recorder_;
  bool is_watched_;     ///< the button, until its line fails
  SensorTime settled_;  ///< when the last press had been obeyed
  std::optional<GpioLevel> shown_;
  unsigned looks_ = 0;
  std::atomic<bool> stops_ = false;
  std::thread thread_;
};

}  // namespace gimbal
