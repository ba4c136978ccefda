#pragma once

#include <cstdint>
#include <span>

#include "pipeline/fill/composition.hpp"
#include "pipeline/sample/result.hpp"
#include "pipeline/sample/video_frame.hpp"
#include "pipeline/warp/picture_pool.hpp"
#include "pipeline/warp/warp_mesh.hpp"
#include "pipeline/warp/warper.hpp"

namespace gimbal {

/// Whether a border is drawn by BorderFill; else by the warper alone.
[[nodiscard]] constexpr bool is_filled(Border border) {
  return border == Border::blur || border == Border::fill;
}

/// Another frame, and the way from it to the picture that is drawn.
struct Neighbour {
  VideoFrame frame;
  WarpMesh mesh;
};

struct FilledPicture {
  VideoFrame picture;
  std::int64_t border_px = 0;  ///< pixels without a source
};

/// Draws a frame and what lies past its edge: from other frames first, whose tones are brought to
/// its own and which are trusted only where they show the same along the seam; what these do not
/// show becomes a blurred continuation of the picture.
///
/// The frames are drawn by a warper, the picture is put together on the CPU. Where nothing is
/// missing there is nothing to do.
class BorderFill {
 public:
  /// `neighbours`: the best first. Of each, only what is missing and the seam are drawn, and none
  /// that shows nothing of it. Fails as the warper does.
  [[nodiscard]] Result<FilledPicture> draw(Warper& warper, const VideoFrame& frame,
                                           const WarpMesh& mesh,
                                           std::span<const Neighbour> neighbours);

  /// Of all frames so far, beside what the warper copies: pictures that were changed.
  [[nodiscard]] std::int64_t bytes_copied() const { return bytes_copied_; }

 private:
  [[nodiscard]] Nv12Buffer copy_of(const VideoFrame& picture);
  [[nodiscard]] WarpMesh near_gap(const WarpMesh& mesh) const;
  [[nodiscard]] Result<void> take_from(Warper& warper, const Neighbour& neighbour, double later_s);

  Composition composition_;
  SeamDrift drift_;
  PicturePool pool_;
  std::int64_t bytes_copied_ = 0;
};

}  // namespace gimbal
