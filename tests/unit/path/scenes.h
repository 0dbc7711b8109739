#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "path/render.h"
#include "support/statistics.h"

/// Small scenes in code, and what tests ask of their pictures.
namespace candela::test {

// ----- shapes; front faces look outwards (to cross(a, b) for a quad)

Primitive quad(vec3 corner, vec3 a, vec3 b);
/// Horizontal, looking up, `half` metres to each side of `center`.
Primitive plane(vec3 center, float half);
Primitive box(vec3 lower, vec3 upper);
/// An octahedron divided `levels` times; flat: every facet with its own normal.
Primitive sphere(vec3 center, float radius, int levels, bool flat);
/// Faces and normals the other way round.
Primitive turned_inside_out(Primitive primitive);
Primitive moved(Primitive primitive, vec3 offset);

// ----- materials

Material matte(vec3 albedo);  ///< Lambertian and nothing else
Material metal(vec3 color, float roughness);
Material plastic(vec3 color, float roughness);
Material lamp(vec3 emission);  ///< reflects nothing
Material unlit(vec3 color);

Light point_light(vec3 color, float intensity);
Light spot_light(vec3 color, float intensity, float inner_cone, float outer_cone);
Light sunlight(vec3 color, float intensity);

mat4 translation(vec3 offset);
mat4 scaling(vec3 factors);
mat4 rotation(vec3 axis, float angle);
/// Places a light: its -z looks from `eye` to `target`.
mat4 aimed(vec3 eye, vec3 target);

/// Collects what makes up a scene.
class SceneBuilder {
 public:
  int add_material(const Material& material);
  int add_mesh(Primitive primitive, int material);
  int add_node(int mesh, const mat4& world = mat4(1.0f));
  /// A mesh with one primitive and a node of its own; returns the node.
  int add(Primitive primitive, const Material& material, const mat4& world = mat4(1.0f));
  int add_light(const Light& light, const mat4& world);
  /// RGBA texels, 8 bits; returns the texture.
  int add_texture(int width, int height, const std::vector<std::uint8_t>& rgba, Filter filter = Filter::linear,
                  Wrap wrap = Wrap::repeat);
  int add_texture_16(int width, int height, const std::vector<std::uint16_t>& rgba, Filter filter, Wrap wrap);

  /// Validated.
  Scene build() const;
  Scene& scene() { return scene_; }

 private:
  Scene scene_;
};

TextureSlot slot(int texture, int uv_set = 0);

// ----- environments

Environment constant_environment(vec3 radiance);
Environment dark_environment();
/// `radiance(direction)` at the centre of every texel.
Environment mapped_environment(int width, int height, const std::function<vec3(vec3)>& radiance);

// ----- pictures

/// Looks along -y on y = 0 from `height`; the picture shows x, z in [-half, half], x to the right, -z up.
View from_above(float height, float half);

/// Square picture, no layers; `bounces` as path::Settings has it.
path::Settings settings(int size, int samples, int bounces);
/// The same with every sample in the middle of its pixel.
path::Settings centred(int size, int samples, int bounces);

/// Renders, and fails the test when a sample was not finite.
Film shoot(const Scene& scene, const Environment& environment, const View& view, const path::Settings& settings,
           const shade::ShadingModel& shading = shade::shading_model_candela());

struct Region {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  ///< x1 and y1 are outside
};
dvec3 mean_of(const Image& image);
dvec3 mean_of(const Image& image, const Region& region);
double mean_luminance(const Image& image);
double largest_difference(const Image& a, const Image& b);
bool is_finite_and_not_negative(const Image& image);
bool films_are_identical(const Film& a, const Film& b);
Image mirrored_left_to_right(const Image& image);

/// Statistics of `value(seed)` over independent renderings.
Moments over_seeds(int runs, const std::function<double(std::uint32_t seed)>& value);

/// Mean of every colour channel over independent renderings.
std::array<Moments, 3> mean_over_seeds(int runs, const Scene& scene, const Environment& environment, const View& view,
                                       path::Settings settings);

}  // namespace candela::test
