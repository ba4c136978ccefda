#include "daemon/record_controls.hpp"

#include <chrono>
#include <utility>

#include "daemon/journal.hpp"
#include "drivers/clock/monotonic_now.hpp"
#include "drivers/gpio/gpio_edges.hpp"

namespace gimbal {
namespace {

constexpr std::chrono::milliseconds kLook{100};
constexpr unsigned kLooksABlink = 5;  // half a second on, half a second off

Result<std::unique_ptr<Button>> open_button(const GpioSettings& settings) {
  if (settings.record_button.empty()) return nullptr;
  const auto address = parse_gpio_address(settings.record_button);
  if (!address) return tl::unexpected(address.error());
  // A button that pulls to ground wants something that pulls up.
  const bool is_active_low = settings.record_button_polarity == GpioPolarity::active_low;
  auto button = std::make_unique<Button>(
      open_gpio_edges({.address = *address,
                       .edges = GpioEdges::both,
                       .bias = is_active_low ? GpioBias::pull_up : GpioBias::pull_down,
                       .polarity = settings.record_button_polarity}));
  if (auto started = button->start(); !started) return tl::unexpected(started.error());
  return button;
}

Result<std::unique_ptr<GpioOutput>> open_light(const GpioSettings& settings) {
  if (settings.status_led.empty()) return nullptr;
  const auto address = parse_gpio_address(settings.status_led);
  if (!address) return tl::unexpected(address.error());
  return GpioOutput::open({.address = *address, .polarity = settings.status_led_polarity});
}

}  // namespace

Result<std::unique_ptr<RecordControls>> RecordControls::start(const GpioSettings& settings,
                                                              Recorder& recorder) {
  auto button = open_button(settings);
  if (!button) return tl::unexpected(button.error());
  auto light = open_light(settings);
  if (!light) return tl::unexpected(light.error());
  if (!*button && !*light) return nullptr;
  return std::make_unique<RecordControls>(*std::move(button), *std::move(light), recorder);
}

RecordControls::RecordControls(std::unique_ptr<Button> button, std::unique_ptr<GpioOutput> light,
                               Recorder& recorder)
    : button_(std::move(button)),
      light_(std::move(light)),
      recorder_(recorder),
      is_watched_(button_ != nullptr) {
  thread_ = std::thread([this] { run(); });
}

RecordControls::~RecordControls() {
  stops_ = true;
  if (button_) button_->stop();
  thread_.join();
  if (light_) static_cast<void>(light_->set(GpioLevel::inactive));
}

void RecordControls::run() {
  while (!stops_) {
    if (wait_for_press()) toggle();
    show(recorder_.status());
    ++looks_;
  }
}

bool RecordControls::wait_for_press() {
  if (!is_watched_) {
    std::this_thread::sleep_for(kLook);
    return false;
  }
  const auto press = button_->wait_for_press(monotonic_now() + kLook);
  if (press) return *press && **press > settled_ && !stops_;
  log_line(LogLevel::error, "record button: " + press.error().message + "; it is not watched",
           {"gpio", "record_button"});
  is_watched_ = false;
  return false;
}

/// Presses while it took its time were impatience, not wishes.
void RecordControls::toggle() {
  begin_or_end();
  settled_ = monotonic_now();
}

void RecordControls::begin_or_end() {
  if (recorder_.status().is_recording) {
    const auto ended = recorder_.stop();
    if (!ended)
      log_line(LogLevel::error, "record button: " + ended.error().message,
               {"gpio", "record_button"});
    return;
  }
  const auto begun = recorder_.start();
  if (!begun)
    log_line(LogLevel::error, "record button: " + begun.error().message, {"gpio", "record_button"});
}

void RecordControls::show(const RecordingStatus& recording) {
  if (!light_) return;
  const bool is_on =
      recording.is_recording || (!recording.failure.empty() && looks_ / kLooksABlink % 2 == 0);
  const GpioLevel level = is_on ? GpioLevel::active : GpioLevel::inactive;
  if (shown_ == level) return;
  shown_ = level;
  if (const auto set = light_->set(level); !set) {
    log_line(LogLevel::error, "status light: " + set.error().message, {"gpio", "status_led"});
  }
}

}  // namespace gimbal
