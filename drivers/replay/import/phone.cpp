#include "drivers/replay/import/phone.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace gimbal {

namespace {

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return text;
}

bool is_video(const std::filesystem::path& path) {
  constexpr std::array<std::string_view, 4> kExtensions{".mkv", ".mp4", ".m4v", ".mov"};
  const std::string extension = lower_case(path.extension().string());
  return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

}  // namespace

Eigen::Matrix3d R_landscape_camera_phone() {
  Eigen::Matrix3d R;
  R << 0, -1, 0,  //
      -1, 0, 0,   //
      0, 0, -1;
  return R;
}

std::filesystem::path find_video(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> videos;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (is_video(entry->path())) videos.push_back(entry->path());
  }
  const auto first = std::min_element(videos.begin(), videos.end());
  return first == videos.end() ? std::filesystem::path() : *first;
}

}  // namespace gimbal
