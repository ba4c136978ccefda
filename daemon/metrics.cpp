#include "daemon/metrics.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <iterator>
#include <string_view>

namespace gimbal {
namespace {

/// A label's value, with what would end it escaped.
std::string in_label_quotes(std::string_view value) {
  std::string quoted = "\"";
  for (const char letter : value) {
    if (letter == '\n') {
      quoted += "\\n";
      continue;
    }
    if (letter == '"' || letter == '\\') quoted += '\\';
    quoted += letter;
  }
  return quoted + '"';
}

std::string label(std::string_view name, std::string_view value) {
  return fmt::format("{}={}", name, in_label_quotes(value));
}

/// Gathers families of metrics, each with its help and type before its first sample.
class MetricsText {
 public:
  void family(std::string_view name, std::string_view type, std::string_view help) {
    name_ = fmt::format("gimbald_{}", name);
    fmt::format_to(out(), "# HELP {} {}\n# TYPE {} {}\n", name_, help, name_, type);
  }

  template <typename Number>
  void sample(Number value, std::string_view labels = "") {
    fmt::format_to(out(), "{}{} {}\n", name_, in_braces(labels), value);
  }

  void histogram(const Histogram::Counts& counts, std::string_view labels = "") {
    const std::string separator = labels.empty() ? "" : ",";
    std::uint64_t below = 0;
    for (std::size_t i = 0; i < counts.in_range.size(); ++i) {
      below += counts.in_range[i];
      const std::string end = i < Histogram::kBounds_s.size()
                                  ? fmt::format("{}", Histogram::kBounds_s[i])
                                  : std::string("+Inf");
      fmt::format_to(out(), "{}_bucket{{{}{}le=\"{}\"}} {}\n", name_, labels, separator, end,
                     below);
    }
    fmt::format_to(out(), "{}_sum{} {}\n{}_count{} {}\n", name_, in_braces(labels), counts.sum_s,
                   name_, in_braces(labels), below);
  }

  [[nodiscard]] std::string text() const { return fmt::to_string(text_); }

 private:
  static std::string in_braces(std::string_view labels) {
    return labels.empty() ? "" : fmt::format("{{{}}}", labels);
  }
  std::back_insert_iterator<fmt::memory_buffer> out() { return std::back_inserter(text_); }

  fmt::memory_buffer text_;
  std::string name_;
};

void add_frames(MetricsText& text, const LiveCounts& counts) {
  text.family("frames_in_total", "counter", "Frames that the camera delivered.");
  text.sample(counts.frames_in);
  text.family("frames_out_total", "counter", "Frames that were drawn.");
  text.sample(counts.frames_out);
  text.family("frames_dropped_total", "counter", "Frames that were not drawn, by cause.");
  text.sample(counts.dropped_without_orientation, label("cause", "no_orientation"));
  text.sample(counts.dropped_before_drawing, label("cause", "before_drawing"));
  text.sample(counts.dropped_out_of_order, label("cause", "out_of_order"));
  text.sample(counts.dropped_off_clock, label("cause", "off_clock"));
  text.family("no_signal_pictures_total", "counter", "Pictures shown while no camera delivered.");
  text.sample(counts.no_signal_pictures);
  text.family("samples_total", "counter", "Inertial samples that the IMU delivered.");
  text.sample(counts.samples);
  text.family("samples_off_clock_total", "counter",
              "Inertial samples left out, stamped more than a second from CLOCK_MONOTONIC.");
  text.sample(counts.samples_off_clock);
}

void add_source(MetricsText& text, const LiveStatus& status) {
  const auto both = [&](const char* name, const char* type, const char* help, auto value_of) {
    text.family(name, type, help);
    text.sample(value_of(status.camera), label("source", "camera"));
    text.sample(value_of(status.imu), label("source", "imu"));
  };
  both("source_up", "gauge", "Whether the source delivers.",
       [](const SourceStatus& s) { return s.obstacle.empty() ? 1 : 0; });
  both("source_restarts_total", "counter", "How often the source was brought back.",
       [](const SourceStatus& s) { return s.restarts; });
  both("source_lost_total", "counter", "Frames or samples that the device lost.",
       [](const SourceStatus& s) { return s.lost; });
  text.family("passing_through", "gauge", "Whether no samples come and nothing is stabilized.");
  text.sample(status.is_coasting ? 1 : 0);
}

void add_stages(MetricsText& text, const LiveStatus& status) {
  text.family("queue_depth", "gauge", "What waits between the stages.");
  text.sample(status.inflow_depth, label("queue", "inflow"));
  text.sample(status.frames_held, label("queue", "path"));
  text.sample(status.drawings_depth, label("queue", "drawing"));
  text.family("stage_seconds", "histogram", "Time that a stage takes for a frame.");
  text.histogram(status.follow_time, label("stage", "follow"));
  text.histogram(status.drawing_time, label("stage", "draw"));
  text.family("drawn_age_seconds", "histogram", "Age of a frame when it is drawn.");
  text.histogram(status.drawn_age);
  text.family("gyro_rate_hertz", "gauge", "Gyroscope samples a second, by their stamps.");
  text.sample(status.gyro_rate_hz);
}

void add_time_offset(MetricsText& text, const LiveStatus& status) {
  text.family("time_offset_seconds", "gauge",
              "Added to the camera's stamps to get the IMU's clock.");
  text.sample(to_seconds(status.time_offset));
  if (!status.tracked_offset) return;
  const OffsetEstimate& estimate = status.tracked_offset->estimate;
  text.family("time_offset_known", "gauge", "Whether the tracked time offset can be told.");
  text.sample(estimate.is_known ? 1 : 0);
  text.family("time_offset_tracked_seconds", "gauge", "The time offset as it is tracked.");
  text.sample(to_seconds(estimate.offset));
  text.family("time_offset_sigma_seconds", "gauge", "Standard deviation of that.");
  text.sample(to_seconds(estimate.sigma));
  text.family("time_offset_cpu_seconds_total", "counter", "Processor time that tracking it took.");
  text.sample(to_seconds(status.tracked_offset->cpu_time));
}

void add_recording(MetricsText& text, const RecordingStatus& recording) {
  text.family("recording", "gauge", "Whether a session is being recorded.");
  text.sample(recording.is_recording ? 1 : 0);
  text.family("recording_frames", "gauge", "Frames in the present or the last recording.");
  text.sample(recording.frames);
  text.family("recording_frames_dropped", "gauge", "Frames that it was too slow for.");
  text.sample(recording.frames_dropped);
}

void add_outputs(MetricsText& text, const LivePipeline& pipeline) {
  const auto each = [&](const char* name, const char* type, const char* help, auto value_of) {
    text.family(name, type, help);
    for (const auto& output : pipeline.outputs()) {
      text.sample(value_of(*output), label("output", output->name()));
    }
  };
  each("output_up", "gauge", "Whether the output takes frames.",
       [](const Output& o) { return o.state() == OutputState::working ? 1 : 0; });
  each("output_written_total", "counter", "Frames that the output took.",
       [](const Output& o) { return o.written(); });
  each("output_dropped_total", "counter", "Frames that the output was too slow for, or lost.",
       [](const Output& o) { return o.dropped(); });
  each("output_queue_depth", "gauge", "Frames that wait for the output.",
       [](const Output& o) { return o.queued(); });
  text.family("output_write_seconds", "histogram", "Time that the output takes for a frame.");
  for (const auto& output : pipeline.outputs()) {
    text.histogram(output->writing_time(), label("output", output->name()));
  }
  text.family("output_age_seconds", "histogram", "Age of a frame when the output has taken it.");
  for (const auto& output : pipeline.outputs()) {
    text.histogram(output->written_age(), label("output", output->name()));
  }
}

}  // namespace

std::string metrics_text(const Supervisor& daemon) {
  const LiveStatus status = daemon.pipeline().status();
  MetricsText text;
  add_frames(text, status.counts);
  add_source(text, status);
  add_stages(text, status);
  add_time_offset(text, status);
  add_outputs(text, daemon.pipeline());
  add_recording(text, daemon.recorder().status());
  return text.text();
}

}  // namespace gimbal
