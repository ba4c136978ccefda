#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "pipeline/sample/result.hpp"
#include "pipeline/sample/video_frame.hpp"
#include "pipeline/warp/plane_converter.hpp"
#include "pipeline/warp/plane_upload.hpp"

namespace gimbal {

/// Copies native pictures of one format and size to the GPU as they lie, and brings them to the
/// planes of NV12 there.
class NativeInput {
 public:
  /// Fails where the driver cannot draw into such textures.
  [[nodiscard]] static Result<NativeInput> create(NativeFormat format, ImageSize picture,
                                                  int gles_version);

  /// Textures of luma and chroma, values in texture_channels.
  [[nodiscard]] std::array<GLuint, 2> bring(const std::array<ConstPlane, 3>& planes);

  [[nodiscard]] NativeFormat format() const { return format_; }
  [[nodiscard]] std::int64_t bytes_per_picture() const;

 private:
  explicit NativeInput(NativeFormat format) : format_(format) {}

  NativeFormat format_;
  std::vector<PlaneUpload> uploads_;
  std::array<std::optional<PlaneConverter>, 2> converters_;
};

}  // namespace gimbal
