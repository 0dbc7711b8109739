#include "ibl/fourier.h"

#include <cmath>
#include <numbers>

namespace candela::ibl {

using Complex = std::complex<double>;

namespace {

/// Without the checks for infinities that operator* must make.
Complex product(Complex a, Complex b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

}  // namespace

Fourier::Fourier(int size) {
  for (int k = 0; k < size; ++k) {
    const double angle = -2.0 * std::numbers::pi * k / size;
    roots_.emplace_back(std::cos(angle), std::sin(angle));
  }
  auto rest = static_cast<std::size_t>(size);
  const auto divide = [&](std::size_t factor) {
    while (rest % factor == 0) {
      factors_.push_back(factor);
      rest /= factor;
    }
  };
  divide(4);
  std::size_t factor = 2;
  while (rest > 1) divide(factor++);
}

void Fourier::forward(std::span<const Complex> in, std::span<Complex> out) const {
  transform(in.data(), 1, out.data(), roots_.size(), 0);
}

void Fourier::transform(const Complex* in, std::size_t stride, Complex* out, std::size_t count,
                        std::size_t factor) const {
  if (count == 1) {
    out[0] = in[0];
    return;
  }
  const std::size_t radix = factors_[factor];
  const std::size_t part = count / radix;
  for (std::size_t r = 0; r < radix; ++r) {
    transform(in + r * stride, stride * radix, out + r * part, part, factor + 1);
  }
  const std::size_t turn = roots_.size() / count;  // of the roots, per step of this length
  if (radix == 4) {
    for (std::size_t k = 0; k < part; ++k) {
      const Complex a = out[k];
      const Complex b = product(out[k + part], roots_[k * turn]);
      const Complex c = product(out[k + 2 * part], roots_[2 * k * turn]);
      const Complex d = product(out[k + 3 * part], roots_[3 * k * turn]);
      const Complex sum = b + d, difference(b.imag() - d.imag(), d.real() - b.real());  // -i (b - d)
      out[k] = a + c + sum;
      out[k + part] = a - c + difference;
      out[k + 2 * part] = a + c - sum;
      out[k + 3 * part] = a - c - difference;
    }
    return;
  }
  std::vector<Complex> column(radix);
  for (std::size_t k = 0; k < part; ++k) {
    for (std::size_t r = 0; r < radix; ++r) column[r] = product(out[k + r * part], roots_[r * k * turn]);
    for (std::size_t q = 0; q < radix; ++q) {
      Complex sum(0.0);
      for (std::size_t r = 0; r < radix; ++r) sum += product(column[r], roots_[(q * r % radix) * part * turn]);
      out[k + q * part] = sum;
    }
  }
}

}  // namespace candela::ibl
