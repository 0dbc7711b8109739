// Time to decode packed buffer views, filter included, on one thread; bench/meshopt.mjs asks for it beside npm's
// decoder.
//
//   meshopt_time FILE MODE FILTER COUNT STRIDE …        milliseconds, the best of several, a line for each five

#include "io/meshopt.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <iostream>
#include <map>
#include <string>

#include "base/error.h"
#include "base/file.h"

int main(int argc, char** argv) {
  using Clock = std::chrono::steady_clock;
  using candela::io::MeshoptLayout;
  using Mode = MeshoptLayout::Mode;
  using Filter = MeshoptLayout::Filter;
  constexpr int kRuns = 15;
  const std::map<std::string, Mode> modes{
      {"ATTRIBUTES", Mode::attributes}, {"TRIANGLES", Mode::triangles}, {"INDICES", Mode::indices}};
  const std::map<std::string, Filter> filters{{"NONE", Filter::none},
                                              {"OCTAHEDRAL", Filter::octahedral},
                                              {"QUATERNION", Filter::quaternion},
                                              {"EXPONENTIAL", Filter::exponential},
                                              {"COLOR", Filter::color}};
  try {
    for (int i = 1; i + 4 < argc; i += 5) {
      const std::vector<std::byte> packed = candela::read_file(argv[i]);
      const MeshoptLayout layout{modes.at(argv[i + 1]), filters.at(argv[i + 2]), std::stoul(argv[i + 3]),
                                 std::stoul(argv[i + 4])};
      std::vector<std::byte> decoded(layout.count * layout.stride);
      double best = 1e30;
      for (int run = 0; run < kRuns; ++run) {
        const Clock::time_point start = Clock::now();
        candela::io::decode_meshopt(packed, layout, decoded);
        best = std::min(best, std::chrono::duration<double, std::milli>(Clock::now() - start).count());
      }
      std::printf("%.4f\n", best);
    }
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
  return 0;
}
