#include "pipeline/queue/bounded_queue.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <thread>

namespace gimbal {
namespace {

TEST(BoundedQueue, HandsItemsOverInOrder) {
  BoundedQueue<int, WhenFull::wait> queue(3);
  std::thread giver([&] {
    for (int i = 0; i < 1000; ++i) EXPECT_TRUE(queue.push(i));
    queue.close();
  });
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(queue.pop(), i);
  EXPECT_EQ(queue.pop(), std::nullopt);
  EXPECT_EQ(queue.dropped(), 0U);
  giver.join();
}

TEST(BoundedQueue, AFullQueueMakesTheGiverWait) {
  BoundedQueue<int, WhenFull::wait> queue(1);
  ASSERT_TRUE(queue.push(1));
  std::atomic<bool> has_pushed = false;
  std::thread giver([&] {
    queue.push(2);
    has_pushed = true;
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_FALSE(has_pushed);
  EXPECT_EQ(queue.pop(), 1);
  EXPECT_EQ(queue.pop(), 2);
  giver.join();
}

TEST(BoundedQueue, OrTheNewestWinsAndTheLostAreCounted) {
  BoundedQueue<int, WhenFull::drop_oldest> queue(2);
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(queue.push(i));
  EXPECT_EQ(queue.dropped(), 3U);
  EXPECT_EQ(queue.size(), 2U);
  EXPECT_EQ(queue.pop(), 3);
  EXPECT_EQ(queue.pop(), 4);
}

TEST(BoundedQueue, AGiverThatWaitsForRoomLosesNothing) {
  BoundedQueue<int, WhenFull::drop_oldest> queue(1);
  std::thread giver([&] {
    for (int i = 0; i < 100; ++i) {
      queue.wait_for_room();
      queue.push(i);
    }
    queue.close();
  });
  for (int i = 0; i < 100; ++i) EXPECT_EQ(queue.pop(), i);
  giver.join();
}

TEST(BoundedQueue, ClosingWakesBothSides) {
  BoundedQueue<int, WhenFull::wait> full(1);
  ASSERT_TRUE(full.push(1));
  std::thread giver([&] { EXPECT_FALSE(full.push(2)); });
  BoundedQueue<int, WhenFull::wait> empty(1);
  std::thread taker([&] { EXPECT_EQ(empty.pop(), std::nullopt); });
  std::this_thread::sleep_for(std::chrono::milliseconds(10));
  full.close();
  empty.close();
  giver.join();
  taker.join();
  EXPECT_EQ(full.pop(), 1);  // what was held is not lost
  EXPECT_FALSE(full.push(3));
}

TEST(BoundedQueue, TakesItemsThatOnlyMove) {
  BoundedQueue<std::unique_ptr<int>, WhenFull::drop_oldest> queue(1);
  EXPECT_TRUE(queue.push(std::make_unique<int>(7)));
  EXPECT_EQ(**queue.pop(), 7);
}

}  // namespace
}  // namespace gimbal
