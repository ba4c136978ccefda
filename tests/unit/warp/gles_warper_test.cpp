// The GLES warper against its twin on the CPU.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "pipeline/warp/warper.hpp"
#include "tests/unit/warp/warp_scene.hpp"

namespace gimbal::warp_scene {
namespace {

using Eigen::Vector2d;
using testing::HasSubstr;

struct Difference {
  double share_above_2;  ///< of all bytes
  int largest;
};

Difference compare(const VideoFrame& a, const VideoFrame& b, int plane) {
  const std::vector<std::uint8_t> bytes_a = plane_bytes(a, plane);
  const std::vector<std::uint8_t> bytes_b = plane_bytes(b, plane);
  EXPECT_EQ(bytes_a.size(), bytes_b.size());
  std::size_t above_2 = 0;
  int largest = 0;
  for (std::size_t i = 0; i < bytes_a.size(); ++i) {
    const int difference = std::abs(bytes_a[i] - bytes_b[i]);
    above_2 += difference > 2 ? 1U : 0U;
    largest = std::max(largest, difference);
  }
  return {static_cast<double>(above_2) / static_cast<double>(bytes_a.size()), largest};
}

void expect_alike(const VideoFrame& gles, const VideoFrame& cpu, const std::string& what) {
  ASSERT_EQ(gles.size, cpu.size);
  for (int plane = 0; plane < 2; ++plane) {
    const Difference difference = compare(gles, cpu, plane);
    std::printf("%s, plane %d: %.4f %% of the bytes differ by more than 2, largest difference %d\n",
                what.c_str(), plane, 100 * difference.share_above_2, difference.largest);
    EXPECT_LE(difference.share_above_2, 0.001) << what << ", plane " << plane;
  }
}

struct Case {
  ImageSize size;
  GlesVersion version;
  Interpolation interpolation = Interpolation::bilinear;
};

std::string case_name(const testing::TestParamInfo<Case>& info) {
  return std::to_string(info.param.size.width) + "x" + std::to_string(info.param.size.height) +
         (info.param.version == GlesVersion::best ? "_best" : "_gles2") +
         (info.param.interpolation == Interpolation::bicubic ? "_bicubic" : "");
}

class GlesAgainstCpu : public testing::TestWithParam<Case> {};

TEST_P(GlesAgainstCpu, AgreesForEveryBorder) {
  const auto [size, version, interpolation] = GetParam();
  auto gles = make_gles_warper(size, size, {interpolation, version});
  ASSERT_TRUE(gles) << gles.error().message;
  const auto cpu = make_cpu_warper({}, interpolation);
  const VideoFrame picture = make_picture(size, {"bt709", ChromaSiting::left});
  for (const Border border : {Border::crop, Border::extend, Border::mirror, Border::black}) {
    for (const View view : {View::zoomed_in, View::zoomed_out}) {
      const WarpMesh mesh = shaky_mesh(size, size, border, view);
      const auto drawn = (*gles)->warp(picture, mesh);
      ASSERT_TRUE(drawn) << drawn.error().message;
      const std::string what = "border " + std::to_string(static_cast<int>(border)) + ", view " +
                               std::to_string(static_cast<int>(view));
      expect_alike(*drawn, cpu->warp(picture, mesh).value(), what);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, GlesAgainstCpu,
                         testing::ValuesIn(std::vector<Case>{
                             {{480, 360}, GlesVersion::best},
                             {{480, 360}, GlesVersion::gles2},
                             {{640, 480}, GlesVersion::best},
                             {{640, 480}, GlesVersion::gles2},
                             {{1280, 720}, GlesVersion::best},
                             {{1280, 720}, GlesVersion::gles2},
                             {{1920, 1080}, GlesVersion::best},
                             {{1920, 1080}, GlesVersion::gles2},
                             {{641, 361}, GlesVersion::best},
                             {{641, 361}, GlesVersion::gles2},
                             {{480, 360}, GlesVersion::best, Interpolation::bicubic},
                             {{480, 360}, GlesVersion::gles2, Interpolation::bicubic},
                             {{641, 361}, GlesVersion::best, Interpolation::bicubic},
                             {{641, 361}, GlesVersion::gles2, Interpolation::bicubic},
                         }),
                         case_name);

/// The picture turned about its middle.
WarpMesh turned_mesh(ImageSize size, double by_deg) {
  const Vector2d middle(size.width / 2.0, size.height / 2.0);
  const Eigen::Rotation2Dd turn(by_deg * std::numbers::pi / 180);
  return mesh_of_map(size, size, Border::mirror,
                     [&](const Vector2d& at) -> Vector2d { return turn * (at - middle) + middle; });
}

class GlesWarper : public testing::TestWithParam<GlesVersion> {
 protected:
  [[nodiscard]] std::unique_ptr<Warper> make(ImageSize source, ImageSize output) const {
    return make_gles_warper(source, output, {Interpolation::bilinear, GetParam()}).value();
  }
};

TEST_P(GlesWarper, IdentityIsBitForBit) {
  for (const ImageSize size : {ImageSize{640, 480}, ImageSize{641, 361}, ImageSize{3, 5}}) {
    const auto warper = make(size, size);
    for (const ChromaSiting siting : {ChromaSiting::left, ChromaSiting::center}) {
      const VideoFrame picture = make_picture(size, {"", siting});
      const VideoFrame drawn =
          warper->warp(picture, mesh_of_map(size, size, Border::crop, same)).value();
      EXPECT_EQ(plane_bytes(drawn, 0), plane_bytes(picture, 0));
      EXPECT_EQ(plane_bytes(drawn, 1), plane_bytes(picture, 1));
    }
  }
}

TEST_P(GlesWarper, AgreesWithCpuForOtherSizesSitingsAndRanges) {
  const ImageSize source{641, 361};
  const ImageSize output{355, 201};
  const auto gles = make(source, output);
  const auto cpu = make_cpu_warper();
  const VideoFrame picture = make_picture(source, {"1:4:0:0", ChromaSiting::center});
  for (const Border border : {Border::black, Border::mirror}) {
    const WarpMesh mesh = shaky_mesh(source, output, border, View::zoomed_out);
    expect_alike(gles->warp(picture, mesh).value(), cpu->warp(picture, mesh).value(), "full range");
  }
}

TEST_P(GlesWarper, TakesAnyStride) {
  const ImageSize size{321, 181};
  const auto warper = make(size, size);
  const VideoFrame picture = make_picture(size, {});
  const WarpMesh mesh = shaky_mesh(size, size, Border::crop, View::zoomed_in);
  const VideoFrame expected = warper->warp(picture, mesh).value();
  for (const auto& [luma, chroma] : {std::pair{321, 322}, {400, 400}, {333, 323}, {-400, -350}}) {
    const VideoFrame drawn = warper->warp(with_strides(picture, luma, chroma), mesh).value();
    EXPECT_EQ(plane_bytes(drawn, 0), plane_bytes(expected, 0)) << luma;
    EXPECT_EQ(plane_bytes(drawn, 1), plane_bytes(expected, 1)) << chroma;
  }
}

TEST_P(GlesWarper, FollowsAChangeOfSize) {
  const auto warper = make({64, 32}, {64, 32});
  for (const ImageSize size : {ImageSize{64, 32}, ImageSize{130, 70}, ImageSize{48, 36}}) {
    const VideoFrame picture = make_picture(size, {});
    const VideoFrame drawn =
        warper->warp(picture, mesh_of_map(size, size, Border::crop, same)).value();
    EXPECT_EQ(plane_bytes(drawn, 0), plane_bytes(picture, 0));
  }
}

TEST_P(GlesWarper, FramesInFlightComeOutAsThoseDrawnOneByOne) {
  const std::vector<Border> borders = {Border::crop, Border::mirror, Border::extend, Border::black};
  for (const ImageSize size : {ImageSize{640, 360}, ImageSize{641, 361}}) {
    const auto warper = make(size, size);
    ASSERT_GE(warper->most_in_flight(), 2U);
    std::vector<VideoFrame> frames;
    std::vector<VideoFrame> expected;
    std::vector<WarpMesh> meshes;
    for (std::int64_t i = 0; i < 7; ++i) {
      // Each its own picture.
      VideoFrame frame = make_picture(size, {"bt709", ChromaSiting::left});
      frame =
          make_cpu_warper(1)->warp(frame, turned_mesh(size, 10.0 * static_cast<double>(i))).value();
      frame.stamp.index = i;
      meshes.push_back(shaky_mesh(size, size, borders[static_cast<std::size_t>(i) % 4],
                                  i % 2 == 0 ? View::zoomed_in : View::zoomed_out));
      expected.push_back(warper->warp(frame, meshes.back()).value());
      frames.push_back(std::move(frame));
    }
    std::size_t begun = 0;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      for (; begun < std::min(frames.size(), i + warper->most_in_flight()); ++begun) {
        ASSERT_TRUE(warper->begin(frames[begun], meshes[begun]));
      }
      const VideoFrame drawn = warper->finish().value();
      EXPECT_EQ(drawn.stamp.index, static_cast<std::int64_t>(i));
      EXPECT_EQ(plane_bytes(drawn, 0), plane_bytes(expected[i], 0)) << i;
      EXPECT_EQ(plane_bytes(drawn, 1), plane_bytes(expected[i], 1)) << i;
    }
  }
}

TEST_P(GlesWarper, FramesInFlightAreNotDisturbedByOneThatIsRefused) {
  const ImageSize size{64, 32};
  const auto warper = make(size, size);
  const VideoFrame picture = make_picture(size, {});
  const WarpMesh mesh = mesh_of_map(size, size, Border::crop, same);
  ASSERT_TRUE(warper->begin(picture, mesh));
  const ImageSize other{130, 70};
  EXPECT_FALSE(
      warper->begin(make_picture(other, {}), mesh_of_map(other, other, Border::crop, same)));
  EXPECT_FALSE(warper->begin(picture, mesh_of_map(other, size, Border::crop, same)));
  ASSERT_TRUE(warper->begin(picture, mesh));
  EXPECT_EQ(plane_bytes(warper->finish().value(), 0), plane_bytes(picture, 0));
  EXPECT_EQ(plane_bytes(warper->finish().value(), 0), plane_bytes(picture, 0));
  EXPECT_TRUE(
      warper->begin(make_picture(other, {}), mesh_of_map(other, other, Border::crop, same)));
}

TEST_P(GlesWarper, HoldsNoMemoryOfFramesThatItHasCopied) {
  const ImageSize size{64, 32};
  const auto warper = make(size, size);
  std::optional<VideoFrame> frame = make_picture(size, {});
  const std::weak_ptr<const void> memory = frame->storage;
  ASSERT_TRUE(warper->begin(*frame, mesh_of_map(size, size, Border::crop, same)));
  frame.reset();
  EXPECT_TRUE(memory.expired());
  EXPECT_TRUE(warper->finish());
}

TEST_P(GlesWarper, TwoInOneThreadDoNotDisturbEachOther) {
  const ImageSize size{64, 32};
  const auto first = make(size, size);
  auto second = make(size, size);
  const VideoFrame picture = make_picture(size, {});
  const WarpMesh mesh = mesh_of_map(size, size, Border::crop, same);
  const auto draws_right = [&](Warper& warper) {
    const auto drawn = warper.warp(picture, mesh);
    return drawn && plane_bytes(*drawn, 0) == plane_bytes(picture, 0);
  };
  EXPECT_TRUE(draws_right(*first));
  EXPECT_TRUE(draws_right(*second));
  EXPECT_TRUE(draws_right(*first));
  second.reset();
  EXPECT_TRUE(draws_right(*first));
}

TEST_P(GlesWarper, RefusesAnotherThread) {
  const ImageSize size{64, 32};
  const auto warper = make(size, size);
  const VideoFrame picture = make_picture(size, {});
  const WarpMesh mesh = mesh_of_map(size, size, Border::crop, same);
  std::optional<Result<VideoFrame>> drawn;
  std::thread([&] { drawn = warper->warp(picture, mesh); }).join();
  ASSERT_FALSE(*drawn);
  EXPECT_EQ(drawn->error().kind, Error::Kind::failed);
  EXPECT_TRUE(warper->warp(picture, mesh)) << "its own thread still has it";
}

TEST_P(GlesWarper, SaysThatAFrameIsTooLarge) {
  const auto wide =
      make_gles_warper({1 << 20, 16}, {64, 32}, {Interpolation::bilinear, GetParam()});
  ASSERT_FALSE(wide);
  EXPECT_EQ(wide.error().kind, Error::Kind::failed);
  EXPECT_THAT(wide.error().message, HasSubstr("the frame of 1048576x16 is too large"));
  const auto tall =
      make_gles_warper({64, 32}, {64, 1 << 20}, {Interpolation::bilinear, GetParam()});
  ASSERT_FALSE(tall);
  EXPECT_THAT(tall.error().message, HasSubstr("the output of 64x1048576 is too large"));
  EXPECT_FALSE(make_gles_warper({0, 32}, {64, 32}, {Interpolation::bilinear, GetParam()}));
}

TEST_P(GlesWarper, RefusesAMeshMadeForAnotherFrame) {
  const auto warper = make({64, 32}, {64, 32});
  const WarpMesh mesh = mesh_of_map({32, 32}, {64, 32}, Border::crop, same);
  EXPECT_FALSE(warper->warp(make_picture({64, 32}, {}), mesh));
}

TEST_P(GlesWarper, NamesItsRenderer) {
  const auto warper = make({64, 32}, {64, 32});
  EXPECT_EQ(warper->name(), "gles");
  EXPECT_FALSE(warper->renderer().empty());
  std::printf("GL_RENDERER: %s\n", warper->renderer().c_str());
}

INSTANTIATE_TEST_SUITE_P(Versions, GlesWarper,
                         testing::Values(GlesVersion::best, GlesVersion::gles2),
                         [](const auto& version) {
                           return version.param == GlesVersion::best ? "best" : "gles2";
                         });

TEST(SoftwareRenderer, IsToldByItsName) {
  for (const char* name :
       {"llvmpipe (LLVM 15.0.6, 256 bits)", "softpipe", "Google SwiftShader",
        "ANGLE (Google, Vulkan 1.3.0 (SwiftShader Device (Subzero) (0x0000C0DE)), SwiftShader "
        "driver-5.0.0)",
        "zink Vulkan 1.3(llvmpipe (LLVM 19.1.7, 256 bits) (MESA_LLVMPIPE))",
        "virgl (LLVMPIPE (LLVM 15.0.6, 256 bits))", "Software Rasterizer"}) {
    EXPECT_TRUE(is_software_renderer(name)) << name;
  }
  for (const char* name :
       {"V3D 7.1.7", "Mali-G610 (Panfrost)", "Mali400", "VC4 V3D 2.1", "Vivante GC3000 rev 5450",
        "NVIDIA Tegra Orin (nvgpu)/integrated", "FD630", "SVGA3D; build: RELEASE;  LLVM;",
        "AMD Radeon Graphics (radeonsi, renoir, LLVM 15.0.6, DRM 3.49, 6.1.0)", ""}) {
    EXPECT_FALSE(is_software_renderer(name)) << name;
  }
}

}  // namespace
}  // namespace gimbal::warp_scene
