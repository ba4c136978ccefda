#include "pipeline/stabilizer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pipeline/path/view_fit.hpp"

namespace gimbal {
namespace {

/// Longer gaps between samples cannot be bridged by interpolation: a hand turns back and forth
/// several times a second.
constexpr SensorDuration kMaxGap = std::chrono::milliseconds(100);

/// As many as the widest window looks back at, at 60 fps.
constexpr std::size_t kRememberedPoses = 100;

/// In a sixteenth of a readout a hand's turn bends an edge by less than a tenth of a pixel.
constexpr int kOutlinePointsPerSide = 17;

/// For what only tells which frames to take.
constexpr int kRoughPointsPerSide = 5;

/// More than so many frames seldom show more.
constexpr std::size_t kMostNeighbours = 8;

/// A neighbour is drawn in part: its mesh is at least so fine, that little more is drawn.
constexpr MeshDensity kNeighbourMesh{16, 9};

/// Where borders are filled a view may turn away as far as it could at that zoom.
constexpr double kFilledRoomZoom = 1.25;

/// How fast a frame that gave way may be rectified again, of all a frame.
constexpr double kRectifiedStep = 0.1;
constexpr int kHalvings = 8;

bool is_orthonormal(const Eigen::Matrix3d& R) {
  constexpr double kTolerance = 1e-3;
  return (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < kTolerance &&
         R.determinant() > 0;
}

}  // namespace

Result<Stabilizer> Stabilizer::create(const CameraCalibration& camera, const ImuCalibration& imu,
                                      std::unique_ptr<AttitudeStream> attitudes,
                                      std::unique_ptr<CameraPath> path,
                                      const StabilizerOptions& options) {
  auto lens = Lens::create(camera.lens);
  if (!lens) return tl::unexpected(lens.error());
  if (!is_orthonormal(imu.R_camera_imu)) {
    return bad_input("R_camera_imu: not a rotation (rows must be orthonormal, determinant +1)");
  }
  return Stabilizer(camera, imu, std::move(*lens), std::move(attitudes), std::move(path), options);
}

Stabilizer::Stabilizer(const CameraCalibration& camera, const ImuCalibration& imu, Lens lens,
                       std::unique_ptr<AttitudeStream> attitudes, std::unique_ptr<CameraPath> path,
                       const StabilizerOptions& options)
    : camera_(camera),
      q_imu_camera_(Eigen::Quaterniond(imu.R_camera_imu).normalized().conjugate()),
      lens_(std::make_shared<const Lens>(std::move(lens))),
      timing_(camera),
      options_(options),
      reference_line_(options.reference_line.value_or((timing_.line_count() - 1) / 2.0)),
      attitudes_(std::move(attitudes)),
      history_(kMaxGap),
      path_(std::move(path)) {}

void Stabilizer::push(const ImuSample& sample) {
  attitudes_->push(sample);
  take_attitudes();
}

void Stabilizer::push(const FrameStamp& stamp) {
  waiting_.push_back(stamp);
  place_waiting_stamps();
}

void Stabilizer::take_attitudes() {
  while (const auto estimate = attitudes_->pop()) {
    if (is_coasting_) {
      if (estimate->attitude.time <= history_.newest().attitude.time) continue;
      join_.join(history_.newest().attitude.q_world_imu, estimate->attitude);
      is_coasting_ = false;
    }
    history_.append(join_.turned(*estimate));
  }
  place_waiting_stamps();
}

void Stabilizer::coast_to(SensorTime time) {
  is_coasting_ = true;
  AttitudeEstimate held{{time, Eigen::Quaterniond::Identity()},
                        kUnknownAngle_rad2 * Eigen::Matrix3d::Identity(),
                        AttitudeOrigin::predicted};
  if (!history_.empty()) held.attitude.q_world_imu = history_.newest().attitude.q_world_imu;
  history_.append(held);
  place_waiting_stamps();
}

void Stabilizer::begin_path(std::unique_ptr<CameraPath> path) {
  release_waiting();
  path_ = std::move(path);
  left_path_.clear();
  shown_.reset();
  fade_ = {};
  last_rectified_ = 1;
}

void Stabilizer::replace_path(std::unique_ptr<CameraPath> path, const StabilizerOptions& options) {
  path_ = std::move(path);
  options_ = options;
  last_rectified_ = 1;
  for (const PathFrame& frame : left_path_) path_->push(frame);
  for (PathFrame& frame : on_path_) {
    frame = path_frame(frame.real);  // another border leaves other room
    path_->push(frame);
  }
  follow_path();
}

void Stabilizer::finish() {
  attitudes_->finish();
  take_attitudes();
  release_waiting();
}

void Stabilizer::release_waiting() {
  if (history_.empty()) return;
  while (!waiting_.empty()) place_next();
  path_->finish();
  follow_path();
}

void Stabilizer::place_waiting_stamps() {
  while (!waiting_.empty() && !history_.empty() &&
         history_.newest().attitude.time >= readout_end(waiting_.front())) {
    place_next();
  }
}

void Stabilizer::place_next() {
  on_path_.push_back(path_frame(real_pose(waiting_.front())));
  waiting_.pop_front();
  path_->push(on_path_.back());
  follow_path();
}

void Stabilizer::follow_path() {
  while (const auto view = path_->pop()) {
    if (shown_ && view->steady.stamp.time <= shown_->steady.stamp.time) {
      // That frame has come from the path that this one replaced.
      if (view->steady.stamp.time == shown_->steady.stamp.time) fade_.begin(*shown_, *view);
      continue;
    }
    PathFrame& frame = on_path_.front();
    shown_ = fade_.faded(*view, frame);
    const bool fits =
        needed_zoom(frame.required_zoom, shown_->steady.q_world_camera) <= shown_->zoom;
    views_.push_back({*shown_, fits ? Fit::whole : Fit::in_part});
    left_path_.push_back(std::move(frame));
    if (left_path_.size() > kRememberedPoses) left_path_.pop_front();
    on_path_.pop_front();
  }
}

std::optional<VirtualCamera> Stabilizer::next_camera() {
  if (views_.empty()) return std::nullopt;
  const auto [view, fit] = views_.front();
  views_.pop_front();
  VirtualCamera camera = camera_of(view);
  const bool crops = options_.border == Border::crop;
  if (crops && (fit == Fit::in_part || last_rectified_ < 1)) give_way(camera);
  return camera;
}

VirtualCamera Stabilizer::camera_of(const SteadyView& view) const {
  VirtualCamera camera;
  camera.stamp = view.steady.stamp;
  camera.q_world_camera = view.steady.q_world_camera;
  camera.intrinsics = zoomed(unzoomed(), camera_.size, view.zoom);
  camera.lens = options_.output_lens;
  return camera;
}

bool Stabilizer::shows_border(const VirtualCamera& camera) const {
  const double zoom = camera.intrinsics.fx / unzoomed().fx;
  return required_zoom(outline_of(camera.stamp, camera.rectified, kOutlinePointsPerSide),
                       camera.q_world_camera, unzoomed_projection(), camera_.size) *
             kZoomMargin >
         zoom;
}

/// The last resort against a border: a frame that is sheared too much for any view is shown more
/// as it was taken, down to the frame itself. Where not even that fits, as where the picture is
/// wider than the frame, it would be given up for nothing.
void Stabilizer::give_way(VirtualCamera& camera) {
  const Eigen::Quaterniond real = real_pose(camera.stamp).q_world_camera;
  const auto with_share = [&](double share) {
    VirtualCamera less = camera;
    less.q_world_camera = real.slerp(share, camera.q_world_camera);
    less.rectified = share;
    return less;
  };
  double fits = std::min(1.0, last_rectified_ + kRectifiedStep);
  if (shows_border(with_share(fits))) {
    if (shows_border(with_share(0))) return;
    double does_not = fits;
    fits = 0;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = (fits + does_not) / 2;
      (shows_border(with_share(middle)) ? does_not : fits) = middle;
    }
  }
  last_rectified_ = fits;
  camera = with_share(fits);
}

WarpMesh Stabilizer::mesh_for(const VirtualCamera& camera) const {
  return mesh_for(camera, {1, 1});
}

WarpMesh Stabilizer::mesh_for(const VirtualCamera& camera, MeshDensity least) const {
  const LineOrientation orientation = orientation_of(camera.stamp, camera.rectified);
  ChosenDensity chosen = options_.mesh
                             ? ChosenDensity{*options_.mesh, std::nullopt}
                             : choose_mesh_density(*lens_, camera_.size, camera_.readout_direction,
                                                   orientation, camera);
  chosen.density.columns = std::max(chosen.density.columns, least.columns);
  chosen.density.rows = std::max(chosen.density.rows, least.rows);
  WarpMesh mesh = with_shared_error(build_warp_mesh(*lens_, camera_.size, camera_.readout_direction,
                                                    orientation, camera, camera_.size,
                                                    options_.border, chosen.density));
  mesh.error_px = chosen.error_px;
  return mesh;
}

std::optional<PicturePolygon> Stabilizer::shown_outline(const FrameStamp& stamp,
                                                        const VirtualCamera& camera) const {
  const OutputProjection projection(camera.lens, *lens_, camera.intrinsics);
  return pixels_of(outline_of(stamp, 1, kRoughPointsPerSide), camera.q_world_camera, projection);
}

std::vector<Neighbour> Stabilizer::neighbours_of(const VirtualCamera& camera,
                                                 std::span<const VideoFrame> others) const {
  const auto own = shown_outline(camera.stamp, camera);
  if (!own) return {};
  std::vector<NeighbourCandidate> candidates;
  for (const VideoFrame& other : others) {
    NeighbourCandidate candidate;
    if (knows_readout_of(other.stamp)) {
      candidate.outline_px = shown_outline(other.stamp, camera).value_or(PicturePolygon{});
    }
    candidate.apart_s = std::abs(to_seconds(other.stamp.time - camera.stamp.time));
    candidates.push_back(std::move(candidate));
  }
  std::vector<Neighbour> neighbours;
  for (const std::size_t i : choose_neighbours(camera_.size, *own, candidates, kMostNeighbours)) {
    VirtualCamera same_view = camera;
    same_view.stamp = others[i].stamp;
    neighbours.push_back({others[i], mesh_for(same_view, kNeighbourMesh)});
  }
  return neighbours;
}

void Stabilizer::forget(const FrameStamp& stamp) {
  history_.forget_before(readout_begin(stamp));
}

FramePose Stabilizer::real_pose(const FrameStamp& stamp) const {
  return {stamp, q_world_camera(time_of_pose(stamp))};
}

SensorTime Stabilizer::time_of_pose(const FrameStamp& stamp) const {
  return timing_.time_of_line(stamp, reference_line_);
}

AttitudeOrigin Stabilizer::origin_of(const FrameStamp& stamp) const {
  const auto origin_at = [&](double line) {
    return history_.at(timing_.time_of_line(stamp, line)).origin;
  };
  return std::max(origin_at(0), origin_at(timing_.line_count()));
}

Eigen::Matrix3d Stabilizer::covariance_of(const FrameStamp& stamp) const {
  return history_.at(timing_.time_of_line(stamp, reference_line_)).covariance_rad2;
}

Eigen::Quaterniond Stabilizer::q_world_camera(SensorTime time) const {
  return history_.at(time).q_world_imu * q_imu_camera_;
}

LineOrientation Stabilizer::orientation_of(const FrameStamp& stamp, double rectified) const {
  const auto as_exposed = [this, stamp](double line) {
    return q_world_camera(timing_.time_of_line(stamp, line));
  };
  if (rectified == 1) return as_exposed;
  return [as_exposed, rectified, q = real_pose(stamp).q_world_camera](double line) {
    return q.slerp(rectified, as_exposed(line));
  };
}

SensorTime Stabilizer::readout_begin(const FrameStamp& stamp) const {
  return std::min(timing_.time_of_line(stamp, 0),
                  timing_.time_of_line(stamp, timing_.line_count()));
}

bool Stabilizer::knows_readout_of(const FrameStamp& stamp) const {
  return !history_.empty() && history_.oldest().attitude.time <= readout_begin(stamp) &&
         history_.newest().attitude.time >= readout_end(stamp);
}

SensorTime Stabilizer::readout_end(const FrameStamp& stamp) const {
  return std::max(timing_.time_of_line(stamp, 0),
                  timing_.time_of_line(stamp, timing_.line_count()));
}

PinholeIntrinsics Stabilizer::unzoomed() const {
  return output_intrinsics(camera_.lens, camera_.size, options_.output_fov_deg);
}

OutputProjection Stabilizer::unzoomed_projection() const {
  return {options_.output_lens, *lens_, unzoomed()};
}

FrameOutline Stabilizer::outline_of(const FrameStamp& stamp, double rectified,
                                    int points_per_side) const {
  return trace_outline(*lens_, camera_.size, camera_.readout_direction,
                       orientation_of(stamp, rectified), points_per_side);
}

PathFrame Stabilizer::path_frame(const FramePose& real) const {
  auto outline =
      std::make_shared<const FrameOutline>(outline_of(real.stamp, 1, kOutlinePointsPerSide));
  PathFrame frame{
      real, view_room(*outline, real.q_world_camera, unzoomed_projection(), camera_.size), nullptr};
  if (options_.border != Border::crop) {
    // Filled borders let any view do, but a picture that is all border is none.
    frame.room.corner /= kFilledRoomZoom;
    frame.required_zoom = [](const Eigen::Quaterniond&) { return 0.0; };
    return frame;
  }
  frame.required_zoom = [outline = std::move(outline), lens = lens_, output = options_.output_lens,
                         intrinsics = unzoomed(),
                         size = camera_.size](const Eigen::Quaterniond& q_world_camera) {
    return required_zoom(*outline, q_world_camera, {output, *lens, intrinsics}, size);
  };
  return frame;
}

}  // namespace gimbal
