#include "pipeline/pixels/nv12_frame.hpp"

#include <utility>

#include "pipeline/pixels/nv12_conversion.hpp"

namespace gimbal {
namespace {

void convert(const NativePicture& native, Nv12Buffer& picture) {
  switch (native.format) {
    case NativeFormat::i420:
      return convert_planar(native.planes, {1, 1}, picture);
    case NativeFormat::yuyv:
      return convert_packed_422(native.planes[0], Packing422::yuyv, picture);
    case NativeFormat::uyvy:
      return convert_packed_422(native.planes[0], Packing422::uyvy, picture);
    case NativeFormat::rgb:
      return convert_rgb(native.planes[0], RgbOrder::rgb, picture);
    case NativeFormat::bgr:
      return convert_rgb(native.planes[0], RgbOrder::bgr, picture);
  }
}

}  // namespace

VideoFrame as_nv12(const VideoFrame& frame) {
  if (!frame.native) return frame;
  Nv12Buffer picture(frame.size);
  convert(*frame.native, picture);
  return std::move(picture).publish(frame.stamp, frame.color);
}

}  // namespace gimbal
