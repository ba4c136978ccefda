#pragma once

#include <array>
#include <cstdint>

#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

// Pictures as cameras lay them out, written into `picture` as NV12. The source has the size of
// `picture`; of an odd size the last chroma sample stands for one column or row alone.

void copy_nv12(const std::array<ConstPlane, 2>& source, Nv12Buffer& picture);

/// The chroma planes of 4:2:0, of this size, as the one of NV12.
void interleave_chroma(ConstPlane u, ConstPlane v, ImageSize size, MutablePlane out);

/// How many chroma samples of a planar picture fall to one of NV12, across and down: 1 and 1 for
/// 4:2:0, 1 and 2 for 4:2:2, 2 and 1 for 4:4:0, 2 and 2 for 4:4:4.
struct ChromaShare {
  int across = 1;
  int down = 1;
};

/// Planes are Y, U and V. Chroma samples are averaged.
void convert_planar(const std::array<ConstPlane, 3>& source, ChromaShare share,
                    Nv12Buffer& picture);

/// Order of the four bytes that hold two neighbours of a row.
enum class Packing422 : std::uint8_t { yuyv, uyvy };

/// Each row holds (width + 1) / 2 groups of four bytes. The chroma of two rows is averaged.
void convert_packed_422(ConstPlane source, Packing422 packing, Nv12Buffer& picture);

/// Without colour: chroma is 128.
void convert_grey(ConstPlane source, Nv12Buffer& picture);

/// Order of a pixel's bytes in memory.
enum class RgbOrder : std::uint8_t { rgb, bgr };

/// Three bytes a pixel, to full-range Y'CbCr by the matrix of BT.601, as JPEG has it (JFIF 1.02,
/// p. 3). Chroma lies in the middle of the 2x2 pixels that it is the average of.
void convert_rgb(ConstPlane source, RgbOrder order, Nv12Buffer& picture);

}  // namespace gimbal
