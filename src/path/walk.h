#pragma once

#include "path/integrator.h"
#include "path/medium.h"
#include "path/surface_point.h"

namespace candela::path {

/// How a ray meets the boundary of a body.
struct Crossing {
  int body = 0;  ///< which; 0 = the surface bounds none
  const Medium* inside = nullptr;
  bool is_entering = false;
  /// Nothing happens to light: another body covers this one here, or there is a hole in a blended surface.
  bool is_hidden = false;
  float eta = 1.0f;   ///< index beyond over index before
  vec3 albedo{0.0f};  ///< of scattering inside, where a body is entered
};

/// What a path carries through the scene beside its radiance: where it is, and as what colour.
class Walk {
 public:
  Walk() = default;
  /// A path that begins in bodies. Radiance in matter of index n is n² times what it is in air; a camera has its lens
  /// in air behind a port, and so sees the same there as outside.
  explicit Walk(const MediumStack& start) : media_(start) {
    if (const Medium* medium = start.current()) {
      eta_scale = medium->ior * medium->ior;
      throughput /= eta_scale;
    }
  }

  vec3 throughput{1.0f};
  /// η² of all boundaries so far: radiance rises on the way into dense matter and falls on the way out, which says
  /// nothing about how much a path is worth.
  float eta_scale = 1.0f;

  /// The boundary that `hit` is. A first dispersive one gives the path a wavelength by `u`.
  Crossing find_crossing(const PathContext& context, const Hit& hit, vec3 direction, float u_wavelength);
  /// To the other side.
  void cross(const Crossing& crossing);

  /// Brings the path through the medium it is in to the next surface, by way of any scattering. False when it is
  /// absorbed. `scattered` is set when the direction has changed. The way counts from `start`, on the surface that the
  /// ray begins a little off.
  bool travel(const PathContext& context, vec3 start, Ray& ray, Hit& hit, SobolSampler& sampler, RayCounts& counts,
              bool& scattered);

  bool is_in_body() const { return !media_.empty(); }

  /// What is left of light from a direction on the near (or far) side of a boundary over `distance`.
  vec3 transmittance(const Crossing& crossing, bool is_beyond, float distance) const;

 private:
  float index_of(const Medium* medium) const;

  MediumStack media_;
  float wavelength_nm_ = 0.0f;  ///< 0 = all
};

}  // namespace candela::path
