#include "drivers/v4l2/picture_reader.hpp"

#include <algorithm>
#include <utility>

#include "pipeline/pixels/nv12_conversion.hpp"

namespace gimbal {

PictureReader::PictureReader(PictureFormat format)
    : format_(std::move(format)), places_(places_of(format_)), least_bytes_(least_bytes(format_)) {}

std::optional<VideoFrame> PictureReader::read(const FilledBuffer& buffer, PictureStream& stream,
                                              const FrameStamp& stamp) {
  if (!is_whole(buffer)) {
    stream.give_back(buffer.index);
    return std::nullopt;
  }
  if (auto frame = in_place(buffer, stream, stamp)) return frame;
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

std::optional<VideoFrame> PictureReader::in_place(const FilledBuffer& buffer, PictureStream& stream,
                                                  const FrameStamp& stamp) const {
  const bool is_nv12 =
      format_.layout == PixelLayout::nv12 || format_.layout == PixelLayout::nv12_two_memories;
  if (!is_nv12) return std::nullopt;
  auto lease = stream.lend(buffer.index);
  if (!lease) return std::nullopt;
  VideoFrame frame;
  frame.stamp = stamp;
  frame.size = format_.size;
  frame.color = format_.color;
  frame.planes = {plane(buffer, 0), plane(buffer, 1)};
  frame.storage = std::move(lease);
  std::array<DmaBufPlane, 2> dma_buf;
  bool is_exported = true;
  for (std::size_t i = 0; i < dma_buf.size(); ++i) {
    const FilledBuffer::Memory& memory = buffer.memories[places_[i].memory];
    dma_buf[i] = {memory.dma_buf, memory.offset_bytes + places_[i].offset_bytes};
    is_exported = is_exported && memory.dma_buf >= 0;
  }
  if (is_exported) frame.dma_buf = dma_buf;
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
