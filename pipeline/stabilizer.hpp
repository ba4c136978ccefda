#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "pipeline/fill/border_fill.hpp"
#include "pipeline/fill/neighbour_choice.hpp"
#include "pipeline/lens/lens.hpp"
#include "pipeline/path/camera_path.hpp"
#include "pipeline/path/view_fade.hpp"
#include "pipeline/sample/calibration.hpp"
#include "pipeline/sample/result.hpp"
#include "pipeline/sample/virtual_camera.hpp"
#include "pipeline/smoother/attitude_history.hpp"
#include "pipeline/smoother/attitude_join.hpp"
#include "pipeline/smoother/attitude_stream.hpp"
#include "pipeline/timing/row_timing.hpp"
#include "pipeline/warp/frame_outline.hpp"
#include "pipeline/warp/warp_mesh.hpp"

namespace gimbal {

struct StabilizerOptions {
  Border border = Border::crop;
  /// The line, in pixels along the readout, that a rectified frame is drawn at; the middle if none.
  std::optional<double> reference_line;
  std::optional<MeshDensity> mesh;  ///< none: as coarse as each frame allows
  OutputLens output_lens = OutputLens::rectilinear;
  /// Of a rectilinear picture at zoom 1; none: the real camera's focal lengths and centre.
  std::optional<double> output_fov_deg;
};

/// From samples and frame stamps to the mesh of each frame:
///
///   samples -> attitudes -> history -> pose of the reference line -> path -> mesh
///
/// Owns no thread and reads no clock. Samples and stamps go in, each in order of time; a stamp's
/// camera comes out once the path has seen what it waits for.
class Stabilizer {
 public:
  [[nodiscard]] static Result<Stabilizer> create(const CameraCalibration& camera,
                                                 const ImuCalibration& imu,
                                                 std::unique_ptr<AttitudeStream> attitudes,
                                                 std::unique_ptr<CameraPath> path,
                                                 const StabilizerOptions& options);

  /// Stamps rise strictly; the orientations that they give go into the history.
  void push(const ImuSample& sample);

  /// Waits inside until the history reaches the end of the frame's readout.
  void push(const FrameStamp& stamp);

  /// The IMU is silent: until `time`, or until it speaks again, the camera is taken to stand still.
  /// The path glides there, so the picture ends as it was taken; when samples come again, the
  /// orientation goes on from there.
  void coast_to(SensorTime time);

  /// The camera is gone: frames that wait come out as at the end. Those still to come are the first
  /// ones of `path`.
  void begin_path(std::unique_ptr<CameraPath> path);

  /// Other choices from the next camera on. `path` is given the frames before, so that it does not
  /// begin anew, and what its views differ by from those shown so far fades away. Precondition: all
  /// cameras that were ready have been taken.
  void replace_path(std::unique_ptr<CameraPath> path, const StabilizerOptions& options);

  /// No more samples and stamps come.
  void finish();

  /// The virtual camera of the next frame, in order.
  [[nodiscard]] std::optional<VirtualCamera> next_camera();

  /// What a virtual camera has at zoom 1.
  [[nodiscard]] PinholeIntrinsics unzoomed() const;

  /// The way from a frame to the picture that `camera` shows of it.
  [[nodiscard]] WarpMesh mesh_for(const VirtualCamera& camera) const;

  /// Of other frames, those that show the most of what the frame of `camera` leaves uncovered in
  /// its picture, each with the way there, the nearest in time first. None where nothing is
  /// uncovered; frames whose orientations are not known, or not any more, are not looked at.
  [[nodiscard]] std::vector<Neighbour> neighbours_of(const VirtualCamera& camera,
                                                     std::span<const VideoFrame> others) const;

  /// For a camera that runs on: no mesh of this frame or an earlier one is wanted any more.
  void forget(const FrameStamp& stamp);

  /// The same for all frames that are read out before `time`.
  void forget_before(SensorTime time) { history_.forget_before(time); }

  /// The real camera at the reference line of the frame, and when that was, on the IMU's clock.
  [[nodiscard]] FramePose real_pose(const FrameStamp& stamp) const;
  [[nodiscard]] SensorTime time_of_pose(const FrameStamp& stamp) const;

  /// How the orientations inside the frame's readout were obtained: the worst of its first and
  /// last.
  [[nodiscard]] AttitudeOrigin origin_of(const FrameStamp& stamp) const;

  /// rad², of the real pose's error as a rotation vector in world axes.
  [[nodiscard]] Eigen::Matrix3d covariance_of(const FrameStamp& stamp) const;

  /// See AttitudeStream.
  [[nodiscard]] std::string_view suspicion() const { return attitudes_->suspicion(); }
  [[nodiscard]] std::optional<GyroBias> gyro_bias() const { return attitudes_->gyro_bias(); }

  [[nodiscard]] const AttitudeHistory& history() const { return history_; }

 private:
  /// Whether a view shows no border, as its frame is rectified wholly.
  enum class Fit : std::uint8_t { whole, in_part };

  struct PathView {
    SteadyView view;
    Fit fit = Fit::whole;
  };

  Stabilizer(const CameraCalibration& camera, const ImuCalibration& imu, Lens lens,
             std::unique_ptr<AttitudeStream> attitudes, std::unique_ptr<CameraPath> path,
             const StabilizerOptions& options);

  [[nodiscard]] Eigen::Quaterniond q_world_camera(SensorTime time) const;
  [[nodiscard]] LineOrientation orientation_of(const FrameStamp& stamp, double rectified) const;
  [[nodiscard]] SensorTime readout_begin(const FrameStamp& stamp) const;
  [[nodiscard]] bool knows_readout_of(const FrameStamp& stamp) const;
  [[nodiscard]] SensorTime readout_end(const FrameStamp& stamp) const;
  [[nodiscard]] FrameOutline outline_of(const FrameStamp& stamp, double rectified,
                                        int points_per_side) const;
  [[nodiscard]] std::optional<PicturePolygon> shown_outline(const FrameStamp& stamp,
                                                            const VirtualCamera& camera) const;
  [[nodiscard]] WarpMesh mesh_for(const VirtualCamera& camera, MeshDensity least) const;
  [[nodiscard]] OutputProjection unzoomed_projection() const;
  [[nodiscard]] PathFrame path_frame(const FramePose& real) const;
  [[nodiscard]] VirtualCamera camera_of(const SteadyView& view) const;
  [[nodiscard]] bool shows_border(const VirtualCamera& camera) const;
  void give_way(VirtualCamera& camera);
  void release_waiting();
  void take_attitudes();
  void place_waiting_stamps();
  void place_next();
  void follow_path();

  CameraCalibration camera_;
  Eigen::Quaterniond q_imu_camera_;
  std::shared_ptr<const Lens> lens_;  ///< shared with what frames on the path keep of it
  RowTiming timing_;
  StabilizerOptions options_;
  double reference_line_;

  std::unique_ptr<AttitudeStream> attitudes_;
  AttitudeHistory history_;
  AttitudeJoin join_;
  bool is_coasting_ = false;
  std::deque<FrameStamp> waiting_;  ///< for the history to reach them
  std::unique_ptr<CameraPath> path_;
  std::deque<PathFrame> on_path_;    ///< frames whose views are still to come
  std::deque<PathFrame> left_path_;  ///< the last ones whose views have come
  std::optional<SteadyView> shown_;  ///< of the last of them
  ViewFade fade_;
  std::deque<PathView> views_;
  double last_rectified_ = 1;
};

}  // namespace gimbal
