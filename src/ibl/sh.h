#pragma once

#include <array>
#include <vector>

#include "ibl/source.h"

namespace candela::ibl {

constexpr int kMostShOrder = 8;

/// Real spherical harmonics of RGB to degree `order`: coefficient (l, m) stands at l (l + 1) + m. Orthonormal, without
/// the Condon-Shortley sign, about the axes of the world: Y_00 = ½√(1/π), Y_1,-1 ∝ y, Y_10 ∝ z, Y_11 ∝ x (Ramamoorthi &
/// Hanrahan 2001, "An Efficient Representation for Irradiance Environment Maps", eq. 3).
struct Sh {
  int order = 2;
  std::vector<dvec3> coefficients;  ///< (order + 1)²
};

/// Values of all (order + 1)² harmonics at a unit direction.
std::vector<double> sh_basis(int order, dvec3 direction);
dvec3 sh_evaluate(const Sh& sh, dvec3 direction);

/// Radiance projected with every texel's exact solid angle, order 0 to kMostShOrder.
Sh sh_project(const Source& source, int order);

/// The factor of degree l that turns radiance into irradiance: π, 2π/3, π/4, 0, -π/24, 0, … (Ramamoorthi & Hanrahan
/// 2001, eq. 8 and 9).
double cosine_factor(int l);
/// Irradiance from radiance: each degree times cosine_factor.
Sh sh_irradiance(Sh radiance);

enum class Window { none, hann, lanczos, automatic };
/// Damps degree l: hann ½ (1 + cos πl/w), lanczos sin(πl/w) / (πl/w), both 0 from w on; none is 1.
double window_factor(Window window, double width, int l);
/// Each degree times its window_factor; not for `automatic`.
Sh sh_damped(Sh sh, Window window, double width);

/// `automatic` is the widest Lanczos window that leaves the luminance nowhere negative (Sloan 2017, "Deringing
/// Spherical Harmonics"); `width` receives what was used, 0 for none. The other windows have width order + 1.
Sh sh_window(const Sh& sh, Window window, double* width = nullptr);

}  // namespace candela::ibl
