#pragma once

#include <array>
#include <memory>
#include <vector>

#include "candela/gap.h"
#include "path/direct_light.h"

/// What the files of gap.h share.
namespace candela {

inline constexpr std::size_t kCauses = kGapCauses.size();
/// The two independent halves of what is traced.
inline constexpr std::size_t kHalves = 2;

/// Of each pixel the frame less the truth, of either half, and of that what each cause adds.
using GapErrors = std::array<std::vector<vec3>, kHalves>;
using GapParts = std::array<std::vector<std::array<vec3, kCauses>>, kHalves>;

inline vec3 pixel_of(const Image& image, std::size_t i) {
  const float* p = image.pixels.data() + i * static_cast<std::size_t>(image.channels);
  return {p[0], p[1], p[2]};
}

inline double dot(vec3 a, vec3 b) { return glm::dot(dvec3(a), dvec3(b)); }

/// A pixel's weight in squared errors, and whether causes of its material's kind are told apart in it.
struct GapPixel {
  double weight = 0.0;
  GapCause kind = GapCause::rest;  ///< glass or scattering: all its error is that; else rest
  bool is_plain() const { return kind == GapCause::rest; }
};

/// The shot of the truth beside which a frame is seen. Throws Error for what only one of them has; `what` begins it:
/// "engines are compared".
Shot truth_shot(Shot shot, const std::string& what);
/// The same of a comparison.
Shot comparable(Shot shot, const GapSettings& settings);

/// One half of the truth, with Layer::material. Throws Interrupted where it is not whole.
Film trace_half(const path::Tracer& tracer, const View& view, path::Settings settings, const Job& job);

/// With weights, all plain.
std::vector<GapPixel> weighted_pixels(const Image& truth, float exposure);
/// The material at each pixel's centre, -1 where there is none, of a film with Layer::material.
std::vector<int> materials_seen(const Scene& scene, const Film& film);
/// Fills in the numbers of the whole and of each material. `parts` is empty where causes are not known.
void find_numbers(const Scene& scene, const std::vector<GapPixel>& pixels, const std::vector<int>& materials,
                  const GapErrors& errors, const GapParts& parts, ViewGap& gap);

/// The means of many frames that show parts of the light.
struct DrawnParts {
  Image many;         ///< all light
  Image ambient;      ///< from far away, or of probes
  Image open;         ///< the same without occlusion; empty where there is none
  Image direct;       ///< from lamps and glowing surfaces
  Image unshadowed;   ///< the same without shadow maps
  Image lamps_alone;  ///< that without glowing surfaces; empty where only one of the two kinds is there

  const Image& without_occlusion() const { return open.empty() ? ambient : open; }
};

/// What a comparison is made of.
struct GapScene {
  std::shared_ptr<const Scene> scene;
  const Environment& environment;
  const Shot& shot;
  View view;
  const path::Tracer& tracer;
};

/// Makes a picture by the rasterizer of that scene with these settings.
using DrawFrames = std::function<Image(const raster::Settings& settings)>;

/// Mistakes that would explain what is wrong with light that comes straight from its source, were nothing in its way;
/// those alone that explain about as much as the best.
std::vector<GapSuspect> find_suspects(const GapScene& of, const std::vector<GapPixel>& pixels, const DrawnParts& drawn,
                                      const path::DirectLight& direct, const raster::Settings& settings,
                                      const DrawFrames& draw, const Job& job);

}  // namespace candela
