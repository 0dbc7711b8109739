#pragma once

#include <vector>

namespace candela::ibl {

enum class Lobe { cosine, ggx, charlie };

/// A lobe about an axis, as a density per solid angle of the cosine to that axis; its integral over the sphere is 1.
///
/// - cosine: max(c, 0) / π, what turns radiance into irradiance / π.
/// - ggx: with N = V = R, as the split sum has it (Karis 2013, "Real Shading in Unreal Engine 4"): D(h) weighted by
///   N·L. h is halfway, so NoH² = (1 + c) / 2, and the lobe depends on c alone.
/// - charlie: the same of the sheen distribution (Estevez & Kulla 2017).
///
/// α = roughness², as in the material.
class Kernel {
 public:
  Kernel(Lobe lobe, double roughness);

  Lobe lobe() const { return lobe_; }
  double alpha() const { return alpha_; }
  /// Radians over which it changes: α, or √α for the ring of charlie.
  double width() const;
  /// Density at a direction whose unit vector is `t` = 1 - cosine away (½ chord²): exact where the cosine is not.
  double operator()(double t) const;
  /// Scale of the GGX form scale · c / (alpha² + slope · t)².
  double scale() const { return scale_; }
  double slope() const { return slope_; }

  /// Legendre coefficients k_0 … k_lmax, k_l = 2π ∫ K(c) P_l(c) dc, by quadrature: what convolution multiplies the
  /// harmonics of degree l by. k_0 = 1.
  std::vector<double> coefficients(int lmax) const;

  /// Degree above which the coefficients of the lobe itself (not of the kink at the horizon) are below about 1e-8.
  int bandwidth() const;

 private:
  double shape(double t) const;
  double tabulated(double t) const;

  Lobe lobe_;
  double alpha_ = 1.0;
  double exponent_ = 1.0;  ///< charlie: 1 / (2α)
  double slope_ = 0.0;     ///< ggx: (1 - α²) / 2
  double scale_ = 1.0;
  std::vector<double> table_;  ///< charlie: shape at even steps of t in [0, 1], because pow is slow
};

}  // namespace candela::ibl
