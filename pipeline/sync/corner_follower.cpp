#include "pipeline/sync/corner_follower.hpp"

const gimbal::CornerFollower* gimbald_corner_follower() {
  static constexpr gimbal::CornerFollower kFollower{gimbal::small_picture, gimbal::follow_burst};
  gimbal::keep_to_own_thread();
  return &kFollower;
}
