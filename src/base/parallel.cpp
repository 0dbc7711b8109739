#include "base/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "base/error.h"

namespace candela {

namespace {

thread_local const std::atomic<bool>* t_stop = nullptr;

void throw_if_raised(const std::atomic<bool>* stop) {
  if (stop != nullptr && stop->load(std::memory_order_relaxed)) throw Interrupted("nothing is kept of this work");
}

}  // namespace

StopScope::StopScope(const std::atomic<bool>* stop) : outer_(t_stop) {
  if (stop != nullptr) t_stop = stop;
}
StopScope::~StopScope() { t_stop = outer_; }
void StopScope::check() { throw_if_raised(t_stop); }

#ifdef __SANITIZE_THREAD__

// Debian's oneTBB is not instrumented: ThreadSanitizer cannot see it hand work over and takes every task for a race.
// Plain threads leave it the races of the bodies, which are ours.
void parallel_for(std::size_t begin, std::size_t end, std::size_t grain,
                  const std::function<void(std::size_t, std::size_t)>& body) {
  const std::atomic<bool>* const stop = t_stop;
  std::atomic<std::size_t> next{begin};
  std::mutex mutex;
  std::exception_ptr error;
  const auto work = [&] {
    try {
      for (std::size_t first = next.fetch_add(grain); first < end; first = next.fetch_add(grain)) {
        throw_if_raised(stop);
        body(first, std::min(first + grain, end));
      }
    } catch (...) {
      const std::lock_guard lock(mutex);
      error = std::current_exception();
      next = end;
    }
  };
  {
    std::vector<std::jthread> helpers(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism) -
                                      1);
    for (std::jthread& helper : helpers) helper = std::jthread(work);
    work();
  }
  if (error) std::rethrow_exception(error);
}

#else

void parallel_for(std::size_t begin, std::size_t end, std::size_t grain,
                  const std::function<void(std::size_t, std::size_t)>& body) {
  const std::atomic<bool>* const stop = t_stop;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(begin, end, grain),
      [&, stop](const tbb::blocked_range<std::size_t>& range) {
        throw_if_raised(stop);
        body(range.begin(), range.end());
      },
      tbb::simple_partitioner{});
}

#endif

int thread_count() {
  return static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

struct ThreadLimit::Impl {
  explicit Impl(int count)
      : threads(count), control(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count)) {}
  int threads;
  tbb::global_control control;
};

ThreadLimit::ThreadLimit(int threads)
    : impl_(std::make_unique<Impl>(threads > 0 ? threads : tbb::info::default_concurrency())) {}
ThreadLimit::~ThreadLimit() = default;
int ThreadLimit::threads() const { return impl_->threads; }

}  // namespace candela
