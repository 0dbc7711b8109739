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

/// A texture as one slot of a material uses it. uv' = transform * (uv, 1), columns of a 2×3 matrix
/// (KHR_texture_transform).
struct TextureSlot {
  int texture = -1;
  int uv_set = 0;  ///< which of Primitive::uvs
  std::array<vec2, 3> transform{vec2(1, 0), vec2(0, 1), vec2(0, 0)};

  explicit operator bool() const { return texture >= 0; }
  bool operator==(const TextureSlot&) const = default;
  vec2 apply(vec2 uv) const { return transform[0] * uv.x + transform[1] * uv.y + transform[2]; }
};

enum class AlphaMode { opaque, mask, blend };

/// glTF 2.0 metallic-roughness with every ratified KHR_materials_* extension, the release candidate
/// diffuse_transmission and the drafts volume_scatter and scatter. Factors are linear, in the range their extension
/// gives; each is multiplied by its texture's channel named beside it.
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

  // KHR_materials_clearcoat
  float clearcoat = 0.0f;
  float clearcoat_roughness = 0.0f;
  float clearcoat_normal_scale = 1.0f;
  TextureSlot clearcoat_texture;            ///< R
  TextureSlot clearcoat_roughness_texture;  ///< G
  TextureSlot clearcoat_normal_texture;     ///< empty = the coat lies on the geometry's normal

  // KHR_materials_sheen
  vec3 sheen_color{0.0f};
  float sheen_roughness = 0.0f;
  TextureSlot sheen_color_texture;      ///< sRGB
  TextureSlot sheen_roughness_texture;  ///< A

  // KHR_materials_anisotropy
  float anisotropy = 0.0f;
  float anisotropy_rotation = 0.0f;  ///< radians, counter-clockwise from the tangent
  TextureSlot anisotropy_texture;    ///< RG direction in [-1, 1], B strength

  // KHR_materials_iridescence
  float iridescence = 0.0f;
  float iridescence_ior = 1.3f;
  float iridescence_thickness_min_nm = 100.0f;
  float iridescence_thickness_max_nm = 400.0f;  ///< the thickness without a texture
  TextureSlot iridescence_texture;              ///< R
  TextureSlot iridescence_thickness_texture;    ///< G

  // KHR_materials_transmission, _volume, _dispersion
  float transmission = 0.0f;
  TextureSlot transmission_texture;  ///< R
  float thickness = 0.0f;  ///< metres in the mesh's space; 0 = thin-walled. The path tracer takes the true way inside
  TextureSlot thickness_texture;  ///< G; for the real-time renderer
  float attenuation_distance = kInfinity;
  vec3 attenuation_color{1.0f};  ///< what is left of white light after attenuation_distance; above 0
  float dispersion = 0.0f;       ///< 20 / Abbe number

  // KHR_materials_diffuse_transmission
  float diffuse_transmission = 0.0f;
  vec3 diffuse_transmission_color{1.0f};
  TextureSlot diffuse_transmission_texture;        ///< A
  TextureSlot diffuse_transmission_color_texture;  ///< sRGB

  // KHR_materials_volume_scatter, KHR_materials_scatter (drafts)
  vec3 multiscatter_color{0.0f};         ///< of a body times the strength of its scattering
  float scatter_anisotropy = 0.0f;       ///< g of Henyey and Greenstein, in (-1, 1); a sheet sends (1 + g) / 2 forwards
  float sheet_scatter = 0.0f;            ///< which share of what a sheet transmits is scattered
  TextureSlot scatter_strength_texture;  ///< A; multiplies the share, and the strength in a body where it is entered
  TextureSlot multiscatter_color_texture;  ///< sRGB, of a body where it is entered

  // KHR_materials_pbrSpecularGlossiness: base_color is its diffuse colour, specular_color its F0, roughness = 1 -
  // glossiness; ior is 0 (F90 = 1) and metallic 0. `base_color` and `roughness` are then read as that workflow says.
  bool specular_glossiness = false;
  TextureSlot specular_glossiness_texture;  ///< RGB sRGB multiplies specular_color, A multiplies glossiness

  /// Relief of the surface (extras.candela.heightTexture): along the normal by (height - height_level) × height_scale.
  TextureSlot height_texture;  ///< R
  float height_scale = 0.0f;   ///< metres in the mesh's space between black and white
  float height_level = 1.0f;   ///< the value that lies on the mesh itself

  /// A measured metal (extras.candela.conductor): complex index n + ik at the red, green and blue primaries; used for
  /// the metallic part instead of base_color as F0. k = 0 in every channel: none.
  vec3 conductor_n{1.0f};
  vec3 conductor_k{0.0f};

  int file_index = -1;  ///< glTF's default material has the number after the file's last

  bool operator==(const Material&) const = default;
  /// What stands for a lamp of EXT_lights_area: black, glowing, and no material of the file.
  bool is_lamp = false;

  bool is_conductor() const { return max_component(conductor_k) > 0.0f; }
  /// Whether light that enters goes through a body (KHR_materials_volume) rather than a sheet.
  bool has_volume() const { return thickness > 0.0f; }
  /// KHR_materials_scatter of a thin wall.
  bool scatters_as_sheet() const { return sheet_scatter > 0.0f && transmission > 0.0f && !has_volume(); }
};

/// What light meets on it, in the words of the extensions: "metallic-roughness", "clearcoat"…; never empty.
std::vector<std::string_view> material_lobes(const Material& material);

/// Pointers to every texture slot of a material (const or not), in the order of declaration.
template <class M>
auto texture_slots(M& m) {
  return std::array{&m.base_color_texture,
                    &m.metallic_roughness_texture,
                    &m.normal_texture,
                    &m.occlusion_texture,
                    &m.emissive_texture,
                    &m.specular_texture,
                    &m.specular_color_texture,
                    &m.clearcoat_texture,
                    &m.clearcoat_roughness_texture,
                    &m.clearcoat_normal_texture,
                    &m.sheen_color_texture,
                    &m.sheen_roughness_texture,
                    &m.anisotropy_texture,
                    &m.iridescence_texture,
                    &m.iridescence_thickness_texture,
                    &m.transmission_texture,
                    &m.thickness_texture,
                    &m.diffuse_transmission_texture,
                    &m.diffuse_transmission_color_texture,
                    &m.scatter_strength_texture,
                    &m.multiscatter_color_texture,
                    &m.specular_glossiness_texture,
                    &m.height_texture};
}

/// What glTF calls the slots that texture_slots gives, in the same order.
inline constexpr auto kTextureSlotNames = std::to_array<std::string_view>({
    "baseColorTexture",
    "metallicRoughnessTexture",
    "normalTexture",
    "occlusionTexture",
    "emissiveTexture",
    "specularTexture",
    "specularColorTexture",
    "clearcoatTexture",
    "clearcoatRoughnessTexture",
    "clearcoatNormalTexture",
    "sheenColorTexture",
    "sheenRoughnessTexture",
    "anisotropyTexture",
    "iridescenceTexture",
    "iridescenceThicknessTexture",
    "transmissionTexture",
    "thicknessTexture",
    "diffuseTransmissionTexture",
    "diffuseTransmissionColorTexture",
    "scatterStrengthTexture",
    "multiscatterColorTexture",
    "specularGlossinessTexture",
    "heightTexture",
});
static_assert(kTextureSlotNames.size() == std::tuple_size_v<decltype(texture_slots(std::declval<Material&>()))>);

/// Whether the slot at this place of texture_slots holds sRGB colours; the others hold data.
constexpr bool is_srgb_slot(std::size_t slot) {
  for (const std::string_view name :
       {"baseColorTexture", "emissiveTexture", "specularColorTexture", "sheenColorTexture",
        "diffuseTransmissionColorTexture", "multiscatterColorTexture", "specularGlossinessTexture"}) {
    if (kTextureSlotNames[slot] == name) return true;
  }
  return false;
}

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
