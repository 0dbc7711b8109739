#pragma once

#include <array>
#include <span>

#include "math/sobol.h"
#include "path/lights.h"
#include "path/render.h"
#include "shade/surface_params.glsl.h"

namespace candela::path {

/// What all paths share.
struct PathContext {
  const Geometry& geometry;
  const Lights& lights;
  int bounces = 8;
  Background background = Background::environment;
  bool background_in_glass = false;  ///< what the camera sees through glass is a transparent background too
  bool sees_lamps = true;
  bool sees_backdrop = true;
  bool has_media = true;           ///< whether any material bounds a body; false leaves out what only bodies need
  MediumStack start{};             ///< the bodies that the eye is in
  bool eye_is_wide = false;        ///< camera rays start at many places, some perhaps in bodies: `start` is none's
  bool sees_shadows = false;       ///< of the scene's ground the eye sees what Ground says; else it is a surface
  bool has_first_surface = false;  ///< PathSample::first is asked for
  bool has_features = false;       ///< and what a denoiser asks for
};

struct RayCounts {
  std::uint64_t camera = 0;
  std::uint64_t bounce = 0;
  std::uint64_t shadow = 0;
};

/// One sample of a pixel.
struct PathSample {
  vec3 radiance{0.0f};
  float alpha = 1.0f;  ///< 0 where the camera ray left the scene and the background is transparent
  vec3 through{0.0f};  ///< what that background is multiplied by: 1 there, less through glass and in shadows on ground
  vec3 feature_albedo{1.0f};  ///< of the first surface that is neither mirror nor clear glass, times what these leave
  vec3 feature_normal{0.0f};  ///< of the same; 0 where the path ends before
  vec3 indirect{0.0f};        ///< of the radiance: what was turned again after its first rough surface
  vec3 seen{0.0f};            ///< of the radiance: what was never reflected or refracted
  std::array<vec3, kLayers.size()> first{};  ///< what layers that have a mean say of the first surface

  vec3& of(Layer layer) { return first[static_cast<std::size_t>(layer)]; }
  const vec3& of(Layer layer) const { return first[static_cast<std::size_t>(layer)]; }
};

struct SurfacePoint;

/// Is told what a path meets, in its order. Of light everything that adds up to PathSample::radiance.
class PathListener {
 public:
  virtual ~PathListener() = default;
  /// A surface that is there; the path ends, passes or turns on it.
  virtual void meet(const Hit& hit, const SurfacePoint& point) = 0;
  virtual void turn(const shade::SurfaceSample& next) = 0;
  /// Within a body, the last time before the next surface.
  virtual void scatter(vec3 position) = 0;
  /// A lamp is looked for from the surface that was met last, and what comes of it.
  virtual void look_for(const LightSample& lamp) = 0;
  virtual void find_lamp(vec3 light) = 0;
  /// Light of the surface that was met last, and from beyond the scene.
  virtual void find_glow(vec3 light) = 0;
  virtual void find_sky(vec3 direction, vec3 light) = 0;
};

class Camera;

/// Sets what camera rays begin in: PathContext::start and eye_is_wide.
void find_start(const Camera& camera, PathContext& context);

/// The camera looks through the backs of single-sided surfaces (light does not): the first hit that it sees.
Hit first_visible_hit(const PathContext& context, const Ray& ray, const Hit& hit, RayCounts& counts);

/// Contrast of what is seen between directions that meet nothing, see EnvironmentLight::contrast.
float background_contrast(const PathContext& context, std::span<const vec3> corners);

/// A ladder of three rungs to read from below; each has the same expectation where it holds.
///
/// The first: surfaces alone, by following the material until a light is met. For scenes without bodies, transparent
/// backgrounds and surfaces at the same place. Sees no punctual light, which has no size.
PathSample trace_path_surfaces(const PathContext& context, Ray ray, Hit hit, SobolSampler& sampler, RayCounts& counts);

/// The second: the same through bodies, sheets and whatever else there is.
PathSample trace_path_minimal(const PathContext& context, Ray ray, Hit hit, SobolSampler& sampler, RayCounts& counts);

/// The third, which renders: it looks for lights as well. Radiance that comes back along a camera ray whose first hit
/// is known. Unbiased; see docs/theory/path-tracing.md.
PathSample trace_path(const PathContext& context, Ray ray, Hit hit, SobolSampler& sampler, RayCounts& counts);

/// The same path, told to a listener.
PathSample trace_heard_path(const PathContext& context, Ray ray, Hit hit, SobolSampler& sampler, RayCounts& counts,
                            PathListener& listener);

}  // namespace candela::path
