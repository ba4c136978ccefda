// How sharp pictures stay, and what becomes of what is too fine for them.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pipeline/warp/warper.hpp"
#include "tests/unit/warp/slanted_edge.hpp"
#include "tests/unit/warp/warp_scene.hpp"

namespace gimbal::warp_scene {
namespace {

using Eigen::Vector2d;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kZoom = 1.15;

/// What a usual stabilized frame goes through: a roll of 3 degrees and a zoom of 1.15.
struct ZoomAndRoll {
  ImageSize size;

  [[nodiscard]] Vector2d middle() const {
    return {(size.width - 1) / 2.0, (size.height - 1) / 2.0};
  }
  [[nodiscard]] Eigen::Matrix2d turn() const {
    return Eigen::Rotation2D<double>(3 * kDegree).toRotationMatrix();
  }
  [[nodiscard]] WarpMesh mesh() const {
    return mesh_of_map(size, size, Border::crop, [this](const Vector2d& source) {
      return Vector2d(middle() + kZoom * (turn() * (source - middle())));
    });
  }
};

struct Sharpness {
  double bilinear;  ///< shares of the MTF50 of an ideal resampler
  double bicubic;
};

/// An ideal resampler gives what the lens drew at each output pixel's own place.
Sharpness sharpness_of_edge(double edge_angle, double blur_px) {
  const ZoomAndRoll map{{320, 240}};
  const Vector2d normal(std::cos(edge_angle), std::sin(edge_angle));
  const SlantedEdge edge{map.middle() + Vector2d(0.3, 0.1), normal, blur_px};
  const Vector2d turned_point =
      map.middle() + kZoom * (map.turn() * (edge.point_px - map.middle()));
  const Vector2d turned_normal = map.turn() * normal;
  const SlantedEdge ideal{turned_point, turned_normal, kZoom * blur_px};
  const auto mtf50_of = [&](const VideoFrame& picture) {
    return mtf50(picture, turned_point, turned_normal, 12);
  };
  const VideoFrame source = draw_edge(edge, map.size);
  const WarpMesh mesh = map.mesh();
  const double best = mtf50_of(draw_edge(ideal, map.size));
  // The measure itself: a Gaussian's MTF falls to one half at sqrt(ln 2 / 2) / (pi sigma).
  EXPECT_NEAR(best, std::sqrt(std::numbers::ln2 / 2) / (std::numbers::pi * kZoom * blur_px),
              0.01 * best);
  const auto share = [&](Interpolation interpolation) {
    return mtf50_of(make_cpu_warper(1, interpolation)->warp(source, mesh).value()) / best;
  };
  return {share(Interpolation::bilinear), share(Interpolation::bicubic)};
}

TEST(Sharpness, BicubicKeepsMostOfAnIdealResamplers) {
  // Blurs of half a pixel and a little more: as sharp as cameras' pictures are.
  for (const double blur_px : {0.5, 0.6, 0.7}) {
    for (const double angle : {5.0, 95.0}) {
      const Sharpness sharpness = sharpness_of_edge(angle * kDegree, blur_px);
      std::printf("blur %.1f px, edge at %.0f degrees: bilinear %.3f, bicubic %.3f of ideal\n",
                  blur_px, angle, sharpness.bilinear, sharpness.bicubic);
      EXPECT_GE(sharpness.bicubic, 0.85);
      EXPECT_LT(sharpness.bicubic, 1.03);
      EXPECT_LT(sharpness.bilinear, sharpness.bicubic - 0.04);
    }
  }
}

/// Rings that are finer the farther out: at the corners far finer than a shrunk picture can show.
VideoFrame make_zone_plate(ImageSize size) {
  Nv12Buffer picture(size);
  const Vector2d middle((size.width - 1) / 2.0, (size.height - 1) / 2.0);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const double phase = std::numbers::pi * (Vector2d(x, y) - middle).squaredNorm() / size.width;
      picture.luma().data[y * picture.luma().stride_bytes + x] =
          static_cast<std::uint8_t>(std::lround(127.5 + 120 * std::cos(phase)));
    }
  }
  for (int y = 0; y < chroma_size(size).height; ++y) {
    std::fill_n(picture.chroma().data + y * picture.chroma().stride_bytes,
                2 * chroma_size(size).width, std::uint8_t{128});
  }
  return std::move(picture).publish({}, {});
}

cv::Mat luma_of(const VideoFrame& frame) {
  return cv::Mat(frame.size.height, frame.size.width, CV_8UC1,
                 const_cast<std::uint8_t*>(frame.planes[0].data),
                 static_cast<std::size_t>(frame.planes[0].stride_bytes));
}

double rms_difference(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_L2) / std::sqrt(static_cast<double>(a.total()));
}

TEST(Sharpness, ShrinkingDoesNotAlias) {
  const ImageSize size{720, 480};
  const VideoFrame plate = make_zone_plate(size);
  for (const double factor : {1.6, 2.5, 3.2}) {
    const ImageSize small{static_cast<int>(size.width / factor),
                          static_cast<int>(size.height / factor)};
    const WarpMesh mesh = mesh_of_map(size, small, Border::crop, [&](const Vector2d& source) {
      return Vector2d((source.array() + 0.5) / factor - 0.5);
    });
    cv::Mat area;
    cv::resize(luma_of(plate), area, cv::Size(small.width, small.height), 0, 0, cv::INTER_AREA);
    cv::Mat aliased;
    cv::resize(luma_of(plate), aliased, cv::Size(small.width, small.height), 0, 0,
               cv::INTER_LINEAR);
    for (const Interpolation interpolation : {Interpolation::bilinear, Interpolation::bicubic}) {
      const VideoFrame drawn = make_cpu_warper(1, interpolation)->warp(plate, mesh).value();
      const double error = rms_difference(luma_of(drawn), area);
      std::printf("to 1/%.1f: %.2f levels from the mean over each pixel (one sample: %.2f)\n",
                  factor, error, rms_difference(aliased, area));
      // Kernels that are not as wide as a pixel's area leave something of the difference.
      EXPECT_LT(error, rms_difference(aliased, area) / 3);
    }
  }
}

}  // namespace
}  // namespace gimbal::warp_scene
