#include "viewer/worker.h"

#include <exception>
#include <utility>

namespace candela::viewer {

void Mailbox::post(std::function<void()> letter) {
  {
    const std::lock_guard lock(mutex_);
    letters_.push_back(std::move(letter));
  }
  wake_();
}

bool Mailbox::read() {
  std::vector<std::function<void()>> letters;
  {
    const std::lock_guard lock(mutex_);
    letters.swap(letters_);
  }
  for (const std::function<void()>& letter : letters) letter();
  return !letters.empty();
}

Worker::~Worker() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
    waiting_ = nullptr;
    errands_.clear();
    if (stop_ != nullptr) stop_->store(true);
  }
  changed_.notify_all();
  thread_.join();
}

void Worker::ask(Task task) {
  {
    const std::lock_guard lock(mutex_);
    waiting_ = std::move(task);
    if (stop_ != nullptr && !is_at_errand_) stop_->store(true);
  }
  changed_.notify_all();
}

void Worker::add_errand(Task task) {
  {
    const std::lock_guard lock(mutex_);
    errands_.push_back(std::move(task));
  }
  changed_.notify_all();
}

void Worker::stop() {
  const std::lock_guard lock(mutex_);
  waiting_ = nullptr;
  if (stop_ != nullptr && !is_at_errand_) stop_->store(true);
}

bool Worker::is_busy() const {
  const std::lock_guard lock(mutex_);
  return waiting_ != nullptr || stop_ != nullptr || !errands_.empty();
}

void Worker::run() {
  for (;;) {
    Task task;
    std::shared_ptr<std::atomic<bool>> stop;
    {
      std::unique_lock lock(mutex_);
      stop_ = nullptr;
      changed_.wait(lock, [&] { return is_ending_ || waiting_ != nullptr || !errands_.empty(); });
      if (is_ending_) break;
      is_at_errand_ = !errands_.empty();
      if (is_at_errand_) {
        task = std::move(errands_.front());
        errands_.pop_front();
      } else {
        task = std::exchange(waiting_, nullptr);
      }
      stop_ = stop = std::make_shared<std::atomic<bool>>(false);
    }
    try {
      task({.stop = stop.get()});
    } catch (const std::exception&) {
      // Whoever wants to know catches it in the task.
    }
    task = nullptr;  // what it holds goes with it, before the next is there
  }
  if (at_end_) at_end_();
}

}  // namespace candela::viewer
