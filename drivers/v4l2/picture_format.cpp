#include "drivers/v4l2/picture_format.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <iterator>
#include <system_error>

#include "drivers/v4l2/colorimetry.hpp"

namespace gimbal {
namespace {

/// Against drivers whose lists have no end.
constexpr std::uint32_t kMostListed = 256;

/// Half of what 30 and 29.97 differ by would be too fine, 24 and 25 have to differ.
constexpr double kSameRate = 0.01;

constexpr double kUsualRate_hz = 30;

bool is_same_rate(double a, double b) {
  return std::abs(a - b) <= kSameRate * b;
}

template <std::size_t kSize>
std::string text_of(const __u8 (&field)[kSize]) {
  const auto* end = std::find(std::begin(field), std::end(field), 0);
  return {std::begin(field), end};
}

std::string text_of(ImageSize size) {
  return fmt::format("{}x{}", size.width, size.height);
}

ImageSize size_of(std::uint32_t width, std::uint32_t height) {
  return {static_cast<int>(width), static_cast<int>(height)};
}

std::string obstacle_of(std::uint32_t caps, std::uint32_t type) {
  if ((caps & (V4L2_CAP_VIDEO_M2M | V4L2_CAP_VIDEO_M2M_MPLANE)) != 0) {
    return "converts pictures, takes none itself";
  }
  if (type == 0 && (caps & V4L2_CAP_META_CAPTURE) != 0) return "metadata node, no pictures";
  if (type == 0 && (caps & (V4L2_CAP_VIDEO_OUTPUT | V4L2_CAP_VIDEO_OUTPUT_MPLANE)) != 0) {
    return "shows pictures, takes none";
  }
  if (type == 0) return "delivers no pictures";
  if ((caps & V4L2_CAP_STREAMING) == 0) return "has no streaming I/O";
  return {};
}

/// Frames in a second; 0 where the fraction has none.
double rate_of(const v4l2_fract& interval) {
  return interval.numerator == 0 ? 0
                                 : static_cast<double>(interval.denominator) / interval.numerator;
}

std::vector<double> rates_of(V4l2Device& device, std::uint32_t fourcc, ImageSize size) {
  std::vector<double> rates;
  for (std::uint32_t index = 0; index < kMostListed; ++index) {
    v4l2_frmivalenum listed{};
    listed.index = index;
    listed.pixel_format = fourcc;
    listed.width = static_cast<std::uint32_t>(size.width);
    listed.height = static_cast<std::uint32_t>(size.height);
    if (device.request(VIDIOC_ENUM_FRAMEINTERVALS, &listed) != 0) break;
    if (listed.type != V4L2_FRMIVAL_TYPE_DISCRETE) return {};
    rates.push_back(rate_of(listed.discrete));
  }
  std::ranges::sort(rates, std::greater<>());
  return rates;
}

bool is_in(const v4l2_frmsize_stepwise& range, ImageSize size) {
  const auto fits = [](std::uint32_t value, std::uint32_t low, std::uint32_t high,
                       std::uint32_t step) {
    return value >= low && value <= high && (step <= 1 || (value - low) % step == 0);
  };
  return fits(static_cast<std::uint32_t>(size.width), range.min_width, range.max_width,
              range.step_width) &&
         fits(static_cast<std::uint32_t>(size.height), range.min_height, range.max_height,
              range.step_height);
}

void list_sizes(V4l2Device& device, OfferedFormat& format, std::optional<ImageSize> asked) {
  for (std::uint32_t index = 0; index < kMostListed; ++index) {
    v4l2_frmsizeenum listed{};
    listed.index = index;
    listed.pixel_format = format.fourcc;
    if (device.request(VIDIOC_ENUM_FRAMESIZES, &listed) != 0) return;
    if (listed.type != V4L2_FRMSIZE_TYPE_DISCRETE) {
      const auto& range = listed.stepwise;
      format.range = {size_of(range.min_width, range.min_height),
                      size_of(range.max_width, range.max_height)};
      if (asked && is_in(range, *asked)) {
        format.sizes.push_back({*asked, rates_of(device, format.fourcc, *asked)});
      }
      return;
    }
    const ImageSize size = size_of(listed.discrete.width, listed.discrete.height);
    format.sizes.push_back({size, rates_of(device, format.fourcc, size)});
  }
}

bool lists_no_sizes(const OfferedFormat& format) {
  return format.sizes.empty() && !format.range;
}

const OfferedSize* find_size(const OfferedFormat& format, ImageSize size) {
  const auto found =
      std::ranges::find_if(format.sizes, [&](const OfferedSize& s) { return s.size == size; });
  return found == format.sizes.end() ? nullptr : &*found;
}

bool reaches(const OfferedFormat& format, std::optional<ImageSize> size, double fps) {
  const OfferedSize* offered = size ? find_size(format, *size) : nullptr;
  return offered == nullptr || offered->rates_hz.empty() ||
         std::ranges::any_of(offered->rates_hz, [&](double r) { return is_same_rate(r, fps); });
}

struct Candidate {
  KnownPixelFormat known;
  const OfferedFormat* offered;
};

std::vector<Candidate> readable(const std::vector<OfferedFormat>& offered) {
  std::vector<Candidate> candidates;
  for (const KnownPixelFormat& known : known_pixel_formats()) {
    const auto found = std::ranges::find_if(
        offered, [&](const OfferedFormat& f) { return f.fourcc == known.fourcc; });
    if (found != offered.end()) candidates.push_back({known, &*found});
  }
  return candidates;
}

std::string list_of(const std::vector<OfferedFormat>& offered) {
  std::vector<std::string> lines;
  lines.reserve(offered.size());
  for (const OfferedFormat& format : offered) lines.push_back(describe(format));
  return fmt::format("{}", fmt::join(lines, "; "));
}

/// A picture is wanted at this rate by whoever does not say: the usual one, if it is reached.
double usual_rate(const std::vector<Candidate>& candidates, std::optional<ImageSize> size) {
  double highest = 0;
  for (const Candidate& candidate : candidates) {
    const OfferedSize* offered = size ? find_size(*candidate.offered, *size) : nullptr;
    if (offered == nullptr) continue;
    for (const double rate : offered->rates_hz) {
      if (rate <= kUsualRate_hz * (1 + kSameRate)) highest = std::max(highest, rate);
    }
  }
  return highest;
}

/// MPEG and H.264 put chroma to the left, JPEG into the middle. 4:2:2 is sited left by BT.601.
ChromaSiting siting_of(PixelLayout layout) {
  return layout == PixelLayout::mjpeg ? ChromaSiting::center : ChromaSiting::left;
}

void fill_in(const v4l2_pix_format& pix, PictureFormat& format) {
  format.size = size_of(pix.width, pix.height);
  format.fourcc = pix.pixelformat;
  format.memories = {{static_cast<std::ptrdiff_t>(pix.bytesperline), pix.sizeimage}};
  format.color = color_info({pix.colorspace, pix.ycbcr_enc, pix.quantization, pix.xfer_func},
                            siting_of(format.layout));
}

void fill_in(const v4l2_pix_format_mplane& pix, PictureFormat& format) {
  format.size = size_of(pix.width, pix.height);
  format.fourcc = pix.pixelformat;
  format.memories.clear();
  for (std::size_t i = 0; i < std::min<std::size_t>(pix.num_planes, VIDEO_MAX_PLANES); ++i) {
    format.memories.push_back(
        {static_cast<std::ptrdiff_t>(pix.plane_fmt[i].bytesperline), pix.plane_fmt[i].sizeimage});
  }
  format.color = color_info({pix.colorspace, pix.ycbcr_enc, pix.quantization, pix.xfer_func},
                            siting_of(format.layout));
}

std::uint32_t field_order(const v4l2_format& format) {
  return V4L2_TYPE_IS_MULTIPLANAR(format.type) ? format.fmt.pix_mp.field : format.fmt.pix.field;
}

/// What follows from a size is left for the driver to fill in.
template <typename Pix>
void ask_for(Pix& pix, std::uint32_t fourcc, ImageSize size) {
  pix = {};
  pix.width = static_cast<std::uint32_t>(size.width);
  pix.height = static_cast<std::uint32_t>(size.height);
  pix.pixelformat = fourcc;
  pix.field = V4L2_FIELD_NONE;
}

std::string reason(int error, const std::string& users) {
  if (error == EBUSY) return "busy: in use by " + (users.empty() ? "another program" : users);
  return std::generic_category().message(error);
}

/// Sets the rate, if one is wished and the device can; returns that which it has then, or 0.
Result<double> set_rate(V4l2Device& device, std::uint32_t type, std::optional<double> fps) {
  v4l2_streamparm parameters{};
  parameters.type = type;
  if (device.request(VIDIOC_G_PARM, &parameters) != 0) return 0.0;
  v4l2_captureparm& capture = parameters.parm.capture;
  if (fps && (capture.capability & V4L2_CAP_TIMEPERFRAME) != 0) {
    constexpr std::uint32_t kUnit = 1'000'000;
    capture.timeperframe = {kUnit, static_cast<std::uint32_t>(std::lround(*fps * kUnit))};
    const int error = device.request(VIDIOC_S_PARM, &parameters);
    if (error != 0) return failed("the rate cannot be set: " + reason(error, ""));
  }
  const double rate = rate_of(capture.timeperframe);
  if (fps && rate > 0 && !is_same_rate(rate, *fps)) {
    return bad_input(fmt::format("gives {:.4g} frames a second instead of {:.4g}", rate, *fps));
  }
  return rate;
}

Result<void> check_memories(const PictureFormat& format) {
  const std::vector<std::size_t> least = least_bytes(format);
  if (format.memories.empty() || format.memories.size() < least.size()) {
    return failed("the driver describes fewer planes than the format has");
  }
  for (std::size_t i = 0; i < least.size(); ++i) {
    if (format.memories[i].bytes < least[i]) {
      return failed(fmt::format(
          "the driver's buffers of {} bytes are too small for {} {}, {} bytes",
          format.memories[i].bytes, text_of(format.size), name_of_fourcc(format.fourcc), least[i]));
    }
  }
  return {};
}

/// A plane's rows, and their bytes.
struct PlaneExtent {
  std::ptrdiff_t row_bytes;
  std::ptrdiff_t rows;
};

PlaneExtent extent_of(const PictureFormat& format, std::size_t plane) {
  const ImageSize size = format.size;
  const ImageSize chroma = chroma_size(size);
  switch (format.layout) {
    case PixelLayout::uyvy:
    case PixelLayout::yuyv:
      return {std::ptrdiff_t{4} * chroma.width, size.height};
    case PixelLayout::nv12:
    case PixelLayout::nv12_two_memories:
      if (plane == 1) return {std::ptrdiff_t{2} * chroma.width, chroma.height};
      break;
    case PixelLayout::i420:
    case PixelLayout::yv12:
      if (plane > 0) return {chroma.width, chroma.height};
      break;
    case PixelLayout::mjpeg:
    case PixelLayout::grey:
      break;
  }
  return {size.width, size.height};
}

}  // namespace

const std::vector<KnownPixelFormat>& known_pixel_formats() {
  static const std::vector<KnownPixelFormat> formats = {
      {V4L2_PIX_FMT_NV12, PixelLayout::nv12},
      {V4L2_PIX_FMT_NV12M, PixelLayout::nv12_two_memories},
      {V4L2_PIX_FMT_YUV420, PixelLayout::i420},
      {V4L2_PIX_FMT_YVU420, PixelLayout::yv12},
      {V4L2_PIX_FMT_UYVY, PixelLayout::uyvy},
      {V4L2_PIX_FMT_YUYV, PixelLayout::yuyv},
      {V4L2_PIX_FMT_MJPEG, PixelLayout::mjpeg},
      {V4L2_PIX_FMT_JPEG, PixelLayout::mjpeg},
      {V4L2_PIX_FMT_GREY, PixelLayout::grey},
  };
  return formats;
}

std::string name_of_fourcc(std::uint32_t fourcc) {
  std::string name;
  for (int shift = 0; shift < 32; shift += 8) {
    const auto letter = static_cast<char>((fourcc >> shift) & 0x7F);
    if (letter > ' ' && letter <= '~') name += letter;
  }
  return name;
}

Result<NodeIdentity> identify(V4l2Device& device) {
  v4l2_capability capability{};
  if (device.request(VIDIOC_QUERYCAP, &capability) != 0) {
    return bad_input("is no video device");
  }
  const std::uint32_t caps = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0
                                 ? capability.device_caps
                                 : capability.capabilities;
  NodeIdentity identity{text_of(capability.card), text_of(capability.bus_info), 0, {}};
  if ((caps & V4L2_CAP_VIDEO_CAPTURE_MPLANE) != 0) {
    identity.type = V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
  } else if ((caps & V4L2_CAP_VIDEO_CAPTURE) != 0) {
    identity.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  }
  identity.obstacle = obstacle_of(caps, identity.type);
  return identity;
}

std::vector<OfferedFormat> offered_formats(V4l2Device& device, std::uint32_t type,
                                           std::optional<ImageSize> size) {
  std::vector<OfferedFormat> formats;
  for (std::uint32_t index = 0; index < kMostListed; ++index) {
    v4l2_fmtdesc listed{};
    listed.index = index;
    listed.type = type;
    if (device.request(VIDIOC_ENUM_FMT, &listed) != 0) break;
    formats.push_back({listed.pixelformat, {}, {}});
    list_sizes(device, formats.back(), size);
  }
  return formats;
}

std::string describe(const OfferedFormat& format) {
  std::vector<std::string> sizes;
  sizes.reserve(format.sizes.size());
  for (const OfferedSize& offered : format.sizes) {
    sizes.push_back(offered.rates_hz.empty() ? text_of(offered.size)
                                             : fmt::format("{} ({:.4g} fps)", text_of(offered.size),
                                                           fmt::join(offered.rates_hz, ", ")));
  }
  std::string text = name_of_fourcc(format.fourcc);
  if (format.range) {
    text += fmt::format(": {} to {}", text_of((*format.range)[0]), text_of((*format.range)[1]));
    if (!sizes.empty()) text += fmt::format(", such as {}", fmt::join(sizes, ", "));
  } else if (!sizes.empty()) {
    text += fmt::format(": {}", fmt::join(sizes, ", "));
  }
  return text;
}

Result<KnownPixelFormat> choose_format(const std::vector<OfferedFormat>& offered,
                                       const FormatWish& wish) {
  std::vector<Candidate> candidates = readable(offered);
  if (candidates.empty()) {
    return bad_input(fmt::format(
        "delivers no pixel format that this driver reads ({}); a raw sensor needs the libcamera "
        "driver",
        offered.empty() ? "it lists none" : list_of(offered)));
  }
  if (wish.pixel_format != "auto") {
    std::erase_if(candidates, [&](const Candidate& c) {
      return name_of_fourcc(c.known.fourcc) != wish.pixel_format;
    });
    if (candidates.empty()) {
      return bad_input(fmt::format("does not offer pixel format {}; it offers {}",
                                   wish.pixel_format, list_of(offered)));
    }
  }
  if (wish.size) {
    std::erase_if(candidates, [&](const Candidate& c) {
      return !lists_no_sizes(*c.offered) && find_size(*c.offered, *wish.size) == nullptr;
    });
    if (candidates.empty()) {
      return bad_input(
          fmt::format("does not offer {}; it offers {}", text_of(*wish.size), list_of(offered)));
    }
  }
  const double fps = wish.fps ? *wish.fps : usual_rate(candidates, wish.size);
  const auto found = std::ranges::find_if(candidates, [&](const Candidate& c) {
    return fps == 0 || reaches(*c.offered, wish.size, fps);
  });
  if (found == candidates.end()) {
    return bad_input(
        fmt::format("does not offer {:.4g} frames a second; it offers {}", fps, list_of(offered)));
  }
  return found->known;
}

std::optional<ImageSize> current_size(V4l2Device& device, std::uint32_t type) {
  v4l2_format format{};
  format.type = type;
  if (device.request(VIDIOC_G_FMT, &format) != 0) return std::nullopt;
  const ImageSize size = V4L2_TYPE_IS_MULTIPLANAR(type)
                             ? size_of(format.fmt.pix_mp.width, format.fmt.pix_mp.height)
                             : size_of(format.fmt.pix.width, format.fmt.pix.height);
  if (size.width <= 0 || size.height <= 0) return std::nullopt;
  return size;
}

Result<PictureFormat> set_format(V4l2Device& device, std::uint32_t type, KnownPixelFormat format,
                                 const FormatWish& wish, const std::string& users) {
  const ImageSize size = wish.size.value_or(ImageSize{640, 480});
  v4l2_format wanted{};
  wanted.type = type;
  if (V4L2_TYPE_IS_MULTIPLANAR(type)) {
    ask_for(wanted.fmt.pix_mp, format.fourcc, size);
  } else {
    ask_for(wanted.fmt.pix, format.fourcc, size);
  }
  const int error = device.request(VIDIOC_S_FMT, &wanted);
  if (error != 0) return failed(reason(error, users));

  PictureFormat set;
  set.type = type;
  set.layout = format.layout;
  if (V4L2_TYPE_IS_MULTIPLANAR(type)) {
    fill_in(wanted.fmt.pix_mp, set);
  } else {
    fill_in(wanted.fmt.pix, set);
  }
  if (set.fourcc != format.fourcc || (wish.size && set.size != *wish.size)) {
    return bad_input(fmt::format("gives {} {} instead of {} {}", name_of_fourcc(set.fourcc),
                                 text_of(set.size), name_of_fourcc(format.fourcc), text_of(size)));
  }
  if (field_order(wanted) != V4L2_FIELD_NONE && field_order(wanted) != V4L2_FIELD_ANY) {
    return bad_input("delivers interlaced pictures, whose rows belong to two instants");
  }
  if (auto checked = check_memories(set); !checked) return tl::unexpected(checked.error());
  const auto rate = set_rate(device, type, wish.fps);
  if (!rate) return tl::unexpected(rate.error());
  set.fps = *rate;
  return set;
}

std::vector<PlanePlace> places_of(const PictureFormat& format) {
  const std::ptrdiff_t stride = format.memories[0].stride_bytes;
  const std::ptrdiff_t luma_bytes = stride * format.size.height;
  const std::ptrdiff_t chroma_bytes = stride / 2 * chroma_size(format.size).height;
  const PlanePlace luma = {0, 0, stride};
  switch (format.layout) {
    case PixelLayout::nv12:
      return {luma, {0, luma_bytes, stride}};
    case PixelLayout::nv12_two_memories:
      return {luma, {1, 0, format.memories.size() > 1 ? format.memories[1].stride_bytes : 0}};
    case PixelLayout::i420:
      return {luma, {0, luma_bytes, stride / 2}, {0, luma_bytes + chroma_bytes, stride / 2}};
    case PixelLayout::yv12:
      return {luma, {0, luma_bytes + chroma_bytes, stride / 2}, {0, luma_bytes, stride / 2}};
    case PixelLayout::uyvy:
    case PixelLayout::yuyv:
    case PixelLayout::grey:
      return {luma};
    case PixelLayout::mjpeg:
      return {};
  }
  return {};
}

std::vector<std::size_t> least_bytes(const PictureFormat& format) {
  std::vector<std::size_t> least;
  const std::vector<PlanePlace> places = places_of(format);
  for (std::size_t plane = 0; plane < places.size(); ++plane) {
    const PlanePlace& place = places[plane];
    const PlaneExtent extent = extent_of(format, plane);
    const bool overlaps = place.stride_bytes < extent.row_bytes;
    // A stride that is too short is a driver's error that no buffer is large enough for.
    const std::size_t end =
        overlaps
            ? SIZE_MAX
            : static_cast<std::size_t>(place.offset_bytes + place.stride_bytes * (extent.rows - 1) +
                                       extent.row_bytes);
    if (least.size() <= place.memory) least.resize(place.memory + 1);
    least[place.memory] = std::max(least[place.memory], end);
  }
  return least;
}

}  // namespace gimbal
