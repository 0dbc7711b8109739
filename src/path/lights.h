#pragma once

#include <array>
#include <memory>

#include "path/environment_light.h"
#include "path/geometry.h"
#include "path/light_tree.h"
#include "scene/lamp.h"
#include "shade/lights.glsl.h"

namespace candela::path {

/// One direction that light arrives from at a point, chosen among all lights.
struct LightSample {
  vec3 direction{0, 1, 0};
  float distance = kInfinity;
  vec3 target{0.0f};    ///< where a shadow ray ends when `distance` is finite: the lamp, or just before its surface
  vec3 radiance{0.0f};  ///< of a delta light: irradiance on a surface that faces it; of the map: see Lights::radiance
  /// Per solid angle, with the chance of this light and times LightChances::samples; of a delta light without the solid
  /// angle; 0 = none.
  float pdf = 0.0f;
  bool is_delta = false;
  float mis_power = 1.0f;  ///< exponent of the heuristic for this kind of light
  bool is_map = false;     ///< `footprint` holds where its radiance stands
  EnvironmentLight::Footprint footprint;

  /// The map or a sun.
  bool is_environment() const { return distance == kInfinity && !is_delta; }
};

using shade::mis_weight;

/// Exponents: the environment's density is compensated for the balance heuristic, the others do better with the power
/// one.
inline constexpr float kEnvironmentMisPower = 1.0f;
inline constexpr float kAreaMisPower = 2.0f;

/// How likely each source is chosen at one point of the scene, and each part of the tree.
struct LightChances {
  static constexpr std::size_t kMost = 32;
  LightReceiver receiver{};
  std::array<float, kMost>
      pmf;               ///< one per source; with those of the tree sum 1, or all 0 where no light can come from
  shade::LightCut tree;  ///< `shares` are pmfs here
  /// How many lights the receiver samples. Densities are those of all together, so that their sum is the estimate.
  int samples = 1;

  /// What sample `i` chooses its light by, and its point on that.
  float choice(int i, float u) const { return shade::light_stratum(i, samples, u); }
  static vec2 place(int i, vec2 u) { return shade::light_place(i, u); }

  LightChances() {}  // NOLINT(modernize-use-equals-default): the arrays are left as they are
};

/// Every light in the scene, in sources: the map, a sun, a punctual light, the emissive triangles of one primitive. A
/// source is chosen by an estimate of its irradiance at the point in question (its power over the squared distance), a
/// triangle of it by power. Where these are too many, or the triangles, all that stand at a place are in a tree.
class Lights {
 public:
  /// Numbers the emissive triangles in `geometry`. `scene` must outlive this.
  Lights(const Scene& scene, std::shared_ptr<const PreparedEnvironment> environment, Geometry& geometry);

  bool can_sample() const { return !sources_.empty() || !tree_.empty(); }
  /// Whether some surface glows.
  bool has_glowing() const { return !triangles_.empty(); }
  /// `is_seen`: the receiver is what the picture shows, and not only what lights that.
  void find_chances(const LightReceiver& receiver, bool is_seen, LightChances& chances) const;
  /// One of chances.samples for their receiver.
  LightSample sample(const LightChances& chances, float u_choice, vec2 u) const;
  /// Starts the memory access that sample(…, u) is likely to wait for.
  void prefetch(vec2 u) const {
    if (environment_.can_sample()) environment_.prefetch_sample(u);
  }
  /// Irradiance of an upward surface there that the scene does not keep light from: what is far away, and punctual
  /// lamps. Only with a ground.
  vec3 unhindered_irradiance(vec3 position) const;
  /// Radiance of a sample. The map's is read here, after the shadow ray, and has had that long to arrive.
  vec3 radiance(const LightSample& sample) const {
    return sample.is_map ? environment_.read(sample.footprint).radiance : sample.radiance;
  }

  /// What a ray sees that hits nothing. `footprint` is environment().locate(direction).
  vec3 escaped_radiance(vec3 direction, const EnvironmentLight::Footprint& footprint) const {
    return environment_.radiance(direction, footprint);
  }
  vec3 escaped_radiance(vec3 direction) const { return escaped_radiance(direction, environment_.locate(direction)); }
  /// The same for a direction that the material sampled with density `bsdf_pdf` > 0 where the lights had these chances:
  /// each part is weighted against sample().
  vec3 escaped_radiance(vec3 direction, const EnvironmentLight::Footprint& footprint, float bsdf_pdf,
                        const LightChances& chances) const {
    return weighted_map(footprint, bsdf_pdf, chances) + weighted_suns(direction, bsdf_pdf, chances);
  }
  /// Its parts.
  vec3 weighted_map(const EnvironmentLight::Footprint& footprint, float bsdf_pdf, const LightChances& chances) const;
  vec3 weighted_suns(vec3 direction, float bsdf_pdf, const LightChances& chances) const;

  /// Density of sample() for the point of an emissive triangle at `distance` seen under `cos_light`; 0 when never
  /// sampled.
  float triangle_pdf(int light, const LightChances& chances, float distance, float cos_light) const;

  const EnvironmentLight& environment() const { return environment_; }

 private:
  struct TriangleLight {
    std::int32_t placement = -1;
    std::uint32_t triangle = 0;
    float area = 0.0f;
    std::uint32_t source = 0;  ///< in the tree: its rank
  };
  struct PunctualLight : PlacedLamp {
    float power = 0.0f;  ///< lumens; of a directional light lux
  };
  enum class SourceKind { map, sun, punctual, directional, many };
  struct Source {
    SourceKind kind = SourceKind::many;
    /// Sun or punctual light; of `many` the first triangle; of `directional`, all of them, nothing.
    std::size_t first = 0;
    float strength = 0.0f;  ///< irradiance of what is far away, power / 4π of what is near
    vec3 center{0.0f};
    float least_distance2 = 0.0f;
    Distribution1D choice = {};  ///< of `many` and `directional`: by power
  };

  PunctualLight place(const Scene& scene, const Node& node) const;
  void add_punctual(const Scene& scene);
  void add_triangles(Geometry& geometry);
  void make_sources();
  Source triangle_source(std::size_t first, std::size_t count) const;
  bool triangles_matter() const;
  void make_directional_sources();
  void make_tree();
  LightBounds bounds_of(const PunctualLight& light) const;
  LightBounds bounds_of(const TriangleLight& light, float power) const;
  float irradiance(const Source& source, const LightReceiver& receiver) const;
  float irradiance(const PunctualLight& light, const LightReceiver& receiver) const;
  /// Of a punctual lamp of the tree that is alone in its leaf.
  float leaf_irradiance(std::uint32_t lamp, const LightReceiver& receiver) const {
    return irradiance(punctual_[tree_lights_[lamp]], receiver);
  }
  LightSample sample_source(const Source& source, vec3 position, float u_choice, vec2 u) const;
  LightSample sample_tree(const LightChances& chances, float u_choice, vec2 u) const;
  LightSample sample_environment(vec2 u) const;
  LightSample sample_sun(const EnvironmentLight::Sun& sun, vec2 u) const;
  LightSample sample_punctual(const PunctualLight& light, vec3 position) const;
  LightSample sample_triangle(const TriangleLight& light, vec3 position, vec2 u) const;

  const Geometry& geometry_;
  std::shared_ptr<const PreparedEnvironment> prepared_;
  const EnvironmentLight& environment_;  ///< of prepared_
  vec3 from_above_{0.0f};                ///< irradiance by the environment of a ground
  std::vector<PunctualLight> punctual_;
  std::vector<TriangleLight> triangles_;
  std::vector<float> triangle_powers_;
  std::vector<Source> sources_;             ///< the map (if it can be sampled), the suns, then the others
  LightTree tree_;                          ///< of all that stand at a place, where they are too many for sources
  std::vector<std::uint32_t> tree_lights_;  ///< its lamps, in the order punctual lights, triangles
};

}  // namespace candela::path
