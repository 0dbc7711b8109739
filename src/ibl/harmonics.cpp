#include "ibl/harmonics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "ibl/fourier.h"

namespace candela::ibl {

using Complex = std::complex<double>;

namespace {

constexpr double kPiD = std::numbers::pi;
constexpr std::size_t kLanes = 8;  // rows that are worked on together
constexpr std::size_t kParts = 6;  // three complex channels

using Lanes = std::array<double, kLanes>;

/// P̄_lm of fixed m and rising l at many polar angles at once. Recurrence of Holmes & Featherstone 2002, "A Unified
/// Approach to the Clenshaw Summation", eq. 11 to 13, normalised to 1 over the sphere. P̄_mm ∝ sin^m θ; where that is
/// below what a double holds, the function stays negligible up to any degree used here.
class Legendre {
 public:
  explicit Legendre(const std::vector<double>& polar) : blocks_((polar.size() + kLanes - 1) / kLanes) {
    x_.resize(blocks_), sine_.resize(blocks_), now_.resize(blocks_), below_.resize(blocks_);
    for (std::size_t i = 0; i < blocks_ * kLanes; ++i) {
      const double theta = i < polar.size() ? polar[i] : 0.5 * kPiD;
      x_[i / kLanes][i % kLanes] = std::cos(theta);
      sine_[i / kLanes][i % kLanes] = std::sin(theta);
    }
  }

  std::size_t blocks() const { return blocks_; }
  const Lanes& values(std::size_t block) const { return now_[block]; }

  /// l = m.
  void start(int m) {
    constexpr double kNothing = -600.0;  // e^-600: far above where doubles lose digits
    m_ = l_ = m;
    double norm = std::log(1.0 / (4.0 * kPiD)) + std::log(2.0 * m + 1.0);
    for (int k = 1; k <= m; ++k) norm += std::log((2.0 * k - 1.0) / (2.0 * k));
    for (std::size_t b = 0; b < blocks_; ++b) {
      for (std::size_t i = 0; i < kLanes; ++i) {
        const double exponent = 0.5 * norm + (m > 0 ? m * std::log(sine_[b][i]) : 0.0);
        now_[b][i] = exponent < kNothing ? 0.0 : std::exp(exponent);
        below_[b][i] = 0.0;
      }
    }
  }

  /// l → l + 1.
  void step() {
    const double l = ++l_, m = m_;
    const double a = std::sqrt((4.0 * l * l - 1.0) / (l * l - m * m));
    const double b = a * std::sqrt(((l - 1.0) * (l - 1.0) - m * m) / (4.0 * (l - 1.0) * (l - 1.0) - 1.0));
    for (std::size_t k = 0; k < blocks_; ++k) {
      Lanes& now = now_[k];
      Lanes& below = below_[k];
      const Lanes& x = x_[k];
      for (std::size_t i = 0; i < kLanes; ++i) {
        const double next = a * x[i] * now[i] - b * below[i];
        below[i] = now[i];
        now[i] = next;
      }
    }
  }

 private:
  std::size_t blocks_;
  std::vector<Lanes> x_, sine_, now_, below_;
  int m_ = 0;
  int l_ = 0;
};

/// Polar angles at which a panorama's rows are taken, from the upper pole on, and what a row's solid angle gives each.
struct RowPoints {
  int per_row = 1;
  std::vector<double> polar;
  std::vector<double> weight;  ///< ∫ sin θ dθ
};

RowPoints row_points(int height, int lmax) {
  constexpr double kOneIsEnough = 0.05;  // degrees × row: one point errs by its square / 24
  const double step = kPiD / height;
  RowPoints points;
  points.per_row = lmax * step > kOneIsEnough ? 2 : 1;
  for (int row = 0; row < height; ++row) {
    const double middle = (row + 0.5) * step;
    const double exact = 2.0 * std::sin(middle) * std::sin(0.5 * step);
    if (points.per_row == 1) {
      points.polar.push_back(middle);
      points.weight.push_back(exact);
      continue;
    }
    const double half = 0.5 * step / std::sqrt(3.0);
    for (const double theta : {middle - half, middle + half}) {
      points.polar.push_back(theta);
      points.weight.push_back(exact * std::sin(theta) / (std::sin(middle - half) + std::sin(middle + half)));
    }
  }
  return points;
}

/// Fourier coefficients in azimuth of every row: [m][channel][row].
std::vector<Complex> row_spectra(const Image& map, double azimuth, int lmax) {
  const auto width = static_cast<std::size_t>(map.width), height = static_cast<std::size_t>(map.height);
  const Fourier fourier(map.width);
  std::vector<Complex> spectra((static_cast<std::size_t>(lmax) + 1) * 3 * height);
  // ∫ e^(-imφ) over a column, around its left edge.
  std::vector<Complex> column(static_cast<std::size_t>(lmax) + 1);
  const double cell = 2.0 * kPiD / map.width;
  for (int m = 0; m <= lmax; ++m) {
    const double size = m == 0 ? cell : 2.0 * std::sin(0.5 * m * cell) / m;
    column[static_cast<std::size_t>(m)] = std::polar(size, -m * (azimuth + 0.5 * cell));
  }
  parallel_for(0, height, 16, [&](std::size_t begin, std::size_t end) {
    std::vector<Complex> in(width), out(width);
    for (std::size_t y = begin; y < end; ++y) {
      for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t x = 0; x < width; ++x) in[x] = static_cast<double>(map.pixels[(y * width + x) * 3 + c]);
        fourier.forward(in, out);
        for (std::size_t m = 0; m <= static_cast<std::size_t>(lmax); ++m) {
          spectra[(m * 3 + c) * height + y] = out[m % width] * column[m];
        }
      }
    }
  });
  return spectra;
}

/// The rows of order m folded about the equator and weighted: [even, odd][block][part].
struct Folded {
  std::vector<std::array<Lanes, kParts>> even, odd;
};

Folded fold(const std::vector<Complex>& spectra, std::size_t height, int m, const RowPoints& points) {
  const std::size_t count = points.polar.size();
  const std::size_t half = (count + 1) / 2;
  const auto per_row = static_cast<std::size_t>(points.per_row);
  Folded folded;
  folded.even.assign((half + kLanes - 1) / kLanes, {});
  folded.odd = folded.even;
  for (std::size_t i = 0; i < half; ++i) {
    const std::size_t mirror = count - 1 - i;
    for (std::size_t c = 0; c < 3; ++c) {
      const Complex* row = spectra.data() + (static_cast<std::size_t>(m) * 3 + c) * height;
      const Complex north = row[i / per_row] * points.weight[i];
      const Complex south = mirror == i ? Complex(0.0) : row[mirror / per_row] * points.weight[mirror];
      const Complex sum = north + south, difference = north - south;
      folded.even[i / kLanes][2 * c][i % kLanes] = sum.real();
      folded.even[i / kLanes][2 * c + 1][i % kLanes] = sum.imag();
      folded.odd[i / kLanes][2 * c][i % kLanes] = difference.real();
      folded.odd[i / kLanes][2 * c + 1][i % kLanes] = difference.imag();
    }
  }
  return folded;
}

}  // namespace

Harmonics::Harmonics(int lmax) : lmax_(lmax) {
  std::size_t count = 0;
  for (int m = 0; m <= lmax; ++m) {
    offset_.push_back(count);
    count += static_cast<std::size_t>(lmax - m) + 1;
  }
  values_.resize(count * 3);
}

Harmonics analyse(const Image& map, double azimuth, int lmax) {
  const RowPoints points = row_points(map.height, lmax);
  const std::vector<Complex> spectra = row_spectra(map, azimuth, lmax);
  const std::vector<double> north(points.polar.begin(),
                                  points.polar.begin() + static_cast<std::ptrdiff_t>((points.polar.size() + 1) / 2));
  Harmonics harmonics(lmax);
  parallel_for(0, static_cast<std::size_t>(lmax) + 1, 1, [&](std::size_t begin, std::size_t end) {
    Legendre legendre(north);
    for (auto m = static_cast<int>(begin); m < static_cast<int>(end); ++m) {
      const Folded folded = fold(spectra, static_cast<std::size_t>(map.height), m, points);
      legendre.start(m);
      for (int l = m; l <= lmax; ++l) {
        if (l > m) legendre.step();
        const auto& rows = (l + m) % 2 == 0 ? folded.even : folded.odd;
        std::array<Lanes, kParts> sums{};
        for (std::size_t b = 0; b < legendre.blocks(); ++b) {
          const Lanes& p = legendre.values(b);
          for (std::size_t k = 0; k < kParts; ++k) {
            for (std::size_t i = 0; i < kLanes; ++i) sums[k][i] += p[i] * rows[b][k][i];
          }
        }
        for (int c = 0; c < 3; ++c) {
          double re = 0.0, im = 0.0;
          for (std::size_t i = 0; i < kLanes; ++i) {
            re += sums[static_cast<std::size_t>(2 * c)][i];
            im += sums[static_cast<std::size_t>(2 * c + 1)][i];
          }
          harmonics.at(l, m, c) = {re, im};
        }
      }
    }
  });
  return harmonics;
}

dvec3 evaluate(const Harmonics& harmonics, dvec3 direction) {
  Legendre legendre({std::atan2(std::hypot(direction.x, direction.z), direction.y)});
  const double azimuth = std::atan2(direction.z, direction.x);
  dvec3 sum(0.0);
  for (int m = 0; m <= harmonics.lmax(); ++m) {
    const Complex turn = std::polar(m == 0 ? 1.0 : 2.0, m * azimuth);
    legendre.start(m);
    for (int l = m; l <= harmonics.lmax(); ++l) {
      if (l > m) legendre.step();
      for (int c = 0; c < 3; ++c) sum[c] += legendre.values(0)[0] * (harmonics.at(l, m, c) * turn).real();
    }
  }
  return sum;
}

namespace {

constexpr int kTaps = 8;
constexpr int kMargin = kTaps / 2;

/// Lagrange's weights of eight equidistant points for a position u in [0, 1) between the middle two.
std::array<double, kTaps> lagrange(double u) {
  std::array<double, kTaps> w{};
  const double x = u + kMargin - 1;
  for (int i = 0; i < kTaps; ++i) {
    double value = 1.0;
    for (int j = 0; j < kTaps; ++j) {
      if (j != i) value *= (x - j) / (i - j);
    }
    w[static_cast<std::size_t>(i)] = value;
  }
  return w;
}

/// The rows' Fourier coefficients: [row][channel][m].
std::vector<Complex> synthesise_rows(const Harmonics& harmonics, const std::vector<double>& factors, int lmax,
                                     int rows) {
  const std::size_t half = static_cast<std::size_t>(rows) / 2;
  const std::size_t orders = static_cast<std::size_t>(lmax) + 1;
  std::vector<double> polar;
  polar.reserve(half);
  for (std::size_t j = 0; j < half; ++j) polar.push_back((static_cast<double>(j) + 0.5) * kPiD / rows);
  std::vector<Complex> spectra(static_cast<std::size_t>(rows) * 3 * orders);
  parallel_for(0, orders, 1, [&](std::size_t begin, std::size_t end) {
    Legendre legendre(polar);
    std::vector<std::array<Lanes, kParts>> sums[2];
    for (auto m = static_cast<int>(begin); m < static_cast<int>(end); ++m) {
      legendre.start(m);
      for (auto& parity : sums) parity.assign(legendre.blocks(), {});
      for (int l = m; l <= lmax; ++l) {
        if (l > m) legendre.step();
        std::array<double, kParts> a{};
        for (int c = 0; c < 3; ++c) {
          const Complex v = harmonics.at(l, m, c) * factors[static_cast<std::size_t>(l)];
          a[static_cast<std::size_t>(2 * c)] = v.real();
          a[static_cast<std::size_t>(2 * c + 1)] = v.imag();
        }
        auto& rows_sums = sums[(l + m) % 2];
        for (std::size_t b = 0; b < legendre.blocks(); ++b) {
          const Lanes& p = legendre.values(b);
          for (std::size_t k = 0; k < kParts; ++k) {
            for (std::size_t i = 0; i < kLanes; ++i) rows_sums[b][k][i] += p[i] * a[k];
          }
        }
      }
      for (std::size_t j = 0; j < half; ++j) {
        for (std::size_t c = 0; c < 3; ++c) {
          const auto part = [&](int parity) {
            const auto& lanes = sums[parity][j / kLanes];
            return Complex(lanes[2 * c][j % kLanes], lanes[2 * c + 1][j % kLanes]);
          };
          const std::size_t mirror = static_cast<std::size_t>(rows) - 1 - j;
          spectra[(j * 3 + c) * orders + static_cast<std::size_t>(m)] = part(0) + part(1);
          spectra[(mirror * 3 + c) * orders + static_cast<std::size_t>(m)] = part(0) - part(1);
        }
      }
    }
  });
  return spectra;
}

}  // namespace

SphereGrid::SphereGrid(const Harmonics& harmonics, const std::vector<double>& factors) {
  constexpr double kPointsPerPeriod = 2.5;
  const int lmax = std::min(harmonics.lmax(), static_cast<int>(factors.size()) - 1);
  int columns = 16;
  while (columns < kPointsPerPeriod * lmax) columns *= 2;
  rows_ = columns / 2;
  stride_ = columns + 2 * kMargin;
  values_.resize(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(rows_ + 2 * kMargin));

  const std::vector<Complex> spectra = synthesise_rows(harmonics, factors, lmax, rows_);
  const auto orders = static_cast<std::size_t>(lmax) + 1;
  const Fourier fourier(columns);
  parallel_for(0, static_cast<std::size_t>(rows_), 8, [&](std::size_t begin, std::size_t end) {
    std::vector<Complex> in(static_cast<std::size_t>(columns)), out(in.size());
    for (std::size_t y = begin; y < end; ++y) {
      for (std::size_t c = 0; c < 3; ++c) {
        std::fill(in.begin(), in.end(), Complex(0.0));
        // f = a_0 + 2 Re Σ a_m e^(imφ); a forward transform of the conjugates gives the conjugate.
        for (std::size_t m = 0; m < orders; ++m) {
          in[m] = std::conj(spectra[(y * 3 + c) * orders + m]) * (m == 0 ? 1.0 : 2.0);
        }
        fourier.forward(in, out);
        dvec3* row = values_.data() + (y + kMargin) * static_cast<std::size_t>(stride_) + kMargin;
        for (std::size_t x = 0; x < out.size(); ++x) row[x][static_cast<int>(c)] = out[x].real();
      }
    }
  });
  extend();
}

void SphereGrid::extend() {
  const int columns = 2 * rows_;
  const auto at = [&](int x, int y) -> dvec3& {
    return values_[static_cast<std::size_t>(y + kMargin) * static_cast<std::size_t>(stride_) +
                   static_cast<std::size_t>(x + kMargin)];
  };
  // Beyond a pole the function goes on, half a turn away.
  for (int k = 0; k < kMargin; ++k) {
    for (int x = 0; x < columns; ++x) {
      at(x, -1 - k) = at((x + rows_) % columns, k);
      at(x, rows_ + k) = at((x + rows_) % columns, rows_ - 1 - k);
    }
  }
  for (int y = -kMargin; y < rows_ + kMargin; ++y) {
    for (int k = 0; k < kMargin; ++k) {
      at(-1 - k, y) = at(columns - 1 - k, y);
      at(columns + k, y) = at(k, y);
    }
  }
}

dvec3 SphereGrid::at(dvec3 direction) const {
  const double azimuth = std::atan2(direction.z, direction.x);
  const double polar = std::atan2(std::hypot(direction.x, direction.z), direction.y);
  const double x = (azimuth < 0.0 ? azimuth + 2.0 * kPiD : azimuth) / kPiD * rows_;
  const double y = polar / kPiD * rows_ - 0.5;
  const int left = std::min(static_cast<int>(x), 2 * rows_ - 1);
  const auto top = static_cast<int>(std::floor(y));
  const std::array<double, kTaps> wx = lagrange(x - left), wy = lagrange(y - top);
  dvec3 sum(0.0);
  for (int j = 0; j < kTaps; ++j) {
    const dvec3* row = values_.data() + static_cast<std::size_t>(top + j + 1) * static_cast<std::size_t>(stride_) +
                       static_cast<std::size_t>(left + 1);
    dvec3 line(0.0);
    for (std::size_t i = 0; i < kTaps; ++i) line += row[i] * wx[i];
    sum += line * wy[static_cast<std::size_t>(j)];
  }
  return sum;
}

}  // namespace candela::ibl
