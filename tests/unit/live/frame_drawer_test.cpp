// Frames in flight, with a warper that fails when it is told to.

#include "daemon/frame_drawer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace gimbal {
namespace {

constexpr ImageSize kSize{16, 8};

enum class Step : std::uint8_t { begin, finish };

/// What it is told, and what it saw.
struct Script {
  std::string name;
  std::size_t most_in_flight = 2;
  std::function<bool(Step, std::int64_t index)> fails = [](Step, std::int64_t) { return false; };
  std::vector<std::int64_t> begun = {};
  std::size_t most_seen_in_flight = 0;
};

/// Fails for good once it has failed, as a lost context does.
class FakeWarper final : public Warper {
 public:
  explicit FakeWarper(Script& script) : script_(script) {}

  Result<void> begin(const VideoFrame& source, const WarpMesh&) override {
    if (is_lost(Step::begin, source.stamp.index)) return failed("lost");
    script_.begun.push_back(source.stamp.index);
    in_flight_.push_back(source);
    script_.most_seen_in_flight = std::max(script_.most_seen_in_flight, in_flight_.size());
    return {};
  }

  Result<VideoFrame> finish() override {
    VideoFrame frame = std::move(in_flight_.front());
    in_flight_.pop_front();
    if (is_lost(Step::finish, frame.stamp.index)) return failed("lost");
    frame.color.colorimetry = script_.name;
    return frame;
  }

  [[nodiscard]] std::size_t most_in_flight() const override { return script_.most_in_flight; }
  [[nodiscard]] std::int64_t bytes_copied() const override { return 0; }
  [[nodiscard]] std::string name() const override { return script_.name; }
  [[nodiscard]] std::string renderer() const override { return {}; }

 private:
  bool is_lost(Step step, std::int64_t index) {
    is_lost_ = is_lost_ || script_.fails(step, index);
    return is_lost_;
  }

  Script& script_;
  std::deque<VideoFrame> in_flight_;
  bool is_lost_ = false;
};

Drawing drawing_of(std::int64_t index, Border border = Border::crop) {
  Drawing drawing;
  drawing.frame.stamp.index = index;
  drawing.frame.size = kSize;
  drawing.mesh.border = border;
  return drawing;
}

std::vector<std::int64_t> up_to(std::int64_t last) {
  std::vector<std::int64_t> indices(static_cast<std::size_t>(last) + 1);
  std::iota(indices.begin(), indices.end(), 0);
  return indices;
}

class FrameDrawerTest : public testing::Test {
 protected:
  FrameDrawer drawer() {
    return {std::make_unique<FakeWarper>(first_),
            [this](std::unique_ptr<Warper>, const Error&) -> Result<std::unique_ptr<Warper>> {
              ++replacements_;
              return std::make_unique<FakeWarper>(second_);
            }};
  }

  /// Draws these, all of which wait from the beginning; the pictures in their order.
  Result<std::vector<VideoFrame>> draw(std::int64_t frames) {
    FrameDrawer::Waiting waiting(static_cast<std::size_t>(frames));
    for (std::int64_t i = 0; i < frames; ++i) waiting.push(drawing_of(i));
    waiting.close();
    FrameDrawer drawer = this->drawer();
    std::vector<VideoFrame> pictures;
    while (!waiting.is_at_end() || !drawer.is_idle()) {
      auto drawn = drawer.advance(waiting, std::chrono::seconds(10));
      if (!drawn) return tl::unexpected(drawn.error());
      if (*drawn) pictures.push_back((*drawn)->picture);
    }
    return pictures;
  }

  /// All come, in order, each once; those from there on by the second warper.
  void expect_all(const Result<std::vector<VideoFrame>>& pictures, std::int64_t frames,
                  std::int64_t first_of_second) {
    ASSERT_TRUE(pictures) << pictures.error().message;
    ASSERT_EQ(pictures->size(), static_cast<std::size_t>(frames));
    for (std::int64_t i = 0; i < frames; ++i) {
      const VideoFrame& picture = (*pictures)[static_cast<std::size_t>(i)];
      EXPECT_EQ(picture.stamp.index, i);
      EXPECT_EQ(picture.color.colorimetry, i < first_of_second ? "first" : "second") << i;
    }
  }

  Script first_{.name = "first"};
  Script second_{.name = "second"};
  int replacements_ = 0;
};

TEST_F(FrameDrawerTest, AllComeInOrderAndTheWarperIsKeptFull) {
  expect_all(draw(7), 7, 7);
  EXPECT_EQ(first_.begun, up_to(6));
  EXPECT_EQ(first_.most_seen_in_flight, 2U);
}

TEST_F(FrameDrawerTest, OneThatDrawsAtOnceIsGivenOneAtATime) {
  first_.most_in_flight = 1;
  expect_all(draw(4), 4, 4);
  EXPECT_EQ(first_.most_seen_in_flight, 1U);
}

TEST_F(FrameDrawerTest, NothingIsHeldBackWhereNothingWaits) {
  FrameDrawer::Waiting waiting(4);
  FrameDrawer drawer = this->drawer();
  for (std::int64_t i = 0; i < 3; ++i) {
    waiting.push(drawing_of(i));
    // So patient that to wait for another frame would end the test.
    ASSERT_FALSE(*drawer.advance(waiting, std::chrono::hours(1)));
    const auto drawn = drawer.advance(waiting, std::chrono::hours(1));
    ASSERT_TRUE(*drawn);
    EXPECT_EQ((**drawn).picture.stamp.index, i);
    EXPECT_TRUE(drawer.is_idle());
  }
}

TEST_F(FrameDrawerTest, WaitsForTheFirstFrameNoLongerThanItMay) {
  FrameDrawer::Waiting waiting(4);
  FrameDrawer drawer = this->drawer();
  const auto nothing = drawer.advance(waiting, std::chrono::milliseconds(1));
  ASSERT_TRUE(nothing);
  EXPECT_FALSE(*nothing);
  EXPECT_TRUE(drawer.is_idle());
}

struct Failure {
  Step step;
  std::int64_t index;
  std::int64_t first_of_second;  ///< frame that the second warper draws
};

class FrameDrawerFailure : public FrameDrawerTest, public testing::WithParamInterface<Failure> {};

// The second of two in flight fails to begin: the first is lost with it.
INSTANTIATE_TEST_SUITE_P(Steps, FrameDrawerFailure,
                         testing::Values(Failure{Step::begin, 0, 0}, Failure{Step::begin, 1, 0},
                                         Failure{Step::begin, 4, 3}, Failure{Step::finish, 0, 0},
                                         Failure{Step::finish, 3, 3}, Failure{Step::finish, 6, 6}));

TEST_P(FrameDrawerFailure, AnotherWarperDrawsWhatIsNotFinished) {
  first_.fails = [](Step step, std::int64_t index) {
    return step == GetParam().step && index == GetParam().index;
  };
  expect_all(draw(7), 7, GetParam().first_of_second);
  EXPECT_EQ(replacements_, 1);
  EXPECT_EQ(second_.begun.front(), GetParam().first_of_second);
  EXPECT_EQ(second_.begun.size(), 7U - static_cast<std::size_t>(GetParam().first_of_second));
}

TEST_P(FrameDrawerFailure, TheOtherMayTakeFewerAtATime) {
  first_.fails = [](Step step, std::int64_t index) {
    return step == GetParam().step && index == GetParam().index;
  };
  second_.most_in_flight = 1;
  expect_all(draw(7), 7, GetParam().first_of_second);
  EXPECT_EQ(second_.most_seen_in_flight, 1U);
}

TEST_P(FrameDrawerFailure, OneThatFailsTwiceHasFailed) {
  first_.fails = [](Step step, std::int64_t index) {
    return step == GetParam().step && index == GetParam().index;
  };
  for (const Step step : {Step::begin, Step::finish}) {
    replacements_ = 0;
    second_.fails = [&](Step at, std::int64_t) { return at == step; };
    const auto pictures = draw(7);
    ASSERT_FALSE(pictures);
    EXPECT_EQ(pictures.error().message, "lost");
    EXPECT_EQ(replacements_, 1);
  }
}

TEST_F(FrameDrawerTest, OneThatHasDrawnMeanwhileIsReplacedAgain) {
  first_.fails = [](Step step, std::int64_t index) { return step == Step::finish && index == 1; };
  second_.fails = [&](Step step, std::int64_t index) {
    return step == Step::finish && index == 3 && replacements_ == 1;
  };
  expect_all(draw(7), 7, 1);
  EXPECT_EQ(replacements_, 2);
}

TEST_F(FrameDrawerTest, AFilledBorderIsDrawnAlone) {
  FrameDrawer drawer = this->drawer();
  ASSERT_TRUE(drawer.begin(drawing_of(0)));
  EXPECT_TRUE(drawer.has_room());
  ASSERT_TRUE(drawer.begin(drawing_of(1, Border::blur)));
  EXPECT_FALSE(drawer.has_room());
  EXPECT_EQ(drawer.finish()->picture.stamp.index, 0);
  EXPECT_FALSE(drawer.has_room());
  EXPECT_EQ(drawer.finish()->picture.stamp.index, 1);
  EXPECT_TRUE(drawer.has_room());
  ASSERT_TRUE(drawer.begin(drawing_of(2)));
  EXPECT_EQ(drawer.finish()->picture.stamp.index, 2);
  EXPECT_EQ(first_.begun, up_to(2));
  EXPECT_EQ(first_.most_seen_in_flight, 1U);
}

TEST_F(FrameDrawerTest, AFrameIsHeldUntilItIsFinished) {
  FrameDrawer drawer = this->drawer();
  auto memory = std::make_shared<int>();
  Drawing drawing = drawing_of(0);
  drawing.frame.storage = memory;
  ASSERT_TRUE(drawer.begin(std::exchange(drawing, {})));
  EXPECT_GT(memory.use_count(), 1);
  EXPECT_TRUE(drawer.finish());
  EXPECT_EQ(memory.use_count(), 1);
}

}  // namespace
}  // namespace gimbal
