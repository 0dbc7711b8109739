#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "ibl/kernel.h"
#include "ibl/source.h"
#include "image/cubemap.h"

namespace candela::ibl {

/// How the integral of radiance × lobe is found.
/// - zonal: convolution as a product of spherical harmonics, with the brightest texels summed one by one.
/// - hierarchical: a sum over a tree of texels with their means, centres and variances, each output descending until
///   the second-order error that these tell is below the tolerance.
/// - automatic: zonal where the lobe is wide enough for it to be cheaper, else hierarchical.
/// - fis: filtered importance sampling of a cube with mips, as the common tools have it (Křivánek & Colbert 2008,
///   "Real-time Shading with Filtered Importance Sampling", and its mip bias of one level).
/// - montecarlo: importance sampling of the lobe without mips.
enum class Method { automatic, zonal, hierarchical, fis, montecarlo };

struct PrefilterSettings {
  Method method = Method::automatic;
  int samples = 1024;            ///< fis, montecarlo
  int exact_texels = 512;        ///< zonal: how many of the brightest are summed one by one
  double bandwidth_scale = 1.0;  ///< zonal: more degrees than thought necessary
  double tolerance = 2e-3;       ///< hierarchical: relative error of a value
  int fis_size = 256;            ///< fis: the face of the cube that samples are taken from
  std::uint32_t seed = 0;        ///< montecarlo
};

/// What is known about a source before any lobe is: its harmonics, its brightest texels, its tree, its mips; each is
/// made when the first method needs it. The source must outlive it.
class Prefilter {
 public:
  /// `kernels` are those that will be asked for: they decide to which degree the source is analysed.
  Prefilter(const Source& source, const std::vector<Kernel>& kernels, const PrefilterSettings& settings);
  ~Prefilter();
  Prefilter(const Prefilter&) = delete;
  Prefilter& operator=(const Prefilter&) = delete;

  /// What `automatic` chooses for a kernel; else the method that was asked for.
  Method method_for(const Kernel& kernel) const;
  /// The source convolved with a kernel, at any unit directions and at the middles of the texels of six faces.
  std::vector<dvec3> at(const Kernel& kernel, const std::vector<dvec3>& directions) const;
  CubeFaces faces(const Kernel& kernel, int size) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// Roughness of each of `levels` levels of a prefiltered cube.
/// - balanced: α halves as the texels do, 2^-(levels - 1 - level), so that every level resolves its lobe alike; level 0
///   is a mirror.
/// - linear: level / (levels - 1), the Khronos glTF viewers'.
/// - filament: level / (levels - 1) = r (2 - r), Filament's.
enum class Mapping { balanced, linear, filament };
std::vector<double> level_roughness(Mapping mapping, int levels);

}  // namespace candela::ibl
