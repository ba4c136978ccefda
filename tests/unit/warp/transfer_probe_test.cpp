#include "pipeline/warp/transfer_probe.hpp"

#include <gtest/gtest.h>

#include "pipeline/warp/egl_context.hpp"
#include "pipeline/warp/plane_format.hpp"

namespace gimbal {
namespace {

Result<Readback> probe(GlesVersion version, const std::string& channels) {
  const auto context = EglContext::create(version).value();
  MeshPainter painter = MeshPainter::create(channels, Interpolation::bilinear).value();
  return choose_readback(painter, context->major_version());
}

TEST(ReadbackProbe, PacksWhereOnlyGles2IsAllowed) {
  EXPECT_EQ(probe(GlesVersion::gles2, texture_channels(2)), Readback::packed);
}

TEST(ReadbackProbe, ReadsDirectlyOnMesasSoftwareRenderer) {
  const auto context = EglContext::create(GlesVersion::best).value();
  if (context->major_version() < 3) GTEST_SKIP() << "this renderer has no GLES 3";
  EXPECT_EQ(probe(GlesVersion::best, texture_channels(3)), Readback::direct);
}

TEST(ReadbackProbe, RefusesARendererThatDrawsWrongly) {
  const auto swapped = probe(GlesVersion::gles2, "ar");  // U and V change places
  ASSERT_FALSE(swapped);
  EXPECT_EQ(swapped.error().kind, Error::Kind::failed);
}

TEST(ConversionProbe, BelievesNoRendererThatDrawsWrongly) {
  const auto context = EglContext::create(GlesVersion::best).value();
  const int version = context->major_version();
  MeshPainter right =
      MeshPainter::create(texture_channels(version), Interpolation::bilinear).value();
  MeshPainter swapped = MeshPainter::create("gr", Interpolation::bilinear).value();
  const Readback readback = choose_readback(right, version).value();
  for (const NativeFormat format : {NativeFormat::i420, NativeFormat::yuyv, NativeFormat::uyvy,
                                    NativeFormat::rgb, NativeFormat::bgr}) {
    EXPECT_TRUE(converts_as_the_processor(right, format, version, readback)) << name_of(format);
    EXPECT_FALSE(converts_as_the_processor(swapped, format, version, readback)) << name_of(format);
  }
}

TEST(MeshPainter, SaysWhatTheShaderCompilerSays) {
  const auto context = EglContext::create(GlesVersion::best).value();
  const auto painter = MeshPainter::create("no_such_channels", Interpolation::bilinear);
  ASSERT_FALSE(painter);
  EXPECT_NE(painter.error().message.find("refuses the fragment shader: "), std::string::npos);
  EXPECT_EQ(painter.error().message.find('\n'), std::string::npos);
}

}  // namespace
}  // namespace gimbal
