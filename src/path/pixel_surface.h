#pragma once

#include <optional>
#include <vector>

#include "image/surface_map.h"
#include "math/frame.h"
#include "path/render.h"
#include "shade/lobe_parts.h"

namespace candela::path {

/// What the facets of a base do with light from one direction to another.
struct FacetTerms {
  vec3 half{0, 0, 1};  ///< local
  float d = 0.0f;      ///< of the normal distribution, per steradian
  float g = 0.0f;      ///< masking and shadowing
  vec3 f{0.0f};        ///< Fresnel reflectance at the half vector, of both opaque materials by their weights
};

/// A source without size, or a sun, which is taken for its middle, as it lights a surface.
struct LampTerms {
  int node = -1;            ///< of a punctual light
  int sun = -1;             ///< of the environment
  vec3 direction{0, 1, 0};  ///< towards it, world space
  vec3 wi{0, 0, 1};         ///< the same, local
  float distance = 0.0f;    ///< metres; infinite of what is far away
  vec3 irradiance{0.0f};    ///< on a surface that faces it, were nothing in the way
  vec3 visible{0.0f};       ///< what of it arrives
  FacetTerms facets;        ///< not of directions from below
  shade::LobeParts parts;   ///< f·|cos θi|
  vec3 radiance{0.0f};      ///< what the surface sends to the eye of it
};

/// The surface at the middle of a pixel, and what shading knows of it. Directions are local to the frame of the shading
/// normal unless they are said to be the world's.
struct PixelSurface {
  SurfaceSample where;
  float distance = 0.0f;  ///< from the eye, metres
  bool is_back = false;
  bool is_unlit = false;
  vec3 geometric_normal{0, 0, 1};  ///< world, on the eye's side
  vec3 smooth_normal{0, 0, 1};     ///< world
  Frame frame;                     ///< world from local; n is the shading normal
  vec3 to_eye{0, 0, 1};            ///< world
  vec3 wo{0, 0, 1};
  vec3 emission{0.0f};
  shade::SurfaceParams params{};  ///< after all textures; of members that no lobe of the surface reads, the defaults
  shade::Surface surface{};
  shade::SurfaceShares shares{};  ///< directional albedo of each lobe, seen from the eye
  FacetTerms mirror;              ///< of light that comes from where a mirror would show it
  std::vector<LampTerms> lamps;   ///< the brightest first
};

/// Of facets of the default model; empty where they are a mirror or another model's.
std::optional<FacetTerms> facet_terms(const shade::Surface& surface, vec3 wo, vec3 wi);

/// Throws Error for a pixel outside the picture; counted from its top left corner.
void check_pixel(ivec2 pixel, ivec2 size);

/// None where the middle of the pixel sees no surface. Of the lens its middle. Throws Error for a pixel outside the
/// picture, and as Tracer::render().
std::optional<PixelSurface> find_pixel_surface(const Tracer& tracer, const View& view, ivec2 size, ivec2 pixel);

}  // namespace candela::path
