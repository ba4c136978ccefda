#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "daemon/gimbalctl/progress_bar.hpp"
#include "drivers/camera_source.hpp"
#include "drivers/replay/session.hpp"
#include "pipeline/intrinsics/board_detector.hpp"
#include "pipeline/intrinsics/coverage.hpp"
#include "pipeline/intrinsics/view_choice.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// Looks for a board in picture after picture, and keeps the views that are worth it.
class BoardSearch {
 public:
  BoardSearch(std::unique_ptr<BoardDetector> detector, ViewChoice::Pictures pictures)
      : detector_(std::move(detector)), pictures_(pictures) {}

  /// Whether a view of this picture was kept; bad_input for one of another size than the first.
  [[nodiscard]] Result<bool> look(const VideoFrame& frame, const std::string& name);

  [[nodiscard]] ImageSize size() const { return size_; }  ///< of the pictures; 0x0 before the first
  [[nodiscard]] int looked() const { return looked_; }
  [[nodiscard]] const std::vector<BoardView>& views() const;

  /// Whether there are views enough, of everything.
  [[nodiscard]] bool is_complete() const;

 private:
  std::unique_ptr<BoardDetector> detector_;
  ViewChoice::Pictures pictures_;
  ImageSize size_;
  int looked_ = 0;
  std::optional<ViewChoice> choice_;
};

/// Files with the pictures that a command line names.
struct PictureFiles {
  std::vector<std::filesystem::path> files;
  std::optional<Session> session;  ///< whose video the only file is
  ViewChoice::Pictures pictures = ViewChoice::Pictures::running;
};

/// From pictures, a folder of them, a video or a session folder; bad_input where there are none.
[[nodiscard]] Result<PictureFiles> find_pictures(std::span<const std::filesystem::path> sources);

/// Looks at every picture of photographs, and at some in a second of a video.
[[nodiscard]] Result<void> search_files(const PictureFiles& pictures, BoardSearch& search,
                                        ProgressStyle progress);

/// Looks through a camera, and says on standard error what is still missing, until all was shown,
/// the time is over or a signal comes.
[[nodiscard]] Result<void> search_camera(CameraSource& camera, BoardSearch& search,
                                         double longest_s, ProgressStyle progress);

}  // namespace gimbal
