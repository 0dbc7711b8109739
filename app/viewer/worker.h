#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "image/job.h"

namespace candela::viewer {

/// What other threads have to tell the one with the window, which runs it when it comes by.
class Mailbox {
 public:
  /// Called on the thread that posts, so that the window's wakes up.
  explicit Mailbox(std::function<void()> wake) : wake_(std::move(wake)) {}
  void post(std::function<void()> letter);
  /// Runs what was posted, in its order. Returns whether there was something.
  bool read();

 private:
  std::function<void()> wake_;
  std::mutex mutex_;
  std::vector<std::function<void()>> letters_;
};

/// A thread that does one thing after the other, of which only the last one that was asked for counts: what it is at is
/// told to stop, and what waits is forgotten.
class Worker {
 public:
  /// `at_end` is the last thing that the thread does.
  explicit Worker(std::function<void()> at_end = {}) : at_end_(std::move(at_end)), thread_([this] { run(); }) {}
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// `task` is given a job with a flag that says to stop. What it throws is lost.
  using Task = std::function<void(const Job&)>;
  void ask(Task task);
  /// What is done first and neither forgotten nor stopped, but at the end.
  void add_errand(Task task);
  /// Stops what it is at.
  void stop();
  /// Whether something is being done or waits.
  bool is_busy() const;

 private:
  void run();

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::function<void()> at_end_;
  Task waiting_;
  std::deque<Task> errands_;
  bool is_at_errand_ = false;
  std::shared_ptr<std::atomic<bool>> stop_;  ///< of what it is at; null when idle
  bool is_ending_ = false;
  std::thread thread_;
};

}  // namespace candela::viewer
