#include "daemon/output_keys.hpp"

#include <array>
#include <chrono>
#include <string>

namespace gimbal {
namespace {

constexpr int kLargestPort = 65535;
constexpr int kSlowestBitrate_kbps = 50;
constexpr int kFastestBitrate_kbps = 200'000;
constexpr int kShortestSegment_s = 1;
constexpr int kLongestSegment_s = 86400;
constexpr int kMostFiles = 1'000'000;

enum class StdoutForm { y4m, raw };
constexpr std::array<NamedValue<StdoutForm>, 2> kStdoutForms{
    {{"y4m", StdoutForm::y4m}, {"raw", StdoutForm::raw}}};

template <typename T>
void take(std::optional<T> given, T& value) {
  if (given) value = *std::move(given);
}

void take_path(std::optional<std::string> given, std::filesystem::path& value) {
  if (given) value = *std::move(given);
}

/// A key without which the preset makes no sense.
void demand(TomlTable& table, std::string_view key, const char* example) {
  if (!table.has(key)) {
    table.refuse(key, std::string("is missing: give one, such as ") + example);
  }
}

OutputSettings read_stdout(TomlTable& table) {
  const auto form = table.choice<StdoutForm>("format", kStdoutForms);
  if (form == StdoutForm::raw) return RawStdoutOutput{};
  return TextOutput{"-"};
}

OutputSettings read_pipeline(TomlTable& table) {
  TextOutput output;
  demand(table, "text", "\"videoconvert ! autovideosink\"");
  take(table.text("text"), output.text);
  if (!output.text.empty() && output.text.find(" ! ") == std::string::npos) {
    table.refuse(
        "text", "has no \" ! \" in it: two elements at least, such as \"videoconvert ! fakesink\"");
  }
  return output;
}

OutputSettings read_segments(TomlTable& table) {
  SegmentOutput output;
  demand(table, "folder", "\"/var/lib/gimbald/video\"");
  take_path(table.text("folder"), output.folder);
  if (const auto length = table.integer("segment_s", kShortestSegment_s, kLongestSegment_s)) {
    output.length = std::chrono::seconds(*length);
  }
  take(table.integer("keep", 0, kMostFiles), output.kept);
  take(table.text("audio"), output.audio);
  return output;
}

OutputSettings read_rtsp(TomlTable& table) {
  RtspOutput output;
  take(table.text("address"), output.address);
  take(table.integer("port", 1, kLargestPort), output.port);
  take(table.text("path"), output.path);
  if (!output.path.starts_with('/')) table.refuse("path", "must begin with /");
  take(table.integer("bitrate_kbps", kSlowestBitrate_kbps, kFastestBitrate_kbps),
       output.bitrate_kbps);
  take(table.text("audio"), output.audio);
  return output;
}

OutputSettings read_udp(TomlTable& table) {
  UdpOutput output;
  take(table.text("host"), output.host);
  take(table.integer("port", 1, kLargestPort), output.port);
  take(table.integer("bitrate_kbps", kSlowestBitrate_kbps, kFastestBitrate_kbps),
       output.bitrate_kbps);
  return output;
}

OutputSettings read_loopback(TomlTable& table) {
  LoopbackOutput output;
  demand(table, "device", "\"/dev/video9\"");
  take_path(table.text("device"), output.device);
  return output;
}

OutputSettings read_shm(TomlTable& table) {
  ShmOutput output;
  demand(table, "socket", "\"/run/gimbald/video\"");
  take_path(table.text("socket"), output.socket);
  return output;
}

OutputSettings read_display(TomlTable& /*table*/) {
  return DisplayOutput{};
}

using Reader = OutputSettings (*)(TomlTable&);
constexpr std::array<NamedValue<Reader>, 8> kPresets{{{"stdout", read_stdout},
                                                      {"file", read_segments},
                                                      {"rtsp", read_rtsp},
                                                      {"udp", read_udp},
                                                      {"v4l2loopback", read_loopback},
                                                      {"shm", read_shm},
                                                      {"display", read_display},
                                                      {"pipeline", read_pipeline}}};

}  // namespace

std::optional<OutputSettings> read_output(TomlTable& table) {
  demand(table, "preset", "\"rtsp\"");
  const auto read = table.choice<Reader>("preset", kPresets);
  if (!read) return std::nullopt;
  OutputSettings output = (*read)(table);
  if (table.error()) return std::nullopt;
  return output;
}

}  // namespace gimbal
