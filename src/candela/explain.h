#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "candela/shot.h"
#include "path/pixel_paths.h"
#include "path/pixel_surface.h"

/// Every term of a pixel: what is there, what its material is after all textures, what each lobe and each light has in
/// it, what the real-time frame reads and shows, and which paths the truth is made of.
namespace candela {

struct ExplainSettings {
  std::vector<ivec2> pixels;  ///< columns and rows, from the top left corner
  int samples = 1024;         ///< of the path tracer, in each of them
  std::size_t paths = 3;      ///< how many of the brightest are kept
  bool has_frame = true;      ///< the rasterizer's terms too
};

/// A property of the material: as the file has it, and after textures, vertex colours and the node's colour.
struct PropertyValue {
  std::string_view name;
  int size = 1;  ///< 1 or 3
  vec3 factor{0.0f};
  vec3 value{0.0f};  ///< equal to the factor where nothing changes it
  bool has_texture = false;
};

/// A lookup of light from far away that is prepared for a lobe, and what the lobe makes of it, were nothing in the way.
struct FarLookup {
  std::string_view lobe;
  vec3 direction{0, 1, 0};  ///< world space
  float alpha = 0.0f;
  float level = 0.0f;   ///< of the prefiltered cube; the first is a mirror's
  vec3 radiance{0.0f};  ///< what is read there; of diffuse lobes irradiance / π
  vec3 share{0.0f};     ///< of the lobe
  vec3 light{0.0f};     ///< share × radiance, less what points into the surface
};

/// What stands in for the environment in the real-time frame.
struct FarTerms {
  int levels = 0;
  std::vector<FarLookup> lookups;
  vec3 irradiance{0.0f};            ///< at the shading normal, as the frame has it
  vec3 harmonics_irradiance{0.0f};  ///< by nine spherical harmonics
  std::vector<dvec3> harmonics;     ///< of irradiance: (l, m) stands at l (l + 1) + m
};

/// A part of the real-time frame.
struct FrameTerm {
  raster::Quantity part = raster::Quantity::light;
  int light = -1;  ///< of Quantity::one_light: the number that the frame gives it, the strongest 0
  vec3 radiance{0.0f};
};

struct FrameTerms {
  vec3 radiance{0.0f};
  std::vector<FrameTerm> terms;  ///< parts of it, black ones left out
  std::optional<FarTerms> far;   ///< none with probes, without a surface and under no light
};

struct PixelExplanation {
  ivec2 pixel{0};
  std::optional<path::PixelSurface> surface;  ///< none: the middle of the pixel sees none
  std::vector<PropertyValue> properties;      ///< those that are not at their default
  path::PixelEstimate truth;
  std::optional<FrameTerms> frame;
};

struct Explanation {
  std::shared_ptr<const Scene> scene;
  ivec2 size{0};
  View view;
  std::vector<PixelExplanation> pixels;
  Film picture;  ///< the frame; without it a path tracer's sketch
  DevelopSettings develop;
};

/// A lobe in the plane of incidence: the luminance of f·|cos θi| for light from each direction. Angles are to the
/// normal in degrees, -90 to 90; the eye is at a negative one. Of light from below they are to the normal's opposite.
struct LobeCut {
  std::string_view lobe;
  bool is_below = false;
  std::vector<dvec2> points;
};
/// Those that are not black; none of an unlit surface, nor what is a delta.
std::vector<LobeCut> cut_lobes(const path::PixelSurface& surface);

/// The share of a standard error that is added to both sides for 95 % confidence.
inline constexpr float kConfidence95 = 1.96f;

/// One pixel without the frame: of a picture that the tracer would make of a view with these settings, with all of
/// their samples. Throws as path::trace_pixel().
PixelExplanation explain_pixel(const path::Tracer& tracer, const View& view, const path::Settings& settings,
                               ivec2 pixel, std::size_t paths, const Job& job = {});

/// Of a shot with one picture. Both engines see the same; the engine of the shot does not count. It has no other
/// background than the environment, no ground, no shutter, no parts. Throws Error as Take does and for a pixel outside
/// the picture; Interrupted after a stop.
Explanation explain(const Shot& shot, const ExplainSettings& settings, const Job& job = {});

}  // namespace candela
