// The filter is compiled into this program with EIGEN_RUNTIME_NO_MALLOC: where it is forbidden, an
// allocation by Eigen fails an assertion. All others go through operator new, which counts.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <new>

#include "pipeline/estimator/attitude_ekf.hpp"

#ifndef EIGEN_RUNTIME_NO_MALLOC
#error "what Eigen allocates would go unseen"
#endif

namespace {

// Counts what this program allocates.
// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables)
std::size_t allocation_count = 0;

}  // namespace

// The filter's state is aligned no stricter than malloc's memory.
void* operator new(std::size_t size) {
  ++allocation_count;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t /*size*/) noexcept {
  std::free(memory);
}

namespace gimbal {
namespace {

using std::chrono::milliseconds;

TEST(NoAllocation, NeitherUpdatesNorPredictionsAllocate) {
  AttitudeEkf ekf;
  double trace = 0;
  SensorTime time;
  Eigen::internal::set_is_malloc_allowed(false);
  const std::size_t before = allocation_count;
  for (int i = 0; i < 2000; ++i) {
    time += i % 300 == 0 ? milliseconds(1500) : milliseconds(5);  // holes too
    ImuSample sample{time,
                     {std::sin(0.01 * i), 0.3 * std::cos(0.02 * i), i % 100 < 20 ? 4.0 : -0.2},
                     Eigen::Vector3d(std::sin(0.05 * i), 9, 2)};
    if (i % 7 == 0) sample.accel_m_s2.reset();
    if (i % 11 == 0) sample.gyro_rad_s.x() = std::nan("");
    ekf.update(sample);
    trace += ekf.predict(time + milliseconds(3)).covariance_rad2.trace();
  }
  const std::size_t after = allocation_count;
  Eigen::internal::set_is_malloc_allowed(true);
  EXPECT_EQ(after, before);
  EXPECT_GT(trace, 0);
  EXPECT_GT(ekf.counts().restarts, 2U);
  EXPECT_GT(ekf.counts().lost_samples, 100U);
}

}  // namespace
}  // namespace gimbal
