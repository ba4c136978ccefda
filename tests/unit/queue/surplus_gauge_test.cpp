#include "pipeline/queue/surplus_gauge.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace gimbal {
namespace {

constexpr std::size_t kWindow = 20;

/// A pool of things that are told apart by nothing, as it would be with a gauge.
class Pool {
 public:
  void take() {
    gauge_.lent();
    if (waiting_ > 0) --waiting_;
    ++out_;
  }
  void give_back() {
    --out_;
    if (!gauge_.returned_for_good()) ++waiting_;
  }
  void cycle(int at_once, int times) {
    for (int i = 0; i < times; ++i) {
      for (int k = 0; k < at_once; ++k) take();
      for (int k = 0; k < at_once; ++k) give_back();
    }
  }
  [[nodiscard]] int held() const { return out_ + waiting_; }

 private:
  SurplusGauge gauge_{kWindow};
  int out_ = 0;
  int waiting_ = 0;
};

TEST(SurplusGauge, KeepsWhatIsUsed) {
  Pool pool;
  for (int i = 0; i < 500; ++i) {
    pool.cycle(i % 5 == 0 ? 4 : 3, 1);  // the fourth is wanted once a window, at the least
    EXPECT_EQ(pool.held(), 4);
  }
}

TEST(SurplusGauge, FreesWhatWasWantedOnce) {
  Pool pool;
  pool.cycle(3, 50);
  pool.cycle(9, 1);
  EXPECT_EQ(pool.held(), 9);
  pool.cycle(3, 2 * kWindow);
  EXPECT_EQ(pool.held(), 3);
}

TEST(SurplusGauge, GrowsAgain) {
  Pool pool;
  pool.cycle(9, 1);
  pool.cycle(1, 100);
  EXPECT_EQ(pool.held(), 1);
  pool.cycle(6, 1);
  EXPECT_EQ(pool.held(), 6);
}

TEST(SurplusGauge, CountsWhatStaysOutForLong) {
  Pool pool;
  for (int i = 0; i < 5; ++i) pool.take();
  pool.cycle(2, 100);
  EXPECT_EQ(pool.held(), 7);
}

}  // namespace
}  // namespace gimbal
