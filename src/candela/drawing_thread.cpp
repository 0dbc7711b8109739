#include "candela/drawing_thread.h"

#include <exception>
#include <future>
#include <utility>

namespace candela {

DrawingThread::DrawingThread() : thread_([this] { loop(); }) {}

DrawingThread::~DrawingThread() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void DrawingThread::loop() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return is_ending_ || !waiting_.empty(); });
    if (waiting_.empty()) break;
    const std::function<void()> work = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    work();
    lock.lock();
  }
  device_.reset();
}

void DrawingThread::post(std::function<void()> work) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(work));
  }
  changed_.notify_one();
}

void DrawingThread::run(const std::function<void(const std::shared_ptr<raster::Device>&)>& work) {
  std::promise<void> done;
  post([&] {
    try {
      if (device_ == nullptr) device_ = std::make_shared<raster::Device>();
      work(device_);
      done.set_value();
    } catch (...) {
      done.set_exception(std::current_exception());
    }
  });
  done.get_future().get();
}

}  // namespace candela
