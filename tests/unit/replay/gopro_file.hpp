#pragma once

#include <bit>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gimbal::test {

/// Big-endian bytes, written from the formats' descriptions: shares nothing with the reader.
inline std::string bytes_of(std::uint64_t value, int size) {
  std::string out;
  for (int shift = 8 * (size - 1); shift >= 0; shift -= 8) {
    out += static_cast<char>(value >> shift & 0xff);
  }
  return out;
}

inline std::string u16(std::uint64_t value) {
  return bytes_of(value, 2);
}
inline std::string u32(std::uint64_t value) {
  return bytes_of(value, 4);
}
inline std::string u64(std::uint64_t value) {
  return bytes_of(value, 8);
}
inline std::string f32(float value) {
  return u32(std::bit_cast<std::uint32_t>(value));
}

inline std::string box(std::string_view type, const std::string& content) {
  return u32(content.size() + 8) + std::string(type) + content;
}

/// Key, type, size of a sample, number of samples, data padded to four.
inline std::string klv(std::string_view key, char type, std::size_t sample_size,
                       const std::string& data) {
  std::string out = std::string(key) + type + static_cast<char>(sample_size) +
                    u16(data.size() / sample_size) + data;
  out.resize((out.size() + 3) / 4 * 4);
  return out;
}

inline std::string nested(std::string_view key, const std::string& content) {
  return std::string(key) + '\0' + '\1' + u16(content.size()) + content;
}

inline std::string shorts(std::initializer_list<std::int16_t> values) {
  std::string out;
  for (const std::int16_t value : values) out += u16(static_cast<std::uint16_t>(value));
  return out;
}

struct GoProTrack {
  std::string handler;
  std::string format;
  std::uint32_t ticks_per_second = 1;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> durations;  ///< samples, ticks each
  std::vector<std::string> samples;
};

/// One chunk holds all samples of a track; its bytes are at `offset` of the file.
inline std::string trak_box(const GoProTrack& track, std::size_t offset) {
  const std::string description = u32(0) + u32(1) + u32(86) + track.format + std::string(24, '\0') +
                                  u16(848) + u16(480) + std::string(50, '\0');
  std::string sizes = u32(0) + u32(0) + u32(track.samples.size());
  for (const std::string& sample : track.samples) sizes += u32(sample.size());
  std::string durations = u32(0) + u32(track.durations.size());
  for (const auto& [count, ticks] : track.durations) durations += u32(count) + u32(ticks);
  const std::string stbl =
      box("stbl", box("stsd", description) + box("stts", durations) + box("stsz", sizes) +
                      box("stsc", u32(0) + u32(1) + u32(1) + u32(track.samples.size()) + u32(1)) +
                      box("stco", u32(0) + u32(1) + u32(offset)));
  const std::string mdhd =
      box("mdhd", u32(0) + u32(0) + u32(0) + u32(track.ticks_per_second) + u32(0) + u32(0));
  const std::string hdlr =
      box("hdlr", u32(0) + u32(0) + track.handler + std::string(12, '\0') + "name");
  return box("trak",
             box("tkhd", std::string(84, '\0')) + box("mdia", mdhd + hdlr + box("minf", stbl)));
}

/// ftyp, mdat with the samples of all tracks, moov.
inline std::string mp4_file(const std::vector<GoProTrack>& tracks) {
  std::string file = box("ftyp", "mp41" + u32(0));
  std::string data;
  std::vector<std::size_t> offsets;
  for (const GoProTrack& track : tracks) {
    offsets.push_back(file.size() + 8 + data.size());
    for (const std::string& sample : track.samples) data += sample;
  }
  file += box("mdat", data);
  std::string moov = box("mvhd", std::string(100, '\0'));
  for (std::size_t i = 0; i < tracks.size(); ++i) moov += trak_box(tracks[i], offsets[i]);
  return file + box("moov", moov);
}

}  // namespace gimbal::test
