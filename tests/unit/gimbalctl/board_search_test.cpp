#include "daemon/gimbalctl/board_search.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <utility>
#include <vector>

#include "tests/support/rendered_board.hpp"

namespace gimbal {
namespace {

using ::testing::IsEmpty;

constexpr ImageSize kSize = {320, 240};
const CalibrationBoard kBoard{BoardKind::checkerboard, 5, 4, 0, ""};

Lens lens() {
  LensParameters parameters;
  parameters.K << 260, 0, 159.5, 0, 260, 119.5, 0, 0, 1;
  return *Lens::create(parameters);
}

std::vector<VideoFrame> board_pictures(int count) {
  const test::BoardRenderer renderer(lens(), kSize, test::board_texture(kBoard), {});
  std::vector<VideoFrame> frames;
  for (const auto& pose : test::board_poses(kBoard, lens(), kSize, count, 2)) {
    frames.push_back(renderer.render(pose, frames.size()));
  }
  return frames;
}

std::vector<VideoFrame> gray_picture() {
  Nv12Buffer buffer(kSize);
  std::fill_n(buffer.luma().data, buffer.luma().stride_bytes * kSize.height, 100);
  return {std::move(buffer).publish({}, {})};
}

/// Shows each picture for a quarter of a second at 32 a second, and the last for ever.
class HeldPictures final : public CameraSource {
 public:
  explicit HeldPictures(std::vector<VideoFrame> pictures) : pictures_(std::move(pictures)) {}

  [[nodiscard]] Result<void> start() override { return {}; }
  [[nodiscard]] CameraFormat format() const override { return {kSize, 32, {}}; }
  [[nodiscard]] Result<std::optional<VideoFrame>> read() override {
    VideoFrame frame = pictures_[std::min(frames_ / 8, pictures_.size() - 1)];
    frame.stamp.time = SensorTime(std::chrono::milliseconds(1000 * frames_ / 32));
    if (frames_ == raise_at) std::raise(SIGINT);
    ++frames_;
    return frame;
  }
  void stop() override { is_stopped = true; }

  [[nodiscard]] std::size_t frames() const { return frames_; }

  bool is_stopped = false;
  std::size_t raise_at = 100000;

 private:
  std::vector<VideoFrame> pictures_;
  std::size_t frames_ = 0;
};

BoardSearch search() {
  return {*BoardDetector::create(kBoard), ViewChoice::Pictures::running};
}

TEST(BoardSearch, EndsOnceAllWasShown) {
  HeldPictures camera(board_pictures(80));
  BoardSearch found = search();
  ASSERT_TRUE(search_camera(camera, found, 1000, ProgressStyle::quiet));
  EXPECT_LT(camera.frames(), 80U * 8);
  EXPECT_GE(found.views().size(), 20U);
  EXPECT_THAT(coverage_of(found.views(), kSize).missing(), IsEmpty());
  EXPECT_TRUE(camera.is_stopped);
}

TEST(BoardSearch, EndsWhenTheTimeIsOver) {
  HeldPictures camera(gray_picture());
  BoardSearch found = search();
  ASSERT_TRUE(search_camera(camera, found, 3, ProgressStyle::quiet));
  EXPECT_NEAR(static_cast<double>(camera.frames()), 3 * 32, 2);
  EXPECT_NEAR(found.looked(), 3 / 0.2, 2);
  EXPECT_THAT(found.views(), IsEmpty());
}

TEST(BoardSearch, EndsOnASignal) {
  HeldPictures camera(gray_picture());
  camera.raise_at = 40;
  BoardSearch found = search();
  ASSERT_TRUE(search_camera(camera, found, 1000, ProgressStyle::quiet));
  EXPECT_EQ(camera.frames(), 41U);
}

}  // namespace
}  // namespace gimbal
