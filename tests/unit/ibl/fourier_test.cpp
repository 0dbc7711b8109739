#include "ibl/fourier.h"

#include <gtest/gtest.h>

#include <numbers>

namespace candela::ibl {
namespace {

using Complex = std::complex<double>;

TEST(fourier, any_length_equals_the_sum_it_stands_for) {
  for (const int size : {1, 2, 3, 8, 12, 35, 64, 97, 100, 640}) {
    std::vector<Complex> in, out(static_cast<std::size_t>(size));
    for (int n = 0; n < size; ++n) in.emplace_back(std::sin(n * n + 1.0), std::cos(3.0 * n));
    Fourier(size).forward(in, out);
    for (int k = 0; k < size; ++k) {
      Complex sum(0.0);
      for (int n = 0; n < size; ++n) {
        sum += in[static_cast<std::size_t>(n)] *
               std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>(k * n % size) / size);
      }
      EXPECT_NEAR(std::abs(out[static_cast<std::size_t>(k)] - sum), 0.0, 1e-10) << size << ' ' << k;
    }
  }
}

}  // namespace
}  // namespace candela::ibl
