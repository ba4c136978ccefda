#include "pipeline/warp/band_workers.hpp"

#include <utility>

namespace gimbal {

BandWorkers::BandWorkers(int threads) {
  for (int i = 1; i < threads; ++i) {
    helpers_.emplace_back([this](const std::stop_token& stop) { help(stop); });
  }
}

BandWorkers::~BandWorkers() = default;

void BandWorkers::share(int pieces, const std::function<void(int)>& work) {
  std::unique_lock lock(mutex_);
  work_ = &work;
  begin_ = 0;
  end_ = pieces;
  unfinished_ = pieces;
  failure_ = nullptr;
  if (pieces > 1 && !helpers_.empty()) has_work_.notify_all();
  take_pieces(End::first, lock);
  is_done_.wait(lock, [this] { return unfinished_ == 0; });
  work_ = nullptr;
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void BandWorkers::help(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (has_work_.wait(lock, stop, [this] { return begin_ < end_; })) {
    take_pieces(End::last, lock);
  }
}

void BandWorkers::take_pieces(End end, std::unique_lock<std::mutex>& lock) {
  while (begin_ < end_) {
    const int piece = end == End::first ? begin_++ : --end_;
    const auto& work = *work_;
    std::exception_ptr failure;
    lock.unlock();
    try {
      work(piece);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    if (failure && !failure_) failure_ = failure;
    if (--unfinished_ == 0) is_done_.notify_one();
  }
}

}  // namespace gimbal
