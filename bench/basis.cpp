// Time to decode the largest image of KTX 2 files to RGBA, on one thread; bench/basis.mjs asks for it beside three's.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <iostream>

#include "base/error.h"
#include "base/file.h"
#include "base/parallel.h"
#include "image/image_file.h"

int main(int argc, char** argv) {
  using Clock = std::chrono::steady_clock;
  constexpr int kRuns = 15;
  const candela::ThreadLimit one(1);
  try {
    for (int i = 1; i < argc; ++i) {
      const std::vector<std::byte> bytes = candela::read_file(argv[i]);
      double best = 1e30;
      for (int run = 0; run < kRuns; ++run) {
        const Clock::time_point start = Clock::now();
        const candela::TextureImage image = candela::decode_texture(bytes, argv[i]);
        best = std::min(best, std::chrono::duration<double, std::milli>(Clock::now() - start).count());
        if (image.pixels.empty()) return 1;
      }
      std::printf("%.4f\n", best);
    }
  } catch (const candela::Error& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
  return 0;
}
