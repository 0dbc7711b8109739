#pragma once

#include <complex>
#include <span>
#include <vector>

namespace candela::ibl {

/// Discrete Fourier transforms of one length, any length: mixed radix (Cooley & Tukey 1965, "An Algorithm for the
/// Machine Calculation of Complex Fourier Series"), a large prime factor costs its square.
class Fourier {
 public:
  explicit Fourier(int size);

  int size() const { return static_cast<int>(roots_.size()); }
  /// out[k] = Σ in[n] e^(-2πi kn / size); `in` and `out` do not overlap.
  void forward(std::span<const std::complex<double>> in, std::span<std::complex<double>> out) const;

 private:
  void transform(const std::complex<double>* in, std::size_t stride, std::complex<double>* out, std::size_t count,
                 std::size_t factor) const;

  std::vector<std::complex<double>> roots_;  ///< e^(-2πi k / size)
  std::vector<std::size_t> factors_;
};

}  // namespace candela::ibl
