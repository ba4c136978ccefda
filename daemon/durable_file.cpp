#include "daemon/durable_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace gimbal {
namespace {

constexpr std::chrono::milliseconds kUnsynced{500};
constexpr mode_t kMode = 0644;

tl::unexpected<Error> failure(const std::filesystem::path& path) {
  return failed(fmt::format("{}: {}", path.string(), std::strerror(errno)));
}

Result<void> write_all(int descriptor, std::string_view text, const std::filesystem::path& path) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return failure(path);
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return {};
}

}  // namespace

Result<DurableFile> DurableFile::create(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kMode);
  if (descriptor < 0) return failure(path);
  return DurableFile(path, descriptor);
}

DurableFile::DurableFile(std::filesystem::path path, int descriptor)
    : path_(std::move(path)), descriptor_(descriptor) {}

DurableFile::DurableFile(DurableFile&& other) noexcept
    : path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      held_(std::move(other.held_)),
      last_sync_(other.last_sync_) {}

DurableFile::~DurableFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<void> DurableFile::append(std::string_view lines) {
  held_ += lines;
  const bool is_due = std::chrono::steady_clock::now() - last_sync_ >= kUnsynced;
  return is_due ? sync() : Result<void>{};
}

Result<void> DurableFile::sync() {
  last_sync_ = std::chrono::steady_clock::now();
  auto written = write_all(descriptor_, std::exchange(held_, {}), path_);
  if (written && ::fdatasync(descriptor_) != 0) return failure(path_);
  return written;
}

Result<void> replace_file(const std::filesystem::path& path, std::string_view text) {
  std::filesystem::path temporary = path;
  temporary += ".new";
  std::error_code error;
  std::filesystem::remove(temporary, error);
  auto file = DurableFile::create(temporary);
  if (!file) return tl::unexpected(file.error());
  auto written = file->append(text).and_then([&] { return file->sync(); });
  if (!written) {
    std::filesystem::remove(temporary, error);
    return written;
  }
  if (::rename(temporary.c_str(), path.c_str()) != 0) return failure(path);
  const std::filesystem::path folder = path.parent_path();
  return sync_to_disk(folder.empty() ? "." : folder);
}

Result<void> sync_to_disk(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return failure(path);
  const int status = ::fsync(descriptor);
  const int reason = errno;
  ::close(descriptor);
  errno = reason;
  return status == 0 ? Result<void>{} : failure(path);
}

}  // namespace gimbal
