#pragma once

#include <complex>
#include <vector>

#include "image/image.h"
#include "math/types.h"

namespace candela::ibl {

/// Spherical harmonics of a real RGB function up to a high degree, about the y axis: f = Σ a_lm P̄_lm(y) e^(imφ), P̄
/// orthonormal and without the Condon-Shortley sign. Orders m ≥ 0 alone are kept, a_l,-m being the conjugate.
class Harmonics {
 public:
  explicit Harmonics(int lmax);

  int lmax() const { return lmax_; }
  std::size_t index(int l, int m) const {
    return offset_[static_cast<std::size_t>(m)] + static_cast<std::size_t>(l - m);
  }
  /// Channel c of a_lm.
  std::complex<double>& at(int l, int m, int c) { return values_[index(l, m) * 3 + static_cast<std::size_t>(c)]; }
  std::complex<double> at(int l, int m, int c) const { return values_[index(l, m) * 3 + static_cast<std::size_t>(c)]; }

 private:
  int lmax_;
  std::vector<std::size_t> offset_;
  std::vector<std::complex<double>> values_;
};

/// Projects a panorama whose texels are constant: azimuth exactly, polar angle by two Gauss points per row (one where
/// lmax is so low that this is enough). `azimuth` is that of the left edge.
Harmonics analyse(const Image& map, double azimuth, int lmax);

/// Σ a_lm Y_lm at a unit direction.
dvec3 evaluate(const Harmonics& harmonics, dvec3 direction);

/// A function on the sphere, smooth between the points of a grid. Rows are at polar angles (j + ½) π / rows, columns at
/// azimuths i 2π / columns; columns = 2 rows.
class SphereGrid {
 public:
  /// Σ factor_l a_lm Y_lm up to the lesser of the two degrees; a factor per degree.
  SphereGrid(const Harmonics& harmonics, const std::vector<double>& factors);

  /// By Lagrange's polynomials on 8 × 8 points; the grid has 2½ points or more per period of the highest degree, where
  /// little is left.
  dvec3 at(dvec3 direction) const;

 private:
  void extend();

  int rows_ = 0;
  int stride_ = 0;             ///< of a row in texels, margins included
  std::vector<dvec3> values_;  ///< with margins, so that no lookup wraps
};

}  // namespace candela::ibl
