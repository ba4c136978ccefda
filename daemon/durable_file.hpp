#pragma once

#include <chrono>
#include <filesystem>
#include <string_view>

#include "pipeline/sample/result.hpp"

namespace gimbal {

/// A text that grows, of which no more than the last half second is lost when the power fails.
class DurableFile {
 public:
  /// Fails if the file exists already.
  [[nodiscard]] static Result<DurableFile> create(const std::filesystem::path& path);

  DurableFile(DurableFile&& other) noexcept;
  DurableFile& operator=(DurableFile&&) = delete;
  ~DurableFile();

  /// Whole lines; they are on the disk together or not at all, unless the disk is full.
  [[nodiscard]] Result<void> append(std::string_view lines);

  /// Writes what is held and has the disk confirm it.
  [[nodiscard]] Result<void> sync();

 private:
  DurableFile(std::filesystem::path path, int descriptor);

  std::filesystem::path path_;
  int descriptor_;
  std::string held_;
  std::chrono::steady_clock::time_point last_sync_;
};

/// Puts a text in a file's place so that either the old or the new one is there, whatever happens.
[[nodiscard]] Result<void> replace_file(const std::filesystem::path& path, std::string_view text);

/// Has the disk confirm what a file, or a folder's list of names, holds.
[[nodiscard]] Result<void> sync_to_disk(const std::filesystem::path& path);

}  // namespace gimbal
