#include "drivers/v4l2/picture_reader.hpp"

#include <algorithm>
#include <utility>

#include "pipeline/pixels/nv12_conversion.hpp"

namespace gimbal {
namespace {

bool is_nv12(PixelLayout layout) {
  return layout == PixelLayout::nv12 || layout == PixelLayout::nv12_two_memories;
}

std::optional<NativeFormat> native_format(PixelLayout layout) {
  switch (layout) {
    case PixelLayout::i420:
    case PixelLayout::yv12:  // the places of U and V are in this order, too
      return NativeFormat::i420;
    case PixelLayout::yuyv:
      return NativeFormat::yuyv;
    case PixelLayout::uyvy:
      return NativeFormat::uyvy;
    default:
      return std::nullopt;
  }
}

}  // namespace

PictureReader::PictureReader(PictureFormat format)
    : format_(std::move(format)), places_(places_of(format_)), least_bytes_(least_bytes(format_)) {}

std::optional<VideoFrame> PictureReader::read(const FilledBuffer& buffer, PictureStream& stream,
                                              const FrameStamp& stamp, PictureForm form) {
  if (!is_whole(buffer)) {
    stream.give_back(buffer.index);
    return std::nullopt;
  }
  if (can_stay(form)) {
    if (auto frame = in_place(buffer, stream, stamp)) return frame;
  }
  auto picture = converted(buffer);
  stream.give_back(buffer.index);
  if (!picture) return std::nullopt;
  return std::move(*picture).publish(stamp, format_.color);
}

bool PictureReader::is_whole(const FilledBuffer& buffer) const {
  return std::ranges::equal(
      buffer.memories.begin(),
      buffer.memories.begin() + static_cast<std::ptrdiff_t>(least_bytes_.size()),
      least_bytes_.begin(), least_bytes_.end(), std::ranges::greater_equal(),
      &FilledBuffer::Memory::bytes);
}

ConstPlane PictureReader::plane(const FilledBuffer& buffer, std::size_t index) const {
  const PlanePlace& place = places_[index];
  return {buffer.memories[place.memory].data + place.offset_bytes, place.stride_bytes};
}

template <std::size_t kCount>
std::optional<std::array<DmaBufPlane, kCount>> PictureReader::exported(
    const FilledBuffer& buffer) const {
  std::array<DmaBufPlane, kCount> planes;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const FilledBuffer::Memory& memory = buffer.memories[places_[i].memory];
    if (memory.dma_buf < 0) return std::nullopt;
    planes[i] = {memory.dma_buf, memory.offset_bytes + places_[i].offset_bytes};
  }
  return planes;
}

bool PictureReader::can_stay(PictureForm form) const {
  return is_nv12(format_.layout) ||
         (form == PictureForm::native && native_format(format_.layout).has_value());
}

std::optional<VideoFrame> PictureReader::in_place(const FilledBuffer& buffer, PictureStream& stream,
                                                  const FrameStamp& stamp) const {
  auto lease = stream.lend(buffer.index);
  if (!lease) return std::nullopt;
  VideoFrame frame;
  frame.stamp = stamp;
  frame.size = format_.size;
  frame.color = format_.color;
  frame.storage = std::move(lease);
  if (is_nv12(format_.layout)) {
    frame.planes = {plane(buffer, 0), plane(buffer, 1)};
    frame.dma_buf = exported<2>(buffer);
    return frame;
  }
  NativePicture& native = frame.native.emplace();
  native.format = *native_format(format_.layout);
  for (std::size_t i = 0; i < places_.size(); ++i) native.planes[i] = plane(buffer, i);
  native.dma_buf = exported<3>(buffer);
  return frame;
}

std::optional<Nv12Buffer> PictureReader::converted(const FilledBuffer& buffer) {
  if (format_.layout == PixelLayout::mjpeg) {
    return decoder_.decode({buffer.memories[0].data, buffer.memories[0].bytes}, format_.size);
  }
  Nv12Buffer picture(format_.size);
  switch (format_.layout) {
    case PixelLayout::nv12:
    case PixelLayout::nv12_two_memories:
      copy_nv12({plane(buffer, 0), plane(buffer, 1)}, picture);
      break;
    case PixelLayout::i420:
    case PixelLayout::yv12:
      convert_planar({plane(buffer, 0), plane(buffer, 1), plane(buffer, 2)}, {1, 1}, picture);
      break;
    case PixelLayout::uyvy:
      convert_packed_422(plane(buffer, 0), Packing422::uyvy, picture);
      break;
    case PixelLayout::yuyv:
      convert_packed_422(plane(buffer, 0), Packing422::yuyv, picture);
      break;
    case PixelLayout::grey:
      convert_grey(plane(buffer, 0), picture);
      break;
    case PixelLayout::mjpeg:
      break;
  }
  return picture;
}

}  // namespace gimbal
