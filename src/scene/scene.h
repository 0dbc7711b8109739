#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "image/image.h"
#include "math/types.h"
#include "scene/ies_profile.h"
#include "scene/material.h"

/// The scene as plain data, as both renderers read it: metres, radians, right-handed, y up. Objects name each other by
/// index (-1 = none). Whoever builds a Scene promises what `validate` (below) checks; renderers rely on it.
///
/// A scene leaves out what its file does not show, and adds nodes of its own, so its indices are not the file's. What
/// people and other programs see are the file's: `file_index` holds them, -1 for what was made in memory, which is
/// known by its own place (see number_of). Several objects may share one: the instances of a node, the poses of a mesh.
namespace candela {

enum class Wrap { repeat, clamp_to_edge, mirrored_repeat };
enum class Filter { nearest, linear };

struct Texture {
  std::string name;
  int image = -1;
  Wrap wrap_u = Wrap::repeat;
  Wrap wrap_v = Wrap::repeat;
  Filter filter = Filter::linear;  ///< magnification; minification is by supersampling (path) or mips (raster)
  int file_index = -1;

  bool operator==(const Texture&) const = default;
};

/// Texture coordinates by the number of their set, TEXCOORD_n. A set that is not there reads as empty.
class UvSets {
 public:
  const std::vector<vec2>& operator[](std::size_t set) const {
    static const std::vector<vec2> kNone;
    const auto found = sets_.find(set);
    return found != sets_.end() ? found->second : kNone;
  }
  std::vector<vec2>& operator[](std::size_t set) { return sets_[set]; }
  /// Pairs of number and coordinates, ascending.
  auto begin() const { return sets_.begin(); }
  auto end() const { return sets_.end(); }
  auto begin() { return sets_.begin(); }
  auto end() { return sets_.end(); }

 private:
  std::map<std::size_t, std::vector<vec2>> sets_;
};

/// Triangles with one material. All vertex arrays have the same length or, where optional, are empty.
struct Primitive {
  std::vector<vec3> positions;
  std::vector<vec3> normals;  ///< never empty after loading: generated flat when the file has none
  std::vector<vec4>
      tangents;  ///< xyz and handedness; empty unless the material has anisotropy or a normal texture, also of the coat
  UvSets uvs;
  std::vector<vec4> colors;  ///< linear RGBA, multiplies the base colour; may be empty
  std::vector<uvec3> triangles;
  int material = 0;
};

struct Mesh {
  std::string name;
  std::vector<Primitive> primitives;
  int file_index = -1;
  /// Meshes that share one have equal primitives, so that what was made of them may serve again. Null = nothing is
  /// known; who changes a mesh that has one takes it away.
  std::shared_ptr<const void> identity = nullptr;
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
  float f_number = 0.0f;        ///< perspective only; 0 = pinhole
  float focal_length = 0.0f;    ///< metres; 0 = that of a 24 mm high sensor
  float focus_distance = 0.0f;  ///< metres along -z; 0 = the middle of the scene
  float near_plane = 0.0f;      ///< metres along -z: what is nearer it does not see
  float far_plane = kInfinity;  ///< nor what is farther
  int file_index = -1;
};

enum class LightType { point, spot, directional };

/// How a point or spot fades with distance; the numbers are shade's kFalloff constants.
enum class Falloff { inverse_square = 0, gltf = 1, ue4 = 2, polynomial = 3 };

/// KHR_lights_punctual and EXT_lights_ies; shines along the node's -z.
struct Light {
  std::string name;
  LightType type = LightType::point;
  vec3 color{1.0f};
  float intensity = 1.0f;   ///< cd for point and spot, lux for directional; with a profile its factor
  float range = kInfinity;  ///< where the windows of Falloff::gltf and ue4 close
  float inner_cone = 0.0f;  ///< of a spot
  float outer_cone = 0.785398f;
  Falloff falloff = Falloff::gltf;
  vec3 polynomial{1, 0, 0};  ///< of Falloff::polynomial: 1 / (x d² + y d + z)
  int ies = -1;              ///< of a point: which profile its intensity varies by
  int file_index = -1;       ///< in KHR_lights_punctual; of EXT_lights_ies the profile's there
};

struct Node {
  std::string name;
  int parent = -1;
  mat4 parent_from_node{1.0f};
  mat4 world_from_node{1.0f};
  int mesh = -1;
  int camera = -1;
  int light = -1;
  int file_index = -1;
  vec4 color{1.0f};        ///< linear RGBA within 0 … 1, multiplies the base colour of its mesh as vertex colours do
  bool is_hidden = false;  ///< KHR_node_visibility: holds neither mesh nor light, whatever the file's node does
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

/// Light from infinitely far away that a file brings along (EXT_lights_image_based).
struct ImageLight {
  Environment environment;  ///< without a map where images are not decoded
  int size = 0;             ///< texels along a face of its cube
  int levels = 0;           ///< of the cube in the file; the first, which is not filtered, is read
  int file_index = -1;
};

/// A level, endless ground below what a picture is of. It is matte where the scene's own light falls on it. Who looks
/// at it does not see it, but what stands behind: the background, times the share of light from far away and from
/// punctual lamps that the scene leaves to the ground at that place, and with the light that the scene adds.
struct Ground {
  float height = 0.0f;  ///< y
  vec3 color{0.5f};     ///< linear reflectance, below 1, for the light that it sends back into the scene
  float mirror = 0.0f;  ///< share of what it shows that is the scene's mirror image, where it has one; 0 … 1
};

struct Scene {
  std::string name;
  std::vector<Node> nodes;
  std::vector<Mesh> meshes;
  std::vector<Material> materials;  ///< never empty: Primitive::material is always valid
  std::vector<Texture> textures;
  std::vector<std::shared_ptr<const TextureImage>> images;  ///< never null
  std::vector<int> image_file_indices;                      ///< beside `images`; empty = all made in memory
  std::vector<Camera> cameras;
  std::vector<Light> lights;
  std::vector<IesProfile> ies_profiles;
  std::optional<Ground> ground;           ///< no file has one
  std::optional<ImageLight> image_light;  ///< what lights the scene unless its user says otherwise
  /// What a built-in scene wishes to be lit by and seen through; files leave them empty.
  std::optional<std::string> preferred_environment;
  std::optional<float> preferred_exposure;  ///< factor, as DevelopSettings::exposure
};

/// The number by which people know an object of one of the scene's lists: its file's, else its place.
template <class T>
int number_of(const std::vector<T>& list, std::size_t index) {
  const int of_file = list[index].file_index;
  return of_file >= 0 ? of_file : static_cast<int>(index);
}
inline int image_number(const Scene& scene, std::size_t image) {
  return image < scene.image_file_indices.size() ? scene.image_file_indices[image] : static_cast<int>(image);
}

/// Recomputes world_from_node from parent_from_node; parents may come after children. Throws Error on a cycle.
void update_world_transforms(Scene& scene);

/// Whether a node holds a lamp of EXT_lights_area.
bool is_lamp(const Scene& scene, const Node& node);

/// World-space bounds of everything that has a mesh; empty when there is none. Lamps of EXT_lights_area are no part of
/// what a picture is of.
Box3 world_bounds(const Scene& scene);

/// The Light::intensity with which a point or spot of white colour gives this flux; not finite where its profile is
/// dark.
float intensity_from_lumens(const Scene& scene, const Light& light, float lumens);

/// A scene that its owner keeps alive, for whoever shares one.
inline std::shared_ptr<const Scene> borrowed(const Scene& scene) {
  return std::shared_ptr<const Scene>(std::shared_ptr<void>(), &scene);
}

/// Throws Error when an index is out of range, an array length disagrees or a number is not finite.
void validate(const Scene& scene);

}  // namespace candela
