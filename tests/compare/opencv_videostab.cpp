// OpenCV's videostab in two passes, as a peer to compare with: motion as a similarity, a Gaussian
// filter kept within the margin, wobble suppressed by homographies. Writes y4m, black where there
// is no source.
//
//   opencv_videostab VIDEO RADIUS MARGIN > OUTPUT.y4m
//
// RADIUS  of the filter, frames to either side
// MARGIN  share of the picture that may be lost at each edge, 0 to 0.5

#include <fmt/core.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <opencv2/videostab.hpp>
#include <string>
#include <vector>

#include "drivers/replay/replay_camera.hpp"
#include "drivers/replay/video_probe.hpp"

namespace gimbal {
namespace {

/// This program has one reader, who wants the line.
[[noreturn]] void exit_with(const Error& error) {
  fmt::print(stderr, "opencv_videostab: {}\n", error.message);
  std::exit(error.kind == Error::Kind::bad_input ? 2 : 1);
}

cv::Mat bgr_of(const VideoFrame& frame) {
  const auto plane = [&](std::size_t i, cv::Size size, int type) {
    return cv::Mat(size, type, const_cast<std::uint8_t*>(frame.planes[i].data),
                   static_cast<std::size_t>(frame.planes[i].stride_bytes));
  };
  const ImageSize chroma = chroma_size(frame.size);
  cv::Mat bgr;
  cv::cvtColorTwoPlane(plane(0, {frame.size.width, frame.size.height}, CV_8UC1),
                       plane(1, {chroma.width, chroma.height}, CV_8UC2), bgr,
                       cv::COLOR_YUV2BGR_NV12);
  return bgr;
}

/// The pictures of a file; an empty one at the end.
class FileFrames final : public cv::videostab::IFrameSource {
 public:
  explicit FileFrames(std::string file) : file_(std::move(file)) {
    const auto info = probe_video(file_);
    if (!info) exit_with(info.error());
    fps_ = info->fps;
    for (std::int64_t i = 0; i < info->frame_count; ++i) stamps_.push_back({i, {}, std::nullopt});
    open();
  }

  [[nodiscard]] double fps() const { return fps_; }

  void reset() override { open(); }

  cv::Mat nextFrame() override {
    const auto frame = camera_->read();
    if (!frame) exit_with(frame.error());
    return *frame ? bgr_of(**frame) : cv::Mat();
  }

 private:
  void open() {
    camera_ = std::make_unique<ReplayCamera>(file_, stamps_, fps_);
    if (const auto started = camera_->start(); !started) exit_with(started.error());
  }

  std::string file_;
  double fps_ = 0;
  std::vector<FrameStamp> stamps_;
  std::unique_ptr<ReplayCamera> camera_;
};

cv::Ptr<cv::videostab::ImageMotionEstimatorBase> motion_by_corners(
    cv::videostab::MotionModel model) {
  return cv::makePtr<cv::videostab::KeypointBasedMotionEstimator>(
      cv::makePtr<cv::videostab::MotionEstimatorRansacL2>(model));
}

cv::Ptr<cv::videostab::TwoPassStabilizer> make_stabilizer(const cv::Ptr<FileFrames>& frames,
                                                          int radius, double margin) {
  const auto wobble = cv::makePtr<cv::videostab::MoreAccurateMotionWobbleSuppressor>();
  wobble->setMotionEstimator(motion_by_corners(cv::videostab::MM_HOMOGRAPHY));
  auto stabilizer = cv::makePtr<cv::videostab::TwoPassStabilizer>();
  stabilizer->setLog(cv::makePtr<cv::videostab::NullLog>());
  stabilizer->setFrameSource(frames);
  stabilizer->setMotionEstimator(motion_by_corners(cv::videostab::MM_SIMILARITY));
  stabilizer->setMotionStabilizer(cv::makePtr<cv::videostab::GaussianMotionFilter>(radius));
  stabilizer->setWobbleSuppressor(wobble);
  stabilizer->setTrimRatio(static_cast<float>(margin));
  stabilizer->setCorrectionForInclusion(true);
  stabilizer->setBorderMode(cv::BORDER_CONSTANT);
  return stabilizer;
}

void write_y4m(const cv::Mat& bgr) {
  cv::Mat planes;
  cv::cvtColor(bgr, planes, cv::COLOR_BGR2YUV_I420);
  std::fputs("FRAME\n", stdout);
  const std::size_t bytes = planes.total();
  if (std::fwrite(planes.data, 1, bytes, stdout) != bytes) {
    exit_with({Error::Kind::failed, "standard output: cannot write"});
  }
}

void run(const std::string& file, int radius, double margin) {
  const auto frames = cv::makePtr<FileFrames>(file);
  const auto stabilizer = make_stabilizer(frames, radius, margin);
  cv::Mat steady = stabilizer->nextFrame();
  fmt::print("YUV4MPEG2 W{} H{} F{}:1000 Ip C420mpeg2\n", steady.cols, steady.rows,
             std::lround(frames->fps() * 1000));
  for (; !steady.empty(); steady = stabilizer->nextFrame()) write_y4m(steady);
}

}  // namespace
}  // namespace gimbal

int main(int argc, char** argv) {
  if (argc != 4) {
    fmt::print(stderr, "usage: opencv_videostab VIDEO RADIUS MARGIN > OUTPUT.y4m\n");
    return 2;
  }
  gimbal::run(argv[1], std::atoi(argv[2]), std::atof(argv[3]));
}
