#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "shade/surface.glsl.h"

// What must be true of a BSDF, measured: each law takes any functions that claim to be one and returns numbers. Who
// asks decides how much is too much; tests ask about the real surface, which must hold, and about mutants, which must
// not.

namespace candela::laws {

/// A BSDF seen from one direction: the contract of shade/surface.glsl.h at a fixed wo.
struct Closure {
  std::function<shade::SurfaceEval(shade::vec3 wi)> eval;
  std::function<shade::SurfaceSample(shade::vec3 u)> draw;
};

struct Bsdf {
  std::function<Closure(shade::vec3 wo)> seen_from;
  /// The same boundary seen from the other side, in the frame that is mirrored (z to -z).
  std::function<Closure(shade::vec3 wo)> seen_from_behind;
  /// Directions near which it may be narrow, for quadrature.
  std::function<std::vector<shade::vec3>(shade::vec3 wo)> peaks;
  double eta = 1.0;  ///< n on the far side / n on the near side, of light that is bent
};

/// What the renderers compile.
Bsdf real_bsdf(const shade::SurfaceParams& params);

/// The surface behind: the same layers, the body's index inverted.
shade::SurfaceParams params_from_behind(shade::SurfaceParams params);

shade::vec3 direction(float cos_theta, float phi);
/// From the normal to nearly grazing, off the coordinate axes.
std::vector<shade::vec3> view_directions();

/// Roberts 2018: the additive recurrence in three dimensions, whose points fill the cube evenly.
shade::vec3 lattice_point(int i);

/// Directional albedo: what a furnace of radiance 1 sends back along wo, by quadrature over the whole sphere plus delta
/// lobes. Behind a bent boundary the furnace has radiance η². w is the integral of the pdf, without deltas.
glm::dvec4 furnace(const Bsdf& bsdf, shade::vec3 wo, double tolerance = 2e-6);

/// Lowest and highest albedo of any channel over the viewing directions.
struct FurnaceRange {
  double least = 1.0;
  double most = 1.0;
};
FurnaceRange furnace_range(const Bsdf& bsdf, double tolerance = 2e-6);

/// Largest relative difference of f(wo, wi) and f(wi, wo), on both sides: light that is bent obeys f(wo, wi) η² = f(wi,
/// wo). Differences of less than a thousandth of 1/π count as against that.
double reciprocity_error(const Bsdf& bsdf);
/// What single precision near the horizon leaves of it; the half vector of light that is bent cancels more digits.
constexpr double reciprocity_slack(bool is_bent) { return is_bent ? 1e-3 : 1e-5; }

/// Values, densities and weights that are not finite or negative, directions that are not unit, samples that leave on
/// the horizon: how many of how many, down to cosines of 1e-4 and at the corners of the random numbers, and the first.
struct Flaws {
  int count = 0;
  int looked_at = 0;
  std::string first;
};
Flaws flaws(const Bsdf& bsdf);

/// All of it.
struct Measurement {
  double reciprocity = 0.0;
  FurnaceRange furnace;
  /// Largest |∫ pdf + P(delta) + P(no sample) - 1|; the chances are shares of a lattice of random numbers, good to
  /// 1e-3.
  double pdf = 0.0;
  Flaws flaws;
};
Measurement measure(const Bsdf& bsdf, double tolerance = 2e-6);

/// The delta lobes at wo: each once, by scanning the choice of the lobe.
struct DeltaLobe {
  shade::vec3 wi;
  shade::vec3 value;  ///< reflectance: weight · pdf
  float pdf;
};
std::vector<DeltaLobe> delta_lobes(const Closure& closure);

}  // namespace candela::laws
