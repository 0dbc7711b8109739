#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "image/image.h"
#include "math/types.h"

/// The scene as plain data, as both renderers read it: metres, radians, right-handed, y up. Objects name each other by
/// index (-1 = none). Whoever builds a Scene promises what `validate` (below) checks; renderers rely on it.
namespace candela {

enum class Wrap { repeat, clamp_to_edge, mirrored_repeat };
enum class Filter { nearest, linear };

struct Texture {
  std::string name;
  int image = -1;
  Wrap wrap_u = Wrap::repeat;
  Wrap wrap_v = Wrap::repeat;
  Filter filter = Filter::linear;  ///< magnification; minification is by supersampling (path) or mips (raster)
};

/// A texture as one slot of a material uses it. uv' = transform * (uv, 1), columns of a 2×3 matrix
/// (KHR_texture_transform).
struct TextureSlot {
  int texture = -1;
  int uv_set = 0;  ///< 0 or 1
  std::array<vec2, 3> transform{vec2(1, 0), vec2(0, 1), vec2(0, 0)};

  explicit operator bool() const { return texture >= 0; }
  vec2 apply(vec2 uv) const { return transform[0] * uv.x + transform[1] * uv.y + transform[2]; }
};

enum class AlphaMode { opaque, mask, blend };

/// glTF 2.0 metallic-roughness with KHR_materials_ior, _specular, _emissive_strength, _unlit. Factors are linear.
struct Material {
  std::string name;
  vec3 base_color{1.0f};
  float opacity = 1.0f;  ///< base colour alpha
  float metallic = 1.0f;
  float roughness = 1.0f;
  float ior = 1.5f;  ///< 0 = the specification's "F = 1" compatibility mode
  float specular = 1.0f;
  vec3 specular_color{1.0f};
  vec3 emission{0.0f};  ///< emissiveFactor × emissiveStrength, cd/m²
  float normal_scale = 1.0f;
  float occlusion_strength = 1.0f;
  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha_cutoff = 0.5f;
  bool double_sided = false;
  bool unlit = false;

  TextureSlot base_color_texture;          ///< sRGB, alpha linear
  TextureSlot metallic_roughness_texture;  ///< G roughness, B metallic
  TextureSlot normal_texture;
  TextureSlot occlusion_texture;       ///< R; the path tracer computes occlusion and does not read it
  TextureSlot emissive_texture;        ///< sRGB
  TextureSlot specular_texture;        ///< A
  TextureSlot specular_color_texture;  ///< sRGB
};

/// Triangles with one material. All vertex arrays have the same length or, where optional, are empty.
struct Primitive {
  std::vector<vec3> positions;
  std::vector<vec3> normals;   ///< never empty after loading: generated flat when the file has none
  std::vector<vec4> tangents;  ///< xyz and handedness; empty unless the material has a normal texture
  std::array<std::vector<vec2>, 2> uvs;
  std::vector<vec4> colors;  ///< linear RGBA, multiplies the base colour; may be empty
  std::vector<uvec3> triangles;
  int material = 0;
};

struct Mesh {
  std::string name;
  std::vector<Primitive> primitives;
};

struct PerspectiveCamera {
  float yfov = 0.7854f;               ///< full vertical angle, radians
  std::optional<float> aspect_ratio;  ///< the file's wish; the picture's own size wins
};
struct OrthographicCamera {
  float xmag = 1.0f;  ///< half width, metres
  float ymag = 1.0f;  ///< half height, metres
};
struct Camera {
  std::string name;
  std::variant<PerspectiveCamera, OrthographicCamera> projection;
  float f_number = 0.0f;        ///< of a 24 mm high sensor, perspective only; 0 = pinhole. glTF files leave it 0
  float focus_distance = 0.0f;  ///< metres along -z; 0 = the middle of the scene
};

enum class LightType { point, spot, directional };

/// KHR_lights_punctual; shines along the node's -z.
struct Light {
  std::string name;
  LightType type = LightType::point;
  vec3 color{1.0f};
  float intensity = 1.0f;  ///< cd for point and spot, lux for directional
  float range = kInfinity;
  float inner_cone = 0.0f;
  float outer_cone = 0.785398f;
};

struct Node {
  std::string name;
  int parent = -1;
  mat4 parent_from_node{1.0f};
  mat4 world_from_node{1.0f};
  int mesh = -1;
  int camera = -1;
  int light = -1;
};

/// A uniformly bright disc infinitely far away, e.g. the sun.
struct SunDisc {
  vec3 direction{0, 1, 0};  ///< towards it, unit, before Environment::rotation
  float angular_radius = 0.00465f;
  vec3 radiance{0.0f};
};

/// Light from infinitely far away. Direction d (after turning by -rotation about +y) looks up the map at
/// u = 0.5 + atan2(d.z, d.x) / 2π, v = acos(d.y) / π from the top row, bilinear, and adds the suns.
struct Environment {
  std::string name = "none";
  std::shared_ptr<const Image> map;  ///< RGB, equirectangular; null = black (but see `constant`)
  /// What the camera sees instead of the map when it looks past the scene (same size as the map): a studio's backdrop
  /// without its lamps. Null = the map.
  std::shared_ptr<const Image> backdrop = {};
  vec3 constant{0.0f};  ///< added everywhere
  std::vector<SunDisc> suns;
  float intensity = 1.0f;
  float rotation = 0.0f;  ///< about +y, counter-clockwise seen from above
  /// The exposure that its light is made for (factor, as DevelopSettings::exposure); empty = meter the picture.
  std::optional<float> exposure = {};
};

struct Scene {
  std::string name;
  std::vector<Node> nodes;
  std::vector<Mesh> meshes;
  std::vector<Material> materials;  ///< never empty: Primitive::material is always valid
  std::vector<Texture> textures;
  std::vector<std::shared_ptr<const TextureImage>> images;  ///< never null
  std::vector<Camera> cameras;
  std::vector<Light> lights;
  /// What a built-in scene wishes to be lit by and seen through; files leave them empty.
  std::optional<std::string> preferred_environment;
  std::optional<float> preferred_exposure;  ///< factor, as DevelopSettings::exposure
};

/// Recomputes world_from_node from parent_from_node; parents may come after children. Throws Error on a cycle.
void update_world_transforms(Scene& scene);

/// World-space bounds of everything that has a mesh; empty when there is none.
Box3 world_bounds(const Scene& scene);

/// Throws Error when an index is out of range, an array length disagrees or a number is not finite.
void validate(const Scene& scene);

}  // namespace candela
