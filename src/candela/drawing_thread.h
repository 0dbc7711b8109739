#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

#include "raster/render.h"

namespace candela {

/// A thread that has an OpenGL device: what every thread may ask for is drawn there, one piece of work after the other.
class DrawingThread {
 public:
  DrawingThread();
  /// Does first what is waiting.
  ~DrawingThread();
  DrawingThread(const DrawingThread&) = delete;
  DrawingThread& operator=(const DrawingThread&) = delete;

  /// Does `work` there and returns when it is done. The device is opened by the first. What `work` throws arrives here,
  /// and Error without OpenGL.
  void run(const std::function<void(const std::shared_ptr<raster::Device>& device)>& work);
  /// Does `work`, which throws nothing, there some time.
  void post(std::function<void()> work);

 private:
  void loop();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> waiting_;
  bool is_ending_ = false;
  std::shared_ptr<raster::Device> device_;  ///< of that thread alone
  std::thread thread_;                      ///< last: it uses the others
};

}  // namespace candela
