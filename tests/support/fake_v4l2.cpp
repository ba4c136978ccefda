#include "tests/support/fake_v4l2.hpp"

#include <fcntl.h>
#include <linux/v4l2-subdev.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <utility>

namespace gimbal::test {
namespace {

constexpr std::uint32_t kOffsetUnit = 1 << 20;  // buffer index and memory, in an mmap offset

template <std::size_t kSize>
void write_text(__u8 (&field)[kSize], const std::string& text) {
  std::memcpy(field, text.data(), std::min(text.size(), kSize - 1));
}

std::uint32_t round_up(std::uint32_t value, std::uint32_t step) {
  return (value + step - 1) / step * step;
}

}  // namespace

class FakeCamera::Device final : public V4l2Device {
 public:
  explicit Device(std::shared_ptr<FakeCamera> camera) : camera_(std::move(camera)) {}
  ~Device() override {
    const std::lock_guard lock(camera_->mutex_);
    if (camera_->owner_ == this) camera_->free_buffers();
  }

  int request(unsigned long code, void* argument) override {
    return camera_->handle(this, code, argument);
  }
  std::uint8_t* map(std::size_t bytes, std::int64_t offset) override {
    return camera_->map(bytes, offset);
  }
  void unmap(std::uint8_t* memory, std::size_t bytes) override { ::munmap(memory, bytes); }
  Wakeup wait(SensorDuration limit) override { return camera_->wait(this, limit); }
  void cancel() override {
    const std::lock_guard lock(camera_->mutex_);
    is_cancelled = true;
    camera_->changed_.notify_all();
  }
  [[nodiscard]] std::optional<SensorDuration> read_clock(KernelClock clock) const override {
    const auto found = camera_->clocks.find(clock);
    if (found == camera_->clocks.end()) return std::nullopt;
    return camera_->now() + found->second;
  }

  bool is_cancelled = false;

 private:
  std::shared_ptr<FakeCamera> camera_;
};

std::unique_ptr<V4l2Device> FakeCamera::open() {
  const std::lock_guard lock(mutex_);
  if (fourcc_ == 0 && !formats.empty()) {
    fourcc_ = formats[0].fourcc;
    size_ = formats[0].sizes[0];
    rate_hz_ = formats[0].rates_hz.empty() ? 0 : formats[0].rates_hz[0];
  }
  return std::make_unique<Device>(shared_from_this());
}

void FakeCamera::unplug() {
  const std::lock_guard lock(mutex_);
  is_unplugged_ = true;
  changed_.notify_all();
}

void FakeCamera::plug_in() {
  const std::lock_guard lock(mutex_);
  free_buffers();
  is_unplugged_ = false;
}

std::size_t FakeCamera::queued() const {
  const std::lock_guard lock(mutex_);
  return queue_.size();
}

bool FakeCamera::is_streaming() const {
  const std::lock_guard lock(mutex_);
  return is_streaming_;
}

std::int64_t FakeCamera::value_of(const std::string& control) const {
  const std::lock_guard lock(mutex_);
  return std::ranges::find(controls, control, &FakeControl::name)->value;
}

bool FakeCamera::has_planes() const {
  return (capabilities & V4L2_CAP_VIDEO_CAPTURE_MPLANE) != 0;
}

SensorDuration FakeCamera::now() const {
  if (pace == FakePace::simulated) return simulated_now_;
  return std::chrono::steady_clock::now().time_since_epoch();
}

SensorDuration FakeCamera::period() const {
  return std::chrono::nanoseconds(std::chrono::seconds(1)) / (rate_hz_ == 0 ? 30 : rate_hz_);
}

int FakeCamera::handle(const Device* who, unsigned long code, void* argument) {
  const std::lock_guard lock(mutex_);
  if (is_unplugged_) return ENODEV;
  const bool is_locked = owner_ != nullptr && owner_ != who;
  switch (code) {
    case VIDIOC_QUERYCAP:
      return query_capability(*static_cast<v4l2_capability*>(argument));
    case VIDIOC_ENUM_FMT:
      return list_format(*static_cast<v4l2_fmtdesc*>(argument));
    case VIDIOC_ENUM_FRAMESIZES:
      return list_size(*static_cast<v4l2_frmsizeenum*>(argument));
    case VIDIOC_ENUM_FRAMEINTERVALS:
      return list_interval(*static_cast<v4l2_frmivalenum*>(argument));
    case VIDIOC_G_FMT:
      return get_format(*static_cast<v4l2_format*>(argument));
    case VIDIOC_S_FMT:
      return is_locked ? EBUSY : set_format(*static_cast<v4l2_format*>(argument));
    case VIDIOC_G_PARM:
      return parameters(*static_cast<v4l2_streamparm*>(argument), false);
    case VIDIOC_S_PARM:
      return parameters(*static_cast<v4l2_streamparm*>(argument), true);
    case VIDIOC_QUERY_EXT_CTRL:
      return query_control(*static_cast<v4l2_query_ext_ctrl*>(argument));
    case VIDIOC_QUERYMENU:
      return query_menu(*static_cast<v4l2_querymenu*>(argument));
    case VIDIOC_G_EXT_CTRLS:
      return get_control(*static_cast<v4l2_ext_controls*>(argument));
    case VIDIOC_S_EXT_CTRLS:
      return set_control(*static_cast<v4l2_ext_controls*>(argument));
    case VIDIOC_REQBUFS:
      return is_locked ? EBUSY : request_buffers(who, *static_cast<v4l2_requestbuffers*>(argument));
    case VIDIOC_QUERYBUF:
      return query_buffer(*static_cast<v4l2_buffer*>(argument));
    case VIDIOC_EXPBUF:
      return export_buffer(*static_cast<v4l2_exportbuffer*>(argument));
    case VIDIOC_QBUF:
      return is_locked ? EBUSY : queue_buffer(*static_cast<v4l2_buffer*>(argument));
    case VIDIOC_DQBUF:
      return is_locked ? EBUSY : dequeue_buffer(*static_cast<v4l2_buffer*>(argument));
    case VIDIOC_STREAMON:
      return is_locked ? EBUSY : stream(who, true);
    case VIDIOC_STREAMOFF:
      return is_locked ? EBUSY : stream(who, false);
    case VIDIOC_SUBDEV_G_FMT: {
      auto& format = static_cast<v4l2_subdev_format*>(argument)->format;
      format.width = static_cast<std::uint32_t>(size_.width);
      format.height = static_cast<std::uint32_t>(size_.height);
      return 0;
    }
    default:
      return ENOTTY;
  }
}

int FakeCamera::query_capability(v4l2_capability& capability) const {
  capability = {};
  write_text(capability.card, name);
  write_text(capability.bus_info, bus);
  capability.capabilities = capabilities | V4L2_CAP_DEVICE_CAPS;
  capability.device_caps = capabilities;
  return 0;
}

int FakeCamera::list_format(v4l2_fmtdesc& listed) const {
  if (listed.index >= formats.size()) return EINVAL;
  listed.pixelformat = formats[listed.index].fourcc;
  return 0;
}

const FakeFormat* FakeCamera::find_format(std::uint32_t fourcc) const {
  const auto found = std::ranges::find(formats, fourcc, &FakeFormat::fourcc);
  return found == formats.end() ? nullptr : &*found;
}

int FakeCamera::list_size(v4l2_frmsizeenum& listed) const {
  const FakeFormat* format = find_format(listed.pixel_format);
  if (format == nullptr || listed.index >= format->sizes.size()) return EINVAL;
  const ImageSize size = format->sizes[listed.index];
  listed.type = V4L2_FRMSIZE_TYPE_DISCRETE;
  listed.discrete = {static_cast<std::uint32_t>(size.width),
                     static_cast<std::uint32_t>(size.height)};
  return 0;
}

int FakeCamera::list_interval(v4l2_frmivalenum& listed) const {
  const FakeFormat* format = find_format(listed.pixel_format);
  if (format == nullptr || listed.index >= format->rates_hz.size()) return EINVAL;
  listed.type = V4L2_FRMIVAL_TYPE_DISCRETE;
  listed.discrete = {1, format->rates_hz[listed.index]};
  return 0;
}

std::vector<std::uint32_t> FakeCamera::strides() const {
  const auto width = static_cast<std::uint32_t>(size_.width);
  const std::uint32_t even = round_up(width, 2);
  switch (fourcc_) {
    case V4L2_PIX_FMT_YUYV:
    case V4L2_PIX_FMT_UYVY:
      return {round_up(2 * even, stride_alignment)};
    case V4L2_PIX_FMT_NV12M:
      return {round_up(even, stride_alignment), round_up(even, stride_alignment)};
    case V4L2_PIX_FMT_MJPEG:
      return {0};
    case V4L2_PIX_FMT_GREY:
      return {round_up(width, stride_alignment)};
    default:
      return {round_up(even, stride_alignment)};
  }
}

std::vector<std::uint32_t> FakeCamera::sizes() const {
  const auto height = static_cast<std::uint32_t>(size_.height);
  const std::uint32_t chroma_rows = (height + 1) / 2;
  const std::uint32_t stride = strides()[0];
  switch (fourcc_) {
    case V4L2_PIX_FMT_YUYV:
    case V4L2_PIX_FMT_UYVY:
    case V4L2_PIX_FMT_GREY:
      return {stride * height};
    case V4L2_PIX_FMT_NV12M:
      return {stride * height, stride * chroma_rows};
    case V4L2_PIX_FMT_MJPEG:
      return {static_cast<std::uint32_t>(size_.width) * height * 2 + 4096};
    default:
      return {stride * (height + chroma_rows)};
  }
}

int FakeCamera::get_format(v4l2_format& format) const {
  if (formats.empty()) return EINVAL;
  const auto bytes = sizes();
  const auto rows = strides();
  if (has_planes()) {
    v4l2_pix_format_mplane& pix = format.fmt.pix_mp;
    pix = {};
    pix.width = static_cast<std::uint32_t>(size_.width);
    pix.height = static_cast<std::uint32_t>(size_.height);
    pix.pixelformat = fourcc_;
    pix.field = field;
    pix.colorspace = colorspace;
    pix.num_planes = static_cast<std::uint8_t>(bytes.size());
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      pix.plane_fmt[i].sizeimage = bytes[i];
      pix.plane_fmt[i].bytesperline = rows[i];
    }
    return 0;
  }
  v4l2_pix_format& pix = format.fmt.pix;
  pix = {};
  pix.width = static_cast<std::uint32_t>(size_.width);
  pix.height = static_cast<std::uint32_t>(size_.height);
  pix.pixelformat = fourcc_;
  pix.field = field;
  pix.colorspace = colorspace;
  pix.sizeimage = bytes[0];
  pix.bytesperline = rows[0];
  return 0;
}

/// Takes the nearest that there is, as drivers do.
int FakeCamera::set_format(v4l2_format& format) {
  if (!buffers_.empty()) return EBUSY;
  const bool planes = has_planes();
  const std::uint32_t fourcc = planes ? format.fmt.pix_mp.pixelformat : format.fmt.pix.pixelformat;
  const auto width = static_cast<int>(planes ? format.fmt.pix_mp.width : format.fmt.pix.width);
  const auto height = static_cast<int>(planes ? format.fmt.pix_mp.height : format.fmt.pix.height);
  const FakeFormat* chosen = find_format(fourcc);
  if (chosen == nullptr) chosen = formats.data();
  fourcc_ = chosen->fourcc;
  const auto found = std::ranges::find(chosen->sizes, ImageSize{width, height});
  size_ = found == chosen->sizes.end() ? chosen->sizes[0] : *found;
  rate_hz_ = chosen->rates_hz.empty() ? 0 : chosen->rates_hz[0];
  return get_format(format);
}

int FakeCamera::parameters(v4l2_streamparm& parameters, bool is_set) {
  if (rate_hz_ == 0) return ENOTTY;
  v4l2_captureparm& capture = parameters.parm.capture;
  if (is_set && capture.timeperframe.numerator > 0) {
    const double wanted =
        static_cast<double>(capture.timeperframe.denominator) / capture.timeperframe.numerator;
    const auto& rates = find_format(fourcc_)->rates_hz;
    rate_hz_ = *std::ranges::min_element(
        rates, {}, [&](std::uint32_t rate) { return std::abs(rate - wanted); });
  }
  capture = {};
  capture.capability = V4L2_CAP_TIMEPERFRAME;
  capture.timeperframe = {1, rate_hz_};
  return 0;
}

FakeControl* FakeCamera::find_control(std::uint32_t id) {
  const auto found = std::ranges::find(controls, id, &FakeControl::id);
  return found == controls.end() ? nullptr : &*found;
}

std::uint32_t FakeCamera::flags_of(const FakeControl& control) {
  if (!control.inactive_while) return control.flags;
  const FakeControl* other = find_control(control.inactive_while->first);
  const bool is_inactive = other != nullptr && other->value == control.inactive_while->second;
  return control.flags | (is_inactive ? V4L2_CTRL_FLAG_INACTIVE : 0U);
}

int FakeCamera::query_control(v4l2_query_ext_ctrl& listed) {
  const bool wants_next = (listed.id & V4L2_CTRL_FLAG_NEXT_CTRL) != 0;
  const std::uint32_t id = listed.id & ~std::uint32_t{V4L2_CTRL_FLAG_NEXT_CTRL};
  const FakeControl* found = nullptr;
  for (const FakeControl& control : controls) {
    const bool matches = wants_next ? control.id > id : control.id == id;
    if (matches && (found == nullptr || control.id < found->id)) found = &control;
  }
  if (found == nullptr) return EINVAL;
  listed = {};
  listed.id = found->id;
  listed.type = found->type;
  std::memcpy(&listed.name, found->name.data(), std::min<std::size_t>(found->name.size(), 31));
  listed.minimum = found->minimum;
  listed.maximum = found->maximum;
  listed.step = 1;
  listed.flags = flags_of(*found);
  return 0;
}

int FakeCamera::query_menu(v4l2_querymenu& entry) {
  const FakeControl* control = find_control(entry.id);
  if (control == nullptr || !control->menu.contains(entry.index)) return EINVAL;
  const std::string& text = control->menu.at(entry.index);
  std::memset(&entry.name, 0, sizeof entry.name);
  std::memcpy(&entry.name, text.data(), std::min(text.size(), sizeof entry.name - 1));
  return 0;
}

int FakeCamera::get_control(v4l2_ext_controls& all) {
  const FakeControl* control = find_control(all.controls[0].id);
  if (control == nullptr) return EINVAL;
  if (control->type == V4L2_CTRL_TYPE_INTEGER64) {
    all.controls[0].value64 = control->value;
  } else {
    all.controls[0].value = static_cast<std::int32_t>(control->value);
  }
  return 0;
}

int FakeCamera::set_control(v4l2_ext_controls& all) {
  FakeControl* control = find_control(all.controls[0].id);
  if (control == nullptr) return EINVAL;
  if ((flags_of(*control) & V4L2_CTRL_FLAG_INACTIVE) != 0) return EACCES;
  const bool is_wide = control->type == V4L2_CTRL_TYPE_INTEGER64;
  const std::int64_t value = is_wide ? all.controls[0].value64 : all.controls[0].value;
  if (value < control->minimum || value > control->maximum) return ERANGE;
  control->value = value;
  return 0;
}

void FakeCamera::free_buffers() {
  for (const Buffer& buffer : buffers_) {
    for (const int memory : buffer.memories) ::close(memory);
  }
  buffers_.clear();
  queue_.clear();
  is_streaming_ = false;
  owner_ = nullptr;
  ready_.reset();
}

int FakeCamera::request_buffers(const Device* who, v4l2_requestbuffers& wanted) {
  free_buffers();
  if (wanted.count == 0) return 0;
  owner_ = who;
  buffers_.resize(wanted.count);
  for (Buffer& buffer : buffers_) {
    for (const std::uint32_t bytes : sizes()) {
      const int memory = ::memfd_create("fake_v4l2", MFD_CLOEXEC);
      if (memory < 0 || ::ftruncate(memory, bytes) != 0) return ENOMEM;
      buffer.memories.push_back(memory);
    }
  }
  return 0;
}

int FakeCamera::query_buffer(v4l2_buffer& buffer) const {
  if (buffer.index >= buffers_.size()) return EINVAL;
  FakePicture picture;
  if (script) script(0, picture);
  buffer.flags = picture.flags & (V4L2_BUF_FLAG_TIMESTAMP_MASK | V4L2_BUF_FLAG_TSTAMP_SRC_MASK);
  const auto bytes = sizes();
  const std::uint32_t offset = buffer.index * VIDEO_MAX_PLANES * kOffsetUnit;
  if (!has_planes()) {
    buffer.length = bytes[0];
    buffer.m.offset = offset;
    return 0;
  }
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    buffer.m.planes[i].length = bytes[i];
    buffer.m.planes[i].m.mem_offset = offset + static_cast<std::uint32_t>(i) * kOffsetUnit;
  }
  return 0;
}

std::uint8_t* FakeCamera::map(std::size_t bytes, std::int64_t offset) {
  const std::lock_guard lock(mutex_);
  const auto place = static_cast<std::size_t>(offset / kOffsetUnit);
  const int memory = buffers_[place / VIDEO_MAX_PLANES].memories[place % VIDEO_MAX_PLANES];
  void* mapped = ::mmap(nullptr, bytes, PROT_READ, MAP_SHARED, memory, 0);
  return mapped == MAP_FAILED ? nullptr : static_cast<std::uint8_t*>(mapped);
}

int FakeCamera::export_buffer(v4l2_exportbuffer& exported) const {
  if (!exports_dma_buf) return ENOTTY;
  exported.fd = ::fcntl(buffers_[exported.index].memories[exported.plane], F_DUPFD_CLOEXEC, 0);
  return exported.fd < 0 ? errno : 0;
}

int FakeCamera::queue_buffer(v4l2_buffer& buffer) {
  if (buffer.index >= buffers_.size() || buffers_[buffer.index].is_queued) return EINVAL;
  buffers_[buffer.index].is_queued = true;
  queue_.push_back(buffer.index);
  return 0;
}

int FakeCamera::stream(const Device* who, bool is_on) {
  if (owner_ != who) return EINVAL;
  is_streaming_ = is_on;
  taken_ = 0;
  ready_.reset();
  next_due_ = now() + period();
  for (Buffer& buffer : buffers_) buffer.is_queued = buffer.is_queued && is_on;
  if (!is_on) queue_.clear();
  changed_.notify_all();
  return 0;
}

void FakeCamera::take_picture() {
  FakePicture picture;
  picture.sequence = taken_;
  picture.stamp = next_due_;
  if (script) script(taken_, picture);
  ++taken_;
  next_due_ += period();
  if (!picture.never_comes) ready_ = picture;
}

V4l2Device::Wakeup FakeCamera::wait(const Device* who, SensorDuration limit) {
  using Wakeup = V4l2Device::Wakeup;
  std::unique_lock lock(mutex_);
  const SensorDuration deadline = now() + limit;
  for (;;) {
    if (who->is_cancelled) return Wakeup::cancelled;
    if (is_unplugged_ || !is_streaming_ || owner_ != who) return Wakeup::error;
    if (ready_) return Wakeup::picture;
    const SensorDuration until = std::min(deadline, queue_.empty() ? deadline : next_due_);
    if (pace == FakePace::simulated) {
      simulated_now_ = std::max(simulated_now_, until);
    } else {
      changed_.wait_until(lock, std::chrono::steady_clock::time_point(until));
    }
    if (now() < until) continue;
    if (until == deadline) return Wakeup::timeout;
    take_picture();
  }
}

void FakeCamera::fill(std::uint32_t index) {
  const auto bytes = sizes();
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::vector<std::uint8_t> picture;
    if (content) {
      picture = content(taken_ - 1, i);
    } else {
      for (std::size_t at = 0; at < bytes[i]; ++at) {
        picture.push_back(default_byte(taken_ - 1, i, at));
      }
    }
    const std::size_t count = std::min<std::size_t>(picture.size(), bytes[i]);
    [[maybe_unused]] const auto written =
        ::pwrite(buffers_[index].memories[i], picture.data(), count, 0);
  }
}

int FakeCamera::dequeue_buffer(v4l2_buffer& buffer) {
  if (!is_streaming_) return EINVAL;
  if (!ready_ || queue_.empty()) return EAGAIN;
  const FakePicture picture = *std::exchange(ready_, {});
  if (picture.dequeue_error != 0) return picture.dequeue_error;
  buffer.index = queue_.front();
  queue_.pop_front();
  buffers_[buffer.index].is_queued = false;
  fill(buffer.index);
  buffer.flags = picture.flags;
  buffer.sequence = picture.sequence;
  const auto seconds = std::chrono::floor<std::chrono::seconds>(picture.stamp);
  buffer.timestamp.tv_sec = seconds.count();
  buffer.timestamp.tv_usec =
      std::chrono::duration_cast<std::chrono::microseconds>(picture.stamp - seconds).count();
  const auto bytes = sizes();
  if (!has_planes()) buffer.bytesused = picture.bytes_used.value_or(bytes[0]);
  for (std::size_t i = 0; has_planes() && i < bytes.size(); ++i) {
    buffer.m.planes[i].bytesused = picture.bytes_used.value_or(bytes[i]);
    buffer.m.planes[i].length = bytes[i];
  }
  return 0;
}

std::vector<std::string> FakeV4l2System::nodes() const {
  std::vector<std::string> paths;
  for (const auto& [path, camera] : cameras) paths.push_back(path);
  for (const auto& [path, why] : refused) paths.push_back(path);
  std::ranges::sort(paths);
  return paths;
}

Result<std::unique_ptr<V4l2Device>> FakeV4l2System::open(const std::string& path) const {
  if (const auto why = refused.find(path); why != refused.end()) {
    return bad_input(path + ": " + why->second);
  }
  const auto found = cameras.find(path);
  if (found == cameras.end()) return bad_input(path + ": no such device");
  return found->second->open();
}

std::unique_ptr<V4l2Device> FakeV4l2System::open_sensor(const std::string&) const {
  return sensor ? sensor->open() : nullptr;
}

}  // namespace gimbal::test
