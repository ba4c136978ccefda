#include "drivers/replay/import/mp4.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <limits>
#include <optional>
#include <span>
#include <system_error>
#include <utility>

namespace gimbal {

namespace {

constexpr std::size_t kShortHeader = 8;
constexpr std::size_t kLongHeader = 16;
constexpr std::size_t kFullBoxHeader = 4;  ///< version and flags, before a full box's fields
constexpr std::uint64_t kLargestMoov = std::uint64_t{256} << 20;
constexpr std::uint32_t kMostSamples = 1 << 22;  ///< 19 hours of pictures at 60 a second
constexpr std::uint32_t kLargestSample = std::uint32_t{64} << 20;

struct Box {
  FourCc type = 0;
  ByteView content;
};

/// The box at `offset` and where the next begins; nothing if it does not fit into `bytes`.
std::optional<std::pair<Box, std::size_t>> read_box(ByteView bytes, std::size_t offset) {
  const auto short_size = bytes.u32(offset);
  const auto type = bytes.u32(offset + 4);
  if (!short_size || !type) return std::nullopt;
  std::uint64_t size = *short_size;
  std::size_t header = kShortHeader;
  if (*short_size == 0) size = bytes.size() - offset;  // reaches to the end
  if (*short_size == 1) {
    const auto long_size = bytes.u64(offset + kShortHeader);
    if (!long_size) return std::nullopt;
    size = *long_size;
    header = kLongHeader;
  }
  if (size < header || size > bytes.size() - offset) return std::nullopt;
  const std::size_t content_size = static_cast<std::size_t>(size) - header;
  return std::pair(Box{*type, *bytes.part(offset + header, content_size)},
                   offset + static_cast<std::size_t>(size));
}

std::vector<Box> children_of(ByteView content) {
  std::vector<Box> boxes;
  std::size_t offset = 0;
  while (const auto box = read_box(content, offset)) {
    boxes.push_back(box->first);
    offset = box->second;
  }
  return boxes;
}

std::optional<ByteView> find(ByteView content, FourCc type) {
  for (const Box& box : children_of(content)) {
    if (box.type == type) return box.content;
  }
  return std::nullopt;
}

/// Content of the box that `path` leads to.
std::optional<ByteView> find(ByteView content, std::initializer_list<FourCc> path) {
  std::optional<ByteView> at = content;
  for (const FourCc type : path) {
    if (!at) return std::nullopt;
    at = find(*at, type);
  }
  return at;
}

/// A full box's table: how many entries it says it has, as far as they fit into it.
struct Table {
  ByteView entries;
  std::size_t count = 0;
};

std::optional<Table> table_of(ByteView content, std::size_t header, std::size_t entry_size) {
  const auto count = content.u32(header - 4);
  if (!count) return std::nullopt;
  const ByteView entries = content.from(header);
  if (*count > entries.size() / entry_size) return std::nullopt;
  return Table{entries, *count};
}

std::optional<std::vector<std::uint32_t>> sample_sizes(ByteView stbl, std::uint64_t file_size) {
  const auto stsz = find(stbl, four_cc("stsz"));
  if (!stsz) return std::nullopt;
  const auto common_size = stsz->u32(kFullBoxHeader);
  const auto count = stsz->u32(kFullBoxHeader + 4);
  if (!common_size || !count || *count > kMostSamples) return std::nullopt;
  if (*common_size > 0) {
    if (*count > file_size / *common_size) return std::nullopt;
    return std::vector<std::uint32_t>(*count, *common_size);
  }
  const auto table = table_of(*stsz, kFullBoxHeader + 8, 4);
  if (!table) return std::nullopt;
  std::vector<std::uint32_t> sizes(table->count);
  for (std::size_t i = 0; i < sizes.size(); ++i) sizes[i] = *table->entries.u32(4 * i);
  return sizes;
}

std::optional<std::vector<std::uint64_t>> chunk_offsets(ByteView stbl) {
  std::vector<std::uint64_t> offsets;
  if (const auto stco = find(stbl, four_cc("stco"))) {
    const auto table = table_of(*stco, kFullBoxHeader + 4, 4);
    if (!table) return std::nullopt;
    for (std::size_t i = 0; i < table->count; ++i) offsets.push_back(*table->entries.u32(4 * i));
    return offsets;
  }
  const auto co64 = find(stbl, four_cc("co64"));
  const auto table = co64 ? table_of(*co64, kFullBoxHeader + 4, 8) : std::nullopt;
  if (!table) return std::nullopt;
  for (std::size_t i = 0; i < table->count; ++i) offsets.push_back(*table->entries.u64(8 * i));
  return offsets;
}

/// Samples in each of `chunk_count` chunks, from the runs of stsc.
std::optional<std::vector<std::uint32_t>> samples_per_chunk(ByteView stbl,
                                                            std::size_t chunk_count) {
  const auto stsc = find(stbl, four_cc("stsc"));
  const auto table = stsc ? table_of(*stsc, kFullBoxHeader + 4, 12) : std::nullopt;
  if (!table) return std::nullopt;
  std::vector<std::uint32_t> counts(chunk_count, 0);
  for (std::size_t run = 0; run < table->count; ++run) {
    const std::uint32_t first = *table->entries.u32(12 * run);
    const std::uint64_t next = run + 1 < table->count ? *table->entries.u32(12 * (run + 1))
                                                      : std::uint64_t{chunk_count} + 1;
    if (first == 0 || next < first) return std::nullopt;
    for (std::uint64_t chunk = first; chunk < next && chunk <= chunk_count; ++chunk) {
      counts[static_cast<std::size_t>(chunk) - 1] = *table->entries.u32(12 * run + 4);
    }
  }
  return counts;
}

bool place_samples(ByteView stbl, std::uint64_t file_size, std::vector<Mp4Sample>& samples) {
  const auto sizes = sample_sizes(stbl, file_size);
  const auto offsets = chunk_offsets(stbl);
  const auto counts = offsets ? samples_per_chunk(stbl, offsets->size()) : std::nullopt;
  if (!sizes || !counts) return false;
  samples.reserve(sizes->size());
  for (std::size_t chunk = 0; chunk < counts->size(); ++chunk) {
    std::uint64_t offset = (*offsets)[chunk];
    for (std::uint32_t i = 0; i < (*counts)[chunk] && samples.size() < sizes->size(); ++i) {
      const std::uint32_t size = (*sizes)[samples.size()];
      if (offset > file_size || size > file_size - offset) return false;
      samples.push_back({offset, size, {}, {}});
      offset += size;
    }
  }
  return samples.size() == sizes->size();
}

/// Ticks of a clock as nanoseconds, nearest; nothing if that does not fit.
std::optional<SensorDuration> from_ticks(std::uint64_t ticks, std::uint32_t per_second) {
  constexpr std::uint64_t kNanoseconds = 1'000'000'000;
  const std::uint64_t seconds = ticks / per_second;
  if (seconds > std::numeric_limits<std::int64_t>::max() / kNanoseconds - 1) return std::nullopt;
  const std::uint64_t rest = ticks % per_second * kNanoseconds;
  return SensorDuration(seconds * kNanoseconds + (rest + per_second / 2) / per_second);
}

bool time_samples(ByteView stbl, std::uint32_t ticks_per_second, std::vector<Mp4Sample>& samples) {
  const auto stts = find(stbl, four_cc("stts"));
  const auto table = stts ? table_of(*stts, kFullBoxHeader + 4, 8) : std::nullopt;
  if (!table) return false;
  std::uint64_t ticks = 0;
  std::size_t next = 0;
  for (std::size_t run = 0; run < table->count; ++run) {
    const std::uint32_t count = *table->entries.u32(8 * run);
    const std::uint32_t step = *table->entries.u32(8 * run + 4);
    for (std::uint32_t i = 0; i < count && next < samples.size(); ++i, ++next, ticks += step) {
      const auto begin = from_ticks(ticks, ticks_per_second);
      const auto end = from_ticks(ticks + step, ticks_per_second);
      if (!begin || !end) return false;
      samples[next].time = *begin;
      samples[next].duration = *end - *begin;
    }
  }
  return next == samples.size();
}

/// Units of the track's clock in a second; mdhd has longer fields before it in version 1.
std::optional<std::uint32_t> ticks_per_second(ByteView mdia) {
  const auto mdhd = find(mdia, four_cc("mdhd"));
  const auto version = mdhd ? mdhd->u8(0) : std::nullopt;
  if (!version) return std::nullopt;
  const auto ticks = mdhd->u32(kFullBoxHeader + (*version == 1 ? 16 : 8));
  return ticks && *ticks > 0 ? ticks : std::nullopt;
}

/// Format and, for video, size of the first sample description.
void describe(ByteView stbl, Mp4Track& track) {
  constexpr std::size_t kFirstEntry = kFullBoxHeader + 4;
  constexpr std::size_t kFormat = kFirstEntry + 4;
  constexpr std::size_t kWidth = kFirstEntry + 32;
  const auto stsd = find(stbl, four_cc("stsd"));
  if (!stsd) return;
  track.format = stsd->u32(kFormat).value_or(0);
  if (track.handler != four_cc("vide")) return;
  track.size = {stsd->u16(kWidth).value_or(0), stsd->u16(kWidth + 2).value_or(0)};
}

std::optional<Mp4Track> read_track(ByteView trak, std::uint64_t file_size) {
  const auto mdia = find(trak, four_cc("mdia"));
  const auto stbl = find(trak, {four_cc("mdia"), four_cc("minf"), four_cc("stbl")});
  const auto hdlr = mdia ? find(*mdia, four_cc("hdlr")) : std::nullopt;
  const auto ticks = mdia ? ticks_per_second(*mdia) : std::nullopt;
  if (!stbl || !hdlr || !ticks) return std::nullopt;
  Mp4Track track;
  track.handler = hdlr->u32(kFullBoxHeader + 4).value_or(0);
  describe(*stbl, track);
  if (!place_samples(*stbl, file_size, track.samples)) return std::nullopt;
  if (!time_samples(*stbl, *ticks, track.samples)) return std::nullopt;
  return track;
}

std::optional<std::vector<std::uint8_t>> read_range(std::ifstream& file, std::uint64_t offset,
                                                    std::uint64_t size) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(size));
  file.clear();
  file.seekg(static_cast<std::streamoff>(offset));
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (!file) return std::nullopt;
  return bytes;
}

/// Where a box of the file begins and ends, without reading what is in it.
struct FileBox {
  FourCc type = 0;
  std::uint64_t content = 0;
  std::uint64_t end = 0;
};

std::optional<FileBox> read_file_box(std::ifstream& file, std::uint64_t offset,
                                     std::uint64_t file_size) {
  const std::uint64_t available = std::min<std::uint64_t>(kLongHeader, file_size - offset);
  const auto bytes = read_range(file, offset, available);
  if (!bytes) return std::nullopt;
  const ByteView header{std::span(*bytes)};
  const auto short_size = header.u32(0);
  const auto type = header.u32(4);
  if (!short_size || !type) return std::nullopt;
  const std::uint64_t size = *short_size == 0   ? file_size - offset
                             : *short_size == 1 ? header.u64(kShortHeader).value_or(0)
                                                : *short_size;
  const std::size_t header_size = *short_size == 1 ? kLongHeader : kShortHeader;
  if (size < header_size || size > file_size - offset) return std::nullopt;
  return FileBox{*type, offset + header_size, offset + size};
}

std::optional<std::vector<std::uint8_t>> read_moov(std::ifstream& file, std::uint64_t file_size) {
  std::uint64_t offset = 0;
  while (offset < file_size) {
    const auto box = read_file_box(file, offset, file_size);
    if (!box) return std::nullopt;
    if (box->type == four_cc("moov")) {
      const std::uint64_t size = box->end - box->content;
      return size <= kLargestMoov ? read_range(file, box->content, size) : std::nullopt;
    }
    offset = box->end;
  }
  return std::nullopt;
}

}  // namespace

Result<std::vector<Mp4Track>> read_mp4_tracks(const std::filesystem::path& path) {
  std::error_code error;
  const std::uint64_t file_size = std::filesystem::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  if (error || !file) return bad_input(fmt::format("{}: cannot be read", path.string()));
  const auto moov = read_moov(file, file_size);
  if (!moov) {
    return bad_input(fmt::format("{}: no moov box; is this an MP4, and was its recording finished?",
                                 path.string()));
  }
  std::vector<Mp4Track> tracks;
  for (const Box& box : children_of(ByteView(std::span(*moov)))) {
    if (box.type != four_cc("trak")) continue;
    if (auto track = read_track(box.content, file_size)) tracks.push_back(std::move(*track));
  }
  return tracks;
}

bool looks_like_mp4(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;
  std::ifstream file(path, std::ios::binary);
  const auto start = read_range(file, 0, kShortHeader);
  if (!start) return false;
  const FourCc type = ByteView(std::span(*start)).u32(4).value_or(0);
  constexpr std::array<FourCc, 5> kFirstBoxes{four_cc("ftyp"), four_cc("moov"), four_cc("mdat"),
                                              four_cc("wide"), four_cc("free")};
  return std::find(kFirstBoxes.begin(), kFirstBoxes.end(), type) != kFirstBoxes.end();
}

Result<std::vector<std::uint8_t>> read_mp4_sample(const std::filesystem::path& path,
                                                  const Mp4Sample& sample) {
  std::ifstream file(path, std::ios::binary);
  auto bytes = sample.size <= kLargestSample && file ? read_range(file, sample.offset, sample.size)
                                                     : std::nullopt;
  if (bytes) return std::move(*bytes);
  return bad_input(
      fmt::format("{}: {} bytes at {} cannot be read", path.string(), sample.size, sample.offset));
}

}  // namespace gimbal
