#pragma once

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>
#include <vector>

namespace gimbal {

/// Threads that share pieces of work with the one that asks for it. They sleep in between.
class BandWorkers {
 public:
  /// `threads` in all, at least one: the caller's own is among them.
  explicit BandWorkers(int threads);
  BandWorkers(const BandWorkers&) = delete;
  BandWorkers& operator=(const BandWorkers&) = delete;
  ~BandWorkers();

  [[nodiscard]] int threads() const { return static_cast<int>(helpers_.size()) + 1; }

  /// Calls work(i) once for each i from 0 to pieces - 1, on any of the threads, and returns when
  /// all are done. The caller begins with the first and the others with the last, so that a thread
  /// mostly has neighbouring ones, and the same from one time to the next. What the first piece
  /// that failed has thrown is thrown again here.
  void share(int pieces, const std::function<void(int)>& work);

 private:
  enum class End : std::uint8_t { first, last };

  void help(const std::stop_token& stop);
  /// Takes pieces from that end until none is left; `lock` holds mutex_ before and after.
  void take_pieces(End end, std::unique_lock<std::mutex>& lock);

  std::mutex mutex_;
  std::condition_variable_any has_work_;
  std::condition_variable is_done_;
  const std::function<void(int)>* work_ = nullptr;
  int begin_ = 0;  ///< of the pieces that nobody has taken
  int end_ = 0;
  int unfinished_ = 0;
  std::exception_ptr failure_;
  std::vector<std::jthread> helpers_;  ///< last: they use the rest
};

}  // namespace gimbal
