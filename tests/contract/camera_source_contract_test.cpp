// What drivers/camera_source.hpp promises, asked of every driver. A new driver adds itself to the
// list at the end of this file.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <thread>
#include <vector>

#include "drivers/camera_source.hpp"
#include "drivers/replay/replay_camera.hpp"
#include "drivers/synthetic/hand_motion.hpp"
#include "drivers/synthetic/panorama.hpp"
#include "drivers/synthetic/scene.hpp"
#include "drivers/synthetic/synthetic_camera.hpp"
#include "pipeline/pixels/nv12_frame.hpp"
#include "tests/support/gst_playback.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/test_pictures.hpp"

namespace gimbal {
namespace {

struct CameraDriver {
  const char* name;
  /// A camera that delivers some frames and ends; it may put files into the folder.
  std::function<std::unique_ptr<CameraSource>(const std::filesystem::path& folder)> make;
};

void PrintTo(const CameraDriver& driver, std::ostream* out) {
  *out << driver.name;
}

class CameraSourceContract : public ::testing::TestWithParam<CameraDriver> {
 protected:
  test::TemporaryFolder folder_;
  std::unique_ptr<CameraSource> camera_ = GetParam().make(folder_.path());

  [[nodiscard]] std::vector<VideoFrame> read_to_end() const {
    std::vector<VideoFrame> frames;
    for (;;) {
      const auto frame = camera_->read();
      if (!frame) {
        ADD_FAILURE() << frame.error().message;
        return frames;
      }
      if (!*frame) {
        return frames;
      }
      frames.push_back(**frame);
    }
  }
};

std::vector<std::uint8_t> pixels_of(const VideoFrame& frame) {
  std::vector<std::uint8_t> pixels;
  const ImageSize chroma = chroma_size(frame.size);
  const std::array<ImageSize, 2> sizes = {frame.size, ImageSize{2 * chroma.width, chroma.height}};
  for (std::size_t plane = 0; plane < 2; ++plane) {
    const auto [data, stride] = frame.planes[plane];
    for (int row = 0; row < sizes[plane].height; ++row) {
      pixels.insert(pixels.end(), data + row * stride, data + row * stride + sizes[plane].width);
    }
  }
  return pixels;
}

TEST_P(CameraSourceContract, FramesAreAsTheFormatSays) {
  ASSERT_TRUE(camera_->start());
  const CameraFormat format = camera_->format();
  EXPECT_GT(format.size.width, 0);
  EXPECT_GT(format.size.height, 0);
  EXPECT_GT(format.fps, 0);
  const auto frames = read_to_end();
  ASSERT_GE(frames.size(), 3U);
  for (const VideoFrame& frame : frames) {
    EXPECT_EQ(frame.size, format.size);
    EXPECT_EQ(frame.color.colorimetry, format.color.colorimetry);
    EXPECT_EQ(frame.color.chroma_siting, format.color.chroma_siting);
    EXPECT_NE(frame.storage, nullptr);
    EXPECT_GE(frame.planes[0].stride_bytes, frame.size.width);
    EXPECT_GE(frame.planes[1].stride_bytes, 2 * chroma_size(frame.size).width);
  }
}

TEST_P(CameraSourceContract, NativePicturesComeWhereTheyAreAskedForAndShowTheSame) {
  ASSERT_TRUE(camera_->start());
  const auto plain = read_to_end();
  camera_->stop();
  camera_->ask_for(PictureForm::native);
  ASSERT_TRUE(camera_->start());
  const auto asked = read_to_end();
  camera_->stop();
  camera_->ask_for(PictureForm::nv12);
  ASSERT_TRUE(camera_->start());
  const auto plain_again = read_to_end();
  ASSERT_EQ(asked.size(), plain.size());
  ASSERT_EQ(plain_again.size(), plain.size());
  for (std::size_t i = 0; i < plain.size(); ++i) {
    EXPECT_FALSE(plain[i].native);
    EXPECT_FALSE(plain_again[i].native);
    EXPECT_EQ(pixels_of(as_nv12(asked[i])), pixels_of(plain[i])) << i;
  }
}

TEST_P(CameraSourceContract, StampsAndIndicesRise) {
  ASSERT_TRUE(camera_->start());
  const auto frames = read_to_end();
  for (std::size_t i = 1; i < frames.size(); ++i) {
    EXPECT_GT(frames[i].stamp.time, frames[i - 1].stamp.time);
    EXPECT_GT(frames[i].stamp.index, frames[i - 1].stamp.index);
  }
}

TEST_P(CameraSourceContract, TheEndIsTheEnd) {
  ASSERT_TRUE(camera_->start());
  ASSERT_FALSE(read_to_end().empty());
  for (int i = 0; i < 3; ++i) {
    const auto frame = camera_->read();
    ASSERT_TRUE(frame) << frame.error().message;
    EXPECT_FALSE(frame->has_value());
  }
}

TEST_P(CameraSourceContract, NothingComesAfterStop) {
  ASSERT_TRUE(camera_->start());
  const auto first = camera_->read();
  ASSERT_TRUE(first && *first);
  camera_->stop();
  camera_->stop();  // once more is harmless
  const auto frame = camera_->read();
  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_FALSE(frame->has_value());
}

TEST_P(CameraSourceContract, StopWithoutStartIsHarmless) {
  camera_->stop();
  ASSERT_TRUE(camera_->start());
  EXPECT_FALSE(read_to_end().empty());
}

TEST_P(CameraSourceContract, StartsAgainAtTheFirstFrame) {
  ASSERT_TRUE(camera_->start());
  const auto before = read_to_end();
  camera_->stop();
  ASSERT_TRUE(camera_->start());
  const auto interrupted = camera_->read();  // from the middle, too
  ASSERT_TRUE(interrupted && *interrupted);
  camera_->stop();
  ASSERT_TRUE(camera_->start());
  const auto after = read_to_end();
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_EQ(after[i].stamp.index, before[i].stamp.index);
    EXPECT_EQ(after[i].stamp.time, before[i].stamp.time);
    EXPECT_EQ(pixels_of(after[i]), pixels_of(before[i])) << i;
  }
}

TEST_P(CameraSourceContract, FramesOutliveTheCamera) {
  ASSERT_TRUE(camera_->start());
  const auto frames = read_to_end();
  std::vector<std::vector<std::uint8_t>> pixels;
  for (const VideoFrame& frame : frames) {
    pixels.push_back(pixels_of(frame));
  }
  camera_.reset();
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(pixels_of(frames[i]), pixels[i]) << i;
  }
}

TEST_P(CameraSourceContract, StopFromAnotherThreadEndsReading) {
  ASSERT_TRUE(camera_->start());
  std::thread stopper([&] { camera_->stop(); });
  static_cast<void>(read_to_end());  // returns, before the last frame or after it
  stopper.join();
  const auto frame = camera_->read();
  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_FALSE(frame->has_value());
}

std::unique_ptr<CameraSource> replay_camera(const std::filesystem::path& folder) {
  const auto path = folder / "video.mkv";
  test::run_pipeline(fmt::format(
      "videotestsrc num-buffers=12 ! video/x-raw,width=96,height=64,framerate=30/1 ! x264enc "
      "bframes=2 ! matroskamux ! filesink location={}",
      path.string()));
  return std::make_unique<ReplayCamera>(path, test::irregular_stamps(12), 0);
}

/// Something else in every direction.
class ColorfulScene final : public Scene {
 public:
  [[nodiscard]] Eigen::Vector3d color(const Eigen::Vector3d& direction_world) const override {
    return 0.5 * (direction_world + Eigen::Vector3d::Ones());
  }
};

std::unique_ptr<CameraSource> synthetic_camera(const std::filesystem::path& /*folder*/) {
  SyntheticCameraSettings settings;
  settings.calibration.size = {96, 64};
  settings.calibration.fps = 30;
  settings.calibration.lens.K << 120, 0, 47.5, 0, 120, 31.5, 0, 0, 1;
  settings.calibration.readout = std::chrono::milliseconds(20);
  settings.first_readout = SensorTime(std::chrono::milliseconds(100));
  settings.frames = 6;
  settings.noise = PixelNoise{};
  auto motion =
      std::make_shared<const Motion>(make_hand_motion(walking_hand(), std::chrono::seconds(1), 1));
  auto panorama =
      std::make_shared<const Panorama>(std::make_shared<const ColorfulScene>(), 120.0, 1);
  auto camera = SyntheticCamera::create(settings, std::move(motion), std::move(panorama));
  EXPECT_TRUE(camera) << camera.error().message;
  return *std::move(camera);
}

INSTANTIATE_TEST_SUITE_P(Drivers, CameraSourceContract,
                         ::testing::Values(CameraDriver{"Replay", replay_camera},
                                           CameraDriver{"Synthetic", synthetic_camera}),
                         [](const auto& driver) -> std::string { return driver.param.name; });

}  // namespace
}  // namespace gimbal
