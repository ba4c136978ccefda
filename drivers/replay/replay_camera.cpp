#include "drivers/replay/replay_camera.hpp"

#include <fmt/format.h>

#include <utility>

#include "drivers/replay/video_decoder.hpp"
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
  format_ = {size_of(info), fps_ > 0 ? fps_ : rate_of(info), color_of((*decoder)->caps())};
  next_ = 0;
  picture_ = 0;
  has_ended_ = false;
  frames_without_stamp_ = 0;
  stamps_without_frame_ = 0;
  warnings_.clear();
  decoder_ = *std::move(decoder);
  return {};
}

Result<std::optional<VideoFrame>> ReplayCamera::read() {
  if (!decoder_ || has_ended_ || decoder_->is_interrupted()) {
    return std::nullopt;
  }
  if (next_ == stamps_.size()) {
    return end_of_video();
  }
  if (auto skipped = skip_pictures_without_stamp(); !skipped) {
    return tl::unexpected(skipped.error());
  }
  auto sample = decoder_->next();
  if (!sample) {
    return tl::unexpected(sample.error());
  }
  if (*sample == nullptr) {
    return decoder_->is_interrupted() ? std::nullopt : end_of_video();
  }
  auto frame = map_frame(sample->get(), stamps_[next_]);
  if (!frame) {
    return failed(fmt::format("{}: picture {} cannot be read", video_.string(), picture_));
  }
  if (frame->size != format_.size) {
    return bad_input(fmt::format("{}: picture {} is {}x{}, but the first was {}x{}",
                                 video_.string(), picture_, frame->size.width, frame->size.height,
                                 format_.size.width, format_.size.height));
  }
  const GstClockTime media_time = GST_BUFFER_PTS(gst_sample_get_buffer(sample->get()));
  if (GST_CLOCK_TIME_IS_VALID(media_time)) {
    media_time_ = SensorDuration(static_cast<std::int64_t>(media_time));
  }
  ++next_;
  ++picture_;
  return frame;
}

/// Up to the picture that the next stamp is for, or the end.
Result<void> ReplayCamera::skip_pictures_without_stamp() {
  for (; picture_ < stamps_[next_].index; ++picture_) {
    auto sample = decoder_->next();
    if (!sample) {
      return tl::unexpected(sample.error());
    }
    if (*sample == nullptr) {
      return {};
    }
    ++frames_without_stamp_;
  }
  return {};
}

void ReplayCamera::stop() {
  if (decoder_) {
    decoder_->interrupt();
  }
}

Result<std::optional<VideoFrame>> ReplayCamera::end_of_video() {
  if (auto counted = count_rest(); !counted) {
    return tl::unexpected(counted.error());
  }
  has_ended_ = true;
  stamps_without_frame_ = static_cast<std::int64_t>(stamps_.size() - next_);
  warnings_ = decoder_->warnings();
  if (frames_without_stamp_ > 0) {
    warnings_.push_back(
        fmt::format("{}: {} pictures have no stamp in the frame list and are left out",
                    video_.string(), frames_without_stamp_));
  }
  if (stamps_without_frame_ > 0) {
    warnings_.push_back(fmt::format("{}: holds no picture for the last {} stamps of the frame list",
                                    video_.string(), stamps_without_frame_));
  }
  return std::nullopt;
}

Result<void> ReplayCamera::count_rest() {
  auto sample = decoder_->next();
  while (sample && *sample != nullptr) {
    ++frames_without_stamp_;
    sample = decoder_->next();
  }
  if (!sample) {
    return tl::unexpected(sample.error());
  }
  return {};
}

}  // namespace gimbal
