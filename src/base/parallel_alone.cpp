#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"

// A build without threads, as a page in a browser runs it: the caller does all the work.
namespace candela {

namespace {

const std::atomic<bool>* g_stop = nullptr;

void throw_if_raised(const std::atomic<bool>* stop) {
  if (stop != nullptr && stop->load(std::memory_order_relaxed)) throw Interrupted("nothing is kept of this work");
}

}  // namespace

StopScope::StopScope(const std::atomic<bool>* stop) : outer_(g_stop) {
  if (stop != nullptr) g_stop = stop;
}
StopScope::~StopScope() { g_stop = outer_; }
void StopScope::check() { throw_if_raised(g_stop); }

void parallel_for(std::size_t begin, std::size_t end, std::size_t grain,
                  const std::function<void(std::size_t, std::size_t)>& body) {
  for (std::size_t first = begin; first < end; first += grain) {
    throw_if_raised(g_stop);
    body(first, std::min(first + grain, end));
  }
}

int thread_count() { return 1; }

struct ThreadLimit::Impl {};
ThreadLimit::ThreadLimit(int) {}
ThreadLimit::~ThreadLimit() = default;
int ThreadLimit::threads() const { return 1; }

}  // namespace candela
