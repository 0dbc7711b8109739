#pragma once

#include <atomic>

namespace candela::cli {

/// While alive, the first Ctrl-C (SIGINT) or SIGTERM only raises a flag; the second ends the process as usual.
/// One may live within another. For the main thread.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  static const std::atomic<bool>& requested();
};

}  // namespace candela::cli
