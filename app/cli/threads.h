#pragma once

#include <cstdlib>
#include <string>

#include "base/parallel.h"

namespace candela::cli {

constexpr int kMostThreads = 1024;

/// How many threads a work with pictures in real time may take while this lives; 0 is all. Mesa's processor driver has
/// threads of its own.
class Threads {
 public:
  explicit Threads(int count) : limit_(count) {
    if (count > 0) setenv("LP_NUM_THREADS", std::to_string(count).c_str(), 0);
  }
  /// As ThreadLimit has it.
  int threads() const { return limit_.threads(); }

 private:
  ThreadLimit limit_;
};

}  // namespace candela::cli
