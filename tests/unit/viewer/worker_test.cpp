#include "viewer/worker.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace candela::viewer {
namespace {

using namespace std::chrono_literals;

void wait_for(const std::function<bool()>& is_so) {
  for (int i = 0; i < 2000 && !is_so(); ++i) std::this_thread::sleep_for(5ms);
  ASSERT_TRUE(is_so());
}

TEST(unit_viewer_worker, the_last_task_stops_the_first_and_replaces_those_between) {
  std::atomic<bool> is_at_first = false, has_stopped = false, did_second = false, did_third = false;
  Worker worker;
  worker.ask([&](const Job& job) {
    is_at_first = true;
    while (!job.is_stopped()) std::this_thread::sleep_for(1ms);
    std::this_thread::sleep_for(50ms);
    has_stopped = true;
  });
  wait_for([&] { return is_at_first.load(); });
  worker.ask([&](const Job&) { did_second = true; });
  worker.ask([&](const Job&) { did_third = true; });
  wait_for([&] { return did_third.load(); });
  EXPECT_TRUE(has_stopped);
  EXPECT_FALSE(did_second);
}

TEST(unit_viewer_worker, errands_are_neither_forgotten_nor_stopped) {
  std::atomic<int> done = 0;
  std::atomic<bool> was_stopped = false, is_last = false;
  Worker worker;
  for (int i = 0; i < 3; ++i) {
    worker.add_errand([&](const Job& job) {
      std::this_thread::sleep_for(20ms);
      was_stopped = was_stopped || job.is_stopped();
      ++done;
    });
    worker.ask([&](const Job&) { is_last = done == 3; });
  }
  wait_for([&] { return is_last.load(); });
  EXPECT_EQ(done, 3);
  EXPECT_FALSE(was_stopped);
}

TEST(unit_viewer_worker, ending_stops_what_it_is_at_and_does_the_last_thing_on_its_thread) {
  std::atomic<bool> is_at_it = false;
  std::thread::id worked, ended;
  {
    Worker worker([&] { ended = std::this_thread::get_id(); });
    worker.ask([&](const Job& job) {
      worked = std::this_thread::get_id();
      is_at_it = true;
      while (!job.is_stopped()) std::this_thread::sleep_for(1ms);
    });
    wait_for([&] { return is_at_it.load(); });
  }
  EXPECT_EQ(worked, ended);
  EXPECT_NE(worked, std::this_thread::get_id());
}

TEST(unit_viewer_worker, a_task_that_throws_ends_no_thread) {
  std::atomic<bool> is_done = false;
  Worker worker;
  worker.add_errand([](const Job&) { throw std::runtime_error("of the task's own"); });
  worker.ask([&](const Job&) { is_done = true; });
  wait_for([&] { return is_done.load(); });
}

TEST(unit_viewer_mailbox, letters_are_read_in_their_order_on_the_reader_s_thread) {
  std::atomic<int> wakes = 0;
  Mailbox mailbox([&] { ++wakes; });
  std::vector<int> read;
  std::thread poster([&] {
    for (int i = 0; i < 5; ++i) mailbox.post([&read, i] { read.push_back(i); });
  });
  poster.join();
  EXPECT_EQ(wakes, 5);
  EXPECT_TRUE(mailbox.read());
  EXPECT_EQ(read, (std::vector<int>{0, 1, 2, 3, 4}));
  EXPECT_FALSE(mailbox.read());
}

}  // namespace
}  // namespace candela::viewer
