#include "base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

#include "base/error.h"

namespace candela {
namespace {

TEST(unit_base_parallel, every_index_is_visited_once) {
  for (const int threads : {1, 2, 0}) {
    const ThreadLimit limit(threads);
    for (const std::size_t grain : {1u, 7u, 1000u}) {
      std::vector<std::atomic<int>> visits(1013);
      parallel_for(13, visits.size(), grain, [&](std::size_t begin, std::size_t end) {
        EXPECT_LT(begin, end);
        EXPECT_LE(end - begin, grain);
        for (std::size_t i = begin; i < end; ++i) ++visits[i];
      });
      for (std::size_t i = 0; i < visits.size(); ++i) ASSERT_EQ(visits[i], i < 13 ? 0 : 1) << i;
    }
  }
}

TEST(unit_base_parallel, an_empty_range_calls_nothing) {
  parallel_for(5, 5, 1, [](std::size_t, std::size_t) { FAIL(); });
}

TEST(unit_base_parallel, an_exception_reaches_the_caller) {
  EXPECT_THROW(parallel_for(0, 100, 1,
                            [](std::size_t begin, std::size_t) {
                              if (begin == 63) throw std::runtime_error("63");
                            }),
               std::runtime_error);
}

TEST(unit_base_parallel, the_limit_bounds_the_threads_at_work) {
  const ThreadLimit limit(1);
  EXPECT_EQ(limit.threads(), 1);
  std::atomic<int> at_work = 0, most = 0;
  parallel_for(0, 200, 1, [&](std::size_t, std::size_t) {
    const int now = ++at_work;
    if (now > most) most = now;
    --at_work;
  });
  EXPECT_EQ(most, 1);
  EXPECT_GE(ThreadLimit(0).threads(), 1);
}

TEST(unit_base_parallel, a_raised_flag_ends_the_work_of_its_scope_and_no_other) {
  std::atomic<bool> stop = false;
  std::atomic<int> done = 0;
  const auto work = [&] {
    parallel_for(0, 1000, 1, [&](std::size_t, std::size_t) {
      if (++done == 10) stop = true;
    });
  };
  {
    const StopScope scope(&stop);
    EXPECT_NO_THROW(StopScope::check());
    EXPECT_THROW(work(), Interrupted);
    EXPECT_LT(done, 1000);
    EXPECT_THROW(StopScope::check(), Interrupted);
    const StopScope inner(nullptr);  // a caller that asks for nothing does not lift what is asked for further out
    EXPECT_THROW(StopScope::check(), Interrupted);
  }
  EXPECT_NO_THROW(StopScope::check());
  done = 0;
  work();
  EXPECT_EQ(done, 1000);
}

}  // namespace
}  // namespace candela
