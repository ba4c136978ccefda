#include "pipeline/warp/band_workers.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

namespace gimbal {
namespace {

TEST(BandWorkers, DoEachPieceOnce) {
  for (const int threads : {1, 2, 5}) {
    BandWorkers workers(threads);
    EXPECT_EQ(workers.threads(), threads);
    for (const int pieces : {0, 1, 2, 7, 100}) {
      std::vector<std::atomic<int>> times(static_cast<std::size_t>(pieces));
      workers.share(pieces, [&](int piece) { ++times[static_cast<std::size_t>(piece)]; });
      for (const auto& count : times) EXPECT_EQ(count, 1) << threads << ", " << pieces;
    }
  }
}

TEST(BandWorkers, WorkAtTheSameTime) {
  BandWorkers workers(3);
  std::atomic<int> met = 0;
  std::set<std::thread::id> threads;
  std::mutex mutex;
  workers.share(3, [&](int) {
    {
      const std::scoped_lock lock(mutex);
      threads.insert(std::this_thread::get_id());
    }
    ++met;
    while (met < 3) std::this_thread::yield();  // for ever, were they to come one after the other
  });
  EXPECT_EQ(threads.size(), 3U);
  EXPECT_TRUE(threads.contains(std::this_thread::get_id()));
}

TEST(BandWorkers, PassOnWhatAPieceThrows) {
  BandWorkers workers(2);
  std::atomic<int> done = 0;
  EXPECT_THROW(workers.share(10,
                             [&](int piece) {
                               if (piece == 4) throw std::runtime_error("4");
                               ++done;
                             }),
               std::runtime_error);
  EXPECT_EQ(done, 9);
  workers.share(1, [&](int) { ++done; });
  EXPECT_EQ(done, 10);
}

}  // namespace
}  // namespace gimbal
