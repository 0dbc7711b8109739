#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>

namespace candela {

/// Calls `body(begin, end)` for sub-ranges of at most `grain` indices that together cover [begin, end) once.
/// Exceptions thrown by `body` reach the caller. Order and thread are unspecified: results must not depend on them.
void parallel_for(std::size_t begin, std::size_t end, std::size_t grain,
                  const std::function<void(std::size_t, std::size_t)>& body);

/// While alive, a raised flag ends what this thread has begun: its parallel_for throws Interrupted at the next
/// sub-range, and so does check(). Null: nothing ends it.
class StopScope {
 public:
  explicit StopScope(const std::atomic<bool>* stop);
  ~StopScope();
  StopScope(const StopScope&) = delete;
  StopScope& operator=(const StopScope&) = delete;

  /// Throws Interrupted where the flag of this thread's innermost scope is raised.
  static void check();

 private:
  const std::atomic<bool>* outer_;
};

/// How many threads parallel_for may use now.
int thread_count();

/// Limits every parallel_for (and Embree) to `threads` threads while alive; 0 means all the machine has.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

  int threads() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace candela
