#include "drivers/replay/replay_camera.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "drivers/replay/chroma_weaver.hpp"
#include "drivers/replay/video_decoder.hpp"
#include "drivers/replay/video_probe.hpp"
#include "pipeline/gstreamer/gst_frames.hpp"

namespace gimbal {
namespace {

ImageSize size_of(const GstVideoInfo& info) {
  return {GST_VIDEO_INFO_WIDTH(&info), GST_VIDEO_INFO_HEIGHT(&info)};
}

double rate_of(const GstVideoInfo& info) {
  return GST_VIDEO_INFO_FPS_D(&info) == 0
             ? 0
             : static_cast<double>(GST_VIDEO_INFO_FPS_N(&info)) / GST_VIDEO_INFO_FPS_D(&info);
}

/// Places are told by times only where each picture has one of its own.
std::vector<SensorDuration> usable_times(std::vector<SensorDuration> times) {
  const bool is_ambiguous = std::adjacent_find(times.begin(), times.end()) != times.end();
  return is_ambiguous ? std::vector<SensorDuration>{} : std::move(times);
}

/// `times` are not empty and rise.
std::ptrdiff_t nearest(const std::vector<SensorDuration>& times, SensorDuration time) {
  const auto later = std::lower_bound(times.begin(), times.end(), time);
  if (later == times.begin()) {
    return 0;
  }
  const auto earlier = std::prev(later);
  const bool is_earlier = later == times.end() || time - *earlier < *later - time;
  return (is_earlier ? earlier : later) - times.begin();
}

}  // namespace

ReplayCamera::ReplayCamera(std::filesystem::path video, std::vector<FrameStamp> stamps, double fps)
    : video_(std::move(video)), stamps_(std::move(stamps)), fps_(fps) {}

ReplayCamera::~ReplayCamera() = default;

Result<void> ReplayCamera::start() {
  auto decoder = VideoDecoder::open(video_);
  if (!decoder) {
    return tl::unexpected(decoder.error());
  }
  GstVideoInfo info;
  if (!gst_video_info_from_caps(&info, (*decoder)->caps())) {
    return bad_input(fmt::format("{}: its picture format is not understood", video_.string()));
  }
  auto coded = probe_video(video_);
  if (!coded) {
    return tl::unexpected(coded.error());
  }
  format_ = {size_of(info), fps_ > 0 ? fps_ : rate_of(info), color_of((*decoder)->caps())};
  coded_count_ = coded->frame_count;
  coded_times_ = usable_times(std::move(coded->frame_times));
  decoder_ = *std::move(decoder);
  gauge_ = std::make_shared<SurplusGauge>();
  weaver_ = std::make_unique<ChromaWeaver>();
  begin();
  return {};
}

Result<void> ReplayCamera::rewind() {
  auto rewound = decoder_->rewind();
  if (!rewound) {
    return tl::unexpected(rewound.error());
  }
  if (!*rewound && !decoder_->is_interrupted()) {
    decoder_.reset();  // two at once would take twice the memory
    return start();
  }
  begin();
  return {};
}

void ReplayCamera::begin() {
  next_ = 0;
  place_ = -1;
  has_ended_ = false;
  counts_ = {};
  warnings_.clear();
}

Result<std::optional<VideoFrame>> ReplayCamera::read() {
  while (decoder_ && !has_ended_ && !decoder_->is_interrupted()) {
    auto picture = decoder_->next();
    if (!picture) {
      return tl::unexpected(picture.error());
    }
    if (*picture == nullptr) {
      end_of_video();
    } else if (is_wanted(media_time_of(picture->get()))) {
      return deliver(map_picture(picture->get(), gauge_));
    }
  }
  return std::nullopt;
}

/// Steps on to the picture's place in the video and to the stamp for it, if there is one.
bool ReplayCamera::is_wanted(std::optional<SensorDuration> media_time) {
  ++counts_.pictures;
  const std::int64_t place = place_of(media_time);
  if (place <= place_) {
    ++counts_.out_of_order;
    return false;
  }
  place_ = place;
  for (; next_ < stamps_.size() && stamps_[next_].index < place_; ++next_) {
    ++counts_.stamps_passed;
  }
  const bool has_stamp = next_ < stamps_.size() && stamps_[next_].index == place_;
  if (!has_stamp) {
    ++counts_.without_stamp;
  }
  media_time_ = media_time.value_or(media_time_);
  return has_stamp;
}

/// A decoder passes over pictures that are too damaged, so the times of all that are in the file
/// tell the place. The pictures are counted where it has no times, or more of them than the frame
/// list has pictures: some codecs have pictures that are never shown.
std::int64_t ReplayCamera::place_of(std::optional<SensorDuration> media_time) const {
  const bool some_are_hidden = !stamps_.empty() && coded_count_ > stamps_.back().index + 1;
  if (!media_time || coded_times_.empty() || some_are_hidden) {
    return place_ + 1;
  }
  return nearest(coded_times_, *media_time);
}

Result<std::optional<VideoFrame>> ReplayCamera::deliver(
    const std::optional<MappedPicture>& picture) {
  if (!picture) {
    return failed(fmt::format("{}: picture {} cannot be read", video_.string(), place_));
  }
  if (picture->size != format_.size) {
    return bad_input(fmt::format("{}: picture {} is {}x{}, but the first was {}x{}",
                                 video_.string(), place_, picture->size.width, picture->size.height,
                                 format_.size.width, format_.size.height));
  }
  VideoFrame frame;
  frame.stamp = stamps_[next_++];
  frame.size = picture->size;
  frame.color = picture->color;
  frame.storage = picture->storage;
  const auto& planes = picture->planes;
  const bool is_i420 = planes.size() == 3;
  if (is_i420 && form_ == PictureForm::native) {
    frame.native = NativePicture{NativeFormat::i420, {planes[0], planes[1], planes[2]}};
    return frame;
  }
  frame.planes = {planes[0], planes[1]};
  if (is_i420) weaver_->weave(planes[1], planes[2], frame);
  return frame;
}

void ReplayCamera::stop() {
  if (decoder_) {
    decoder_->interrupt();
  }
}

void ReplayCamera::end_of_video() {
  has_ended_ = true;
  warnings_ = decoder_->warnings();
  const auto warn = [this](std::int64_t count, const std::string& text) {
    if (count > 0) warnings_.push_back(fmt::format("{}: {}", video_.string(), text));
  };
  warn(counts_.without_stamp,
       fmt::format("{} pictures have no stamp in the frame list and are left out",
                   counts_.without_stamp));
  warn(counts_.out_of_order,
       fmt::format("damaged: {} pictures came after later ones and are left out",
                   counts_.out_of_order));
  warn(
      counts_.stamps_passed,
      fmt::format("damaged: {} pictures that the frame list has cannot be decoded and are left out",
                  counts_.stamps_passed));
  const std::int64_t left = std::ssize(stamps_) - static_cast<std::int64_t>(next_);
  warn(left,
       fmt::format("holds no picture for the last {} stamps of the frame list: is it cut short?",
                   left));
  warn_of_uncertain_places();
}

/// Where pictures are missing and nothing tells which, later ones may have got a wrong stamp.
void ReplayCamera::warn_of_uncertain_places() {
  const std::int64_t lost = coded_count_ - counts_.pictures;
  if (coded_times_.empty() && lost > 0) {
    warnings_.push_back(fmt::format(
        "{}: damaged: {} of {} pictures cannot be decoded, and the file has no times that tell "
        "which: from the first of them on, frames may have the stamps of up to {} frames earlier",
        video_.string(), lost, coded_count_, lost));
  }
  if (next_ < stamps_.size()) {
    warn_of_leap();
  }
}

void ReplayCamera::warn_of_leap() {
  constexpr double kLeapInMeans = 1.5;
  if (coded_times_.size() < 3) {
    return;
  }
  std::size_t at = 1;
  for (std::size_t i = 2; i < coded_times_.size(); ++i) {
    if (coded_times_[i] - coded_times_[i - 1] > coded_times_[at] - coded_times_[at - 1]) at = i;
  }
  const SensorDuration leap = coded_times_[at] - coded_times_[at - 1];
  const double mean_s = to_seconds(coded_times_.back() - coded_times_.front()) /
                        static_cast<double>(coded_times_.size() - 1);
  if (to_seconds(leap) < kLeapInMeans * mean_s) {
    return;
  }
  warnings_.push_back(fmt::format(
      "{}: its own times leap by {:.3f} s after picture {}: if pictures are missing there, those "
      "that follow have got the stamps of earlier ones",
      video_.string(), to_seconds(leap), at - 1));
}

std::int64_t ReplayCamera::bytes_copied() const {
  return decoder_->bytes_copied() + weaver_->bytes_written();
}

}  // namespace gimbal
