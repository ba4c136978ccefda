#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "tests/judge/camera_rotation.hpp"
#include "tests/judge/fast_part.hpp"
#include "tests/judge/shown_view.hpp"

namespace gimbal::judge {

/// What is measured of a video by its pictures alone. Everything that moves is judged above 1 Hz:
/// slower is where the camera is meant to go.
struct Judgement {
  int frames = 0;
  double rate_deg_s = 0;  ///< rms angular rate of the camera, three axes together
  /// The same without the first and the last two seconds, where no stabilizer knows what was before
  /// or comes after; nothing of a video of less than five seconds.
  std::optional<double> rate_inside_deg_s;
  double shift_px = 0;   ///< rms motion of the picture's middle, px a frame
  double wobble_px = 0;  ///< see RowWobble, px a frame
  /// Rms distance of tracks from each pair of frames' best homography, px: wobble that is no
  /// homography, what moves in the scene, and the tracker's noise.
  double residual_px = 0;
  /// Inter-frame transformation fidelity: mean over pairs of frames of the PSNR of the luma, dB. A
  /// pair counts at most 58.9, where all that differs is how luma was rounded.
  double itf_db = 0;
  double border_share = 0;        ///< of all pixels: black_border, less what the original shows
  double worst_border_share = 0;  ///< of one frame's
  int lost_pairs = 0;             ///< of frames, in which no camera motion was found
  /// How far the camera has turned about its first frame's x, y and z, after each pair of frames,
  /// in degrees: the steps summed, for a plot. Errors add up.
  std::vector<Measured> path_deg;

  /// Against the original; means over every sixth frame, as far as found in it.
  struct AgainstOriginal {
    int frames = 0;
    double zoom = 1;
    double retained_view = 1;
    double distortion = 0;
    double worst_distortion = 0;
  };
  std::optional<AgainstOriginal> against_original;
};

/// Judges a video, frame by frame, as long as it is.
class VideoJudge {
 public:
  /// `focal_px`: of the original, or of the video itself if there is none to compare with.
  VideoJudge(double focal_px, double fps);

  /// 8-bit luma. With an original, of the same instant, its picture.
  void add(const cv::Mat& luma, const std::optional<cv::Mat>& original);

  /// No more frames come.
  [[nodiscard]] Judgement judgement() const;

 private:
  struct Pair {
    double time_s;
    std::vector<Track> tracks;
  };

  [[nodiscard]] double zoom() const;

  double focal_px_;
  double fps_;
  TrackedPicture last_;
  int frames_ = 0;
  std::vector<Pair> pairs_;
  std::vector<double> psnr_db_;
  std::vector<double> border_shares_;
  std::vector<ShownView> views_;
};

}  // namespace gimbal::judge
