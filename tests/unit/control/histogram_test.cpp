#include "daemon/histogram.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <thread>
#include <vector>

namespace gimbal {
namespace {

TEST(Histogram, CountsAsSortingDoes) {
  std::mt19937 random(7);
  std::lognormal_distribution<double> durations(-4, 2);
  std::vector<double> seconds(10'000);
  for (double& s : seconds) s = durations(random);
  Histogram histogram;
  for (const double s : seconds) histogram.add(duration_from_seconds(s));

  std::ranges::sort(seconds);
  const Histogram::Counts counts = histogram.counts();
  std::uint64_t below = 0;
  for (std::size_t i = 0; i < Histogram::kBounds_s.size(); ++i) {
    below += counts.in_range[i];
    const auto end = std::ranges::upper_bound(seconds, Histogram::kBounds_s[i]);
    EXPECT_EQ(below, static_cast<std::uint64_t>(end - seconds.begin())) << i;
  }
  EXPECT_EQ(below + counts.in_range.back(), seconds.size());
  EXPECT_NEAR(counts.sum_s, std::accumulate(seconds.begin(), seconds.end(), 0.0), 1e-4);
}

TEST(Histogram, AnEndBelongsToTheRangeBelowIt) {
  Histogram histogram;
  histogram.add(std::chrono::milliseconds(1));
  EXPECT_EQ(histogram.counts().in_range[0], 1U);
}

TEST(Histogram, LosesNothingAmongThreads) {
  Histogram histogram;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 10'000; ++i) histogram.add(std::chrono::milliseconds(3));
    });
  }
  for (std::thread& thread : threads) thread.join();
  const auto counts = histogram.counts();
  EXPECT_EQ(std::accumulate(counts.in_range.begin(), counts.in_range.end(), std::uint64_t{0}),
            40'000U);
  EXPECT_NEAR(counts.sum_s, 120, 1e-6);
}

}  // namespace
}  // namespace gimbal
