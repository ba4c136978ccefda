#include "pipeline/pixels/nv12_conversion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <ostream>
#include <vector>

namespace gimbal {

// For the names of parametrised tests.
void PrintTo(const ImageSize& size, std::ostream* out) {
  *out << size.width << "x" << size.height;
}

namespace {

/// A value for each place of a plane, without a pattern that a mistake could share.
std::uint8_t value_at(int plane, int x, int y) {
  return static_cast<std::uint8_t>((x * 53 + y * 97 + plane * 71 + x * y * 13) % 256);
}

/// Rows further apart than they are long, and bytes between them that no picture may show.
class PaddedPlane {
 public:
  PaddedPlane(int row_bytes, int rows, const std::function<std::uint8_t(int, int)>& value)
      : stride_(row_bytes + 5), bytes_(static_cast<std::size_t>(stride_ * rows), 0xEE) {
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < row_bytes; ++x) {
        bytes_[static_cast<std::size_t>(y * stride_ + x)] = value(x, y);
      }
    }
  }
  [[nodiscard]] ConstPlane plane() const { return {bytes_.data(), stride_}; }

 private:
  int stride_;
  std::vector<std::uint8_t> bytes_;
};

int luma_at(const Nv12Buffer& picture, int x, int y) {
  return picture.luma().data[y * picture.luma().stride_bytes + x];
}

int chroma_at(const Nv12Buffer& picture, int channel, int x, int y) {
  return picture.chroma().data[y * picture.chroma().stride_bytes + 2 * x + channel];
}

/// What chroma channel `channel` is in the middle of a 2x2 block of pixels, of which those outside
/// of the picture do not count.
double mean_of_block(ImageSize size, int x, int y, const std::function<double(int, int)>& value) {
  double sum = 0;
  int count = 0;
  for (int row = 2 * y; row < std::min(2 * y + 2, size.height); ++row) {
    for (int column = 2 * x; column < std::min(2 * x + 2, size.width); ++column) {
      sum += value(column, row);
      ++count;
    }
  }
  return sum / count;
}

class Nv12Conversion : public ::testing::TestWithParam<ImageSize> {
 protected:
  ImageSize size_ = GetParam();
  ImageSize chroma_ = chroma_size(size_);
  Nv12Buffer picture_{size_};

  void expect_luma(const std::function<double(int, int)>& value, double tolerance) const {
    for (int y = 0; y < size_.height; ++y) {
      for (int x = 0; x < size_.width; ++x) {
        ASSERT_NEAR(luma_at(picture_, x, y), value(x, y), tolerance) << x << "," << y;
      }
    }
  }

  void expect_chroma(const std::function<double(int, int, int)>& value, double tolerance) const {
    for (int y = 0; y < chroma_.height; ++y) {
      for (int x = 0; x < chroma_.width; ++x) {
        for (const int channel : {0, 1}) {
          ASSERT_NEAR(chroma_at(picture_, channel, x, y), value(channel, x, y), tolerance)
              << channel << " at " << x << "," << y;
        }
      }
    }
  }

  static double luma_value(int x, int y) { return value_at(0, x, y); }
};

TEST_P(Nv12Conversion, Nv12IsCopied) {
  const PaddedPlane luma(size_.width, size_.height, [](int x, int y) { return value_at(0, x, y); });
  const PaddedPlane chroma(2 * chroma_.width, chroma_.height,
                           [](int x, int y) { return value_at(1, x, y); });
  copy_nv12({luma.plane(), chroma.plane()}, picture_);
  expect_luma(luma_value, 0);
  expect_chroma([](int channel, int x, int y) { return value_at(1, 2 * x + channel, y); }, 0);
}

TEST_P(Nv12Conversion, PlanesOf420AreInterleaved) {
  const auto plane = [&](int index) {
    const ImageSize size = index == 0 ? size_ : chroma_;
    return PaddedPlane(size.width, size.height,
                       [index](int x, int y) { return value_at(index, x, y); });
  };
  const PaddedPlane y = plane(0);
  const PaddedPlane u = plane(1);
  const PaddedPlane v = plane(2);
  convert_planar({y.plane(), u.plane(), v.plane()}, {1, 1}, picture_);
  expect_luma(luma_value, 0);
  expect_chroma([](int channel, int column, int row) { return value_at(1 + channel, column, row); },
                0);
}

TEST_P(Nv12Conversion, ChromaOfOtherPlanarLayoutsIsAveraged) {
  for (const ChromaShare share : {ChromaShare{1, 2}, ChromaShare{2, 1}, ChromaShare{2, 2}}) {
    const ImageSize source = {share.across == 2 ? size_.width : chroma_.width,
                              share.down == 2 ? size_.height : chroma_.height};
    const PaddedPlane y(size_.width, size_.height, [](int c, int r) { return value_at(0, c, r); });
    const PaddedPlane u(source.width, source.height,
                        [](int c, int r) { return value_at(1, c, r); });
    const PaddedPlane v(source.width, source.height,
                        [](int c, int r) { return value_at(2, c, r); });
    convert_planar({y.plane(), u.plane(), v.plane()}, share, picture_);
    expect_luma(luma_value, 0);
    expect_chroma(
        [&](int channel, int x, int row) {
          return mean_of_block(size_, x, row, [&](int c, int r) {
            return value_at(1 + channel, c * share.across / 2, r * share.down / 2);
          });
        },
        0.5);
  }
}

TEST_P(Nv12Conversion, PackedRowsAreTakenApart) {
  // In YUYV: Y at even bytes, U and V in turn at odd ones. UYVY has each two the other way round.
  const PaddedPlane yuyv(4 * chroma_.width, size_.height,
                         [](int x, int y) { return value_at(3, x, y); });
  const PaddedPlane uyvy(4 * chroma_.width, size_.height,
                         [](int x, int y) { return value_at(3, x ^ 1, y); });
  for (const auto& [source, packing] :
       {std::pair(&yuyv, Packing422::yuyv), std::pair(&uyvy, Packing422::uyvy)}) {
    convert_packed_422(source->plane(), packing, picture_);
    expect_luma([](int x, int y) { return value_at(3, 2 * x, y); }, 0);
    expect_chroma(
        [&](int channel, int x, int y) {
          return mean_of_block(
              size_, x, y, [&](int, int row) { return value_at(3, 4 * x + 1 + 2 * channel, row); });
        },
        0.5);
  }
}

TEST_P(Nv12Conversion, GreyHasNoColour) {
  const PaddedPlane grey(size_.width, size_.height, [](int x, int y) { return value_at(0, x, y); });
  convert_grey(grey.plane(), picture_);
  expect_luma(luma_value, 0);
  expect_chroma([](int, int, int) { return 128; }, 0);
}

TEST_P(Nv12Conversion, RgbFollowsTheEquationsOfJfif) {
  const auto red = [](int x, int y) { return static_cast<double>(value_at(3, 3 * x, y)); };
  const auto green = [](int x, int y) { return static_cast<double>(value_at(3, 3 * x + 1, y)); };
  const auto blue = [](int x, int y) { return static_cast<double>(value_at(3, 3 * x + 2, y)); };
  const PaddedPlane rgb(3 * size_.width, size_.height,
                        [](int x, int y) { return value_at(3, x, y); });
  const PaddedPlane bgr(3 * size_.width, size_.height,
                        [](int x, int y) { return value_at(3, x / 3 * 3 + (2 - x % 3), y); });
  for (const auto& [source, order] :
       {std::pair(&rgb, RgbOrder::rgb), std::pair(&bgr, RgbOrder::bgr)}) {
    convert_rgb(source->plane(), order, picture_);
    expect_luma(
        [&](int x, int y) { return 0.299 * red(x, y) + 0.587 * green(x, y) + 0.114 * blue(x, y); },
        0.51);
    expect_chroma(
        [&](int channel, int x, int y) {
          const double r = mean_of_block(size_, x, y, red);
          const double g = mean_of_block(size_, x, y, green);
          const double b = mean_of_block(size_, x, y, blue);
          const double exact = channel == 0 ? -0.1687 * r - 0.3313 * g + 0.5 * b + 128
                                            : 0.5 * r - 0.4187 * g - 0.0813 * b + 128;
          return std::clamp(exact, 0.0, 255.0);
        },
        0.52);
  }
}

TEST(Nv12Conversion, ExtremeColoursStayInRange) {
  const std::vector<std::uint8_t> pixels = {0, 0, 255, 0, 0, 255, 0, 0, 255, 0, 0, 255};
  Nv12Buffer picture({2, 2});
  convert_rgb({pixels.data(), 6}, RgbOrder::rgb, picture);
  EXPECT_EQ(luma_at(picture, 0, 0), 29);
  EXPECT_EQ(chroma_at(picture, 0, 0, 0), 255);
  convert_rgb({pixels.data(), 6}, RgbOrder::bgr, picture);
  EXPECT_EQ(luma_at(picture, 0, 0), 76);
  EXPECT_EQ(chroma_at(picture, 1, 0, 0), 255);
}

INSTANTIATE_TEST_SUITE_P(Sizes, Nv12Conversion,
                         ::testing::Values(ImageSize{8, 6}, ImageSize{7, 5}, ImageSize{66, 3},
                                           ImageSize{2, 1}, ImageSize{1, 2}, ImageSize{1, 1}));

}  // namespace
}  // namespace gimbal
