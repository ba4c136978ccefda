#include "pipeline/sync/offset_curve.hpp"

#include <algorithm>
#include <optional>

#include "pipeline/sync/gyro_integral.hpp"
#include "pipeline/sync/pair_residual.hpp"
#include "pipeline/sync/sighting.hpp"

namespace gimbal {
namespace {

constexpr std::size_t kPairs = 3000;
constexpr double kFarthest_px = 20;

std::optional<double> mean_square_px2(const std::vector<SightingPair>& pairs,
                                      const GyroIntegral& gyro, const JointParameters& at) {
  const JointStep none = JointStep::Zero();
  const double* const parameters[] = {none.data()};
  double sum = 0;
  std::size_t count = 0;
  for (const SightingPair& pair : pairs) {
    Eigen::Vector2d miss_px;
    if (!PairResidual(pair, gyro, at).Evaluate(parameters, miss_px.data(), nullptr)) continue;
    sum += std::min(miss_px.squaredNorm(), kFarthest_px * kFarthest_px);
    ++count;
  }
  if (count * 2 < pairs.size() || count == 0) return std::nullopt;
  return sum / static_cast<double>(count);
}

}  // namespace

Result<std::vector<OffsetCost>> offset_curve(const JointData& data, const JointParameters& fitted,
                                             const OffsetSearch& search) {
  const SensorTime zero = data.gyro.front().time;
  const auto maker = SightingMaker::create(data.camera, fitted.focal_scale, zero);
  if (!maker) return tl::unexpected(maker.error());
  const auto pairs = make_pairs(*maker, data.frames, data.tracks, {1, kPairs});
  const GyroIntegral gyro(data.gyro, zero, fitted.gyro_bias_rad_s);
  std::vector<OffsetCost> curve;
  JointParameters at = fitted;
  for (const double offset_s : offsets_of(search)) {
    at.offset_s = offset_s;
    const auto cost_px2 = mean_square_px2(pairs, gyro, at);
    if (cost_px2) curve.push_back({at.offset_s, *cost_px2});
  }
  return curve;
}

}  // namespace gimbal
