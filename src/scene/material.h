#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "math/types.h"

namespace candela {

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
/// diffuse_transmission and the drafts diffuse_roughness, volume_scatter and scatter. Factors are linear, in the range
/// their extension gives; each is multiplied by its texture's channel named beside it.
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
  /// EXT_materials_specular_edge_color (draft), 0 or 1: the specular colour tints a dielectric's reflection at every
  /// angle, and a metal's near 82°.
  float specular_edge_color = 0.0f;

  // KHR_materials_clearcoat
  float clearcoat = 0.0f;
  float clearcoat_roughness = 0.0f;
  float clearcoat_normal_scale = 1.0f;
  TextureSlot clearcoat_texture;            ///< R
  TextureSlot clearcoat_roughness_texture;  ///< G
  TextureSlot clearcoat_normal_texture;     ///< empty = the coat lies on the geometry's normal
  // KHR_materials_clearcoat_ior, _color, _darkening (drafts)
  float clearcoat_ior = 1.5f;               ///< 0 = it reflects all
  vec3 clearcoat_color{1.0f};               ///< what it leaves of white light that crosses it twice at normal incidence
  float clearcoat_darkening = 0.0f;         ///< how much counts of the light that its underside sends back down
  TextureSlot clearcoat_color_texture;      ///< sRGB
  TextureSlot clearcoat_darkening_texture;  ///< R
  // KHR_materials_clearcoat_anisotropy (draft)
  float clearcoat_anisotropy = 0.0f;
  float clearcoat_anisotropy_rotation = 0.0f;  ///< radians, counter-clockwise from the tangent
  TextureSlot clearcoat_anisotropy_texture;    ///< RG direction in [-1, 1], B strength

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

  // KHR_materials_retroreflection (release candidate): which share of what facets reflect returns to where it came from
  float retroreflection = 0.0f;
  TextureSlot retroreflection_texture;  ///< R

  // KHR_materials_fuzz (draft): fibres on top of everything, in place of a sheen
  float fuzz = 0.0f;
  vec3 fuzz_color{1.0f};
  float fuzz_roughness = 0.5f;
  TextureSlot fuzz_texture;            ///< R
  TextureSlot fuzz_color_texture;      ///< sRGB
  TextureSlot fuzz_roughness_texture;  ///< A

  // KHR_materials_diffuse_roughness (draft): 0 = Lambert's diffuse layer, 1 = facets that stand every way
  float diffuse_roughness = 0.0f;
  TextureSlot diffuse_roughness_texture;  ///< R

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

}  // namespace candela
