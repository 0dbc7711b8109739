#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include "scene/material.h"
#include "shade/surface_params.glsl.h"

/// What a property of a material is, in one row: its member, where glTF has it, its range, its texture, its lobe and
/// its name in the shaders. The reader of files, `validate`, both renderers' fetches, the rasterizer's uniform block
/// and the judgement of assets are loops over these rows. A property is added by a member of Material (whose initial
/// value is its default) and a row here; if a lobe reads it, by a member of SurfaceParams too.
namespace candela {

// ----- where glTF has it

/// The way from a material's JSON to the object that holds a property.
inline constexpr std::string_view kPlaceOfMaterial;
/// Read by a function of the reader's own: it has several places, or depends on others.
inline constexpr std::string_view kSpecialPlace = "*";

struct JsonSource {
  std::string_view place;  ///< "pbrMetallicRoughness", "extensions/KHR_materials_sheen"; or kSpecialPlace
  std::string_view key;    ///< below it; with a slash where an object lies between
  int first = 0;           ///< of an array of more numbers than the property has, where they begin
  int count = 0;           ///< and how many it holds; 0 = as many as the property has

  /// What stands there where the place is and the key is not; none: what a material has without the place.
  std::optional<float> implied = {};

  /// The file has true or false there, which are 1 and 0.
  bool is_flag = false;

  constexpr bool is_special() const { return place == kSpecialPlace; }
  constexpr JsonSource implying(float value) const {
    JsonSource source = *this;
    source.implied = value;
    return source;
  }
  constexpr JsonSource flag() const {
    JsonSource source = *this;
    source.is_flag = true;
    return source;
  }
};

/// The extension that holds a place, the innermost; empty for the core of glTF.
constexpr std::string_view extension_of_place(std::string_view place) {
  constexpr std::string_view kExtensions = "extensions/";
  const std::size_t at = place.rfind(kExtensions);
  return at == std::string_view::npos ? std::string_view() : place.substr(at + kExtensions.size());
}

/// Extensions of these places that other viewers need not read, and why.
struct UnratifiedExtension {
  std::string_view name;
  std::string_view why;
};
inline constexpr auto kUnratifiedExtensions = std::to_array<UnratifiedExtension>({
    {"EXT_materials_specular_edge_color", "a draft"},
    {"KHR_materials_diffuse_transmission", "a release candidate, not ratified"},
    {"KHR_materials_clearcoat_anisotropy", "a draft"},
    {"KHR_materials_clearcoat_color", "a draft"},
    {"KHR_materials_clearcoat_darkening", "a draft"},
    {"KHR_materials_clearcoat_ior", "a draft"},
    {"KHR_materials_diffuse_roughness", "a draft"},
    {"KHR_materials_fuzz", "a draft"},
    {"KHR_materials_retroreflection", "a release candidate, not ratified"},
});

/// Extensions that stand in a file for viewers which do not know another one, by which they are replaced.
struct FallbackExtension {
  std::string_view name;
  std::string_view replaced_by;
};
inline constexpr auto kFallbackExtensions =
    std::to_array<FallbackExtension>({{"KHR_materials_sheen", "KHR_materials_fuzz"}});

// ----- textures

/// What a slot takes from its image. Alpha alone may share an image with anything: extensions pack it so.
enum class TextureUse { color, normal, data, alpha };

struct TextureRow {
  std::string_view name;  ///< in the shaders
  TextureSlot Material::*slot;
  JsonSource source;
  TextureUse use;

  constexpr bool is_srgb() const { return use == TextureUse::color; }
};

inline constexpr std::string_view kPbrPlace = "pbrMetallicRoughness";
inline constexpr std::string_view kSpecularPlace = "extensions/KHR_materials_specular";
inline constexpr std::string_view kClearcoatPlace = "extensions/KHR_materials_clearcoat";
inline constexpr std::string_view kClearcoatAnisotropyPlace =
    "extensions/KHR_materials_clearcoat/extensions/KHR_materials_clearcoat_anisotropy";
inline constexpr std::string_view kClearcoatColorPlace =
    "extensions/KHR_materials_clearcoat/extensions/KHR_materials_clearcoat_color";
inline constexpr std::string_view kClearcoatDarkeningPlace =
    "extensions/KHR_materials_clearcoat/extensions/KHR_materials_clearcoat_darkening";
inline constexpr std::string_view kSheenPlace = "extensions/KHR_materials_sheen";
inline constexpr std::string_view kAnisotropyPlace = "extensions/KHR_materials_anisotropy";
inline constexpr std::string_view kIridescencePlace = "extensions/KHR_materials_iridescence";
inline constexpr std::string_view kTransmissionPlace = "extensions/KHR_materials_transmission";
inline constexpr std::string_view kVolumePlace = "extensions/KHR_materials_volume";
inline constexpr std::string_view kFuzzPlace = "extensions/KHR_materials_fuzz";
inline constexpr std::string_view kRetroreflectionPlace = "extensions/KHR_materials_retroreflection";
inline constexpr std::string_view kDiffuseRoughnessPlace = "extensions/KHR_materials_diffuse_roughness";
inline constexpr std::string_view kDiffuseTransmissionPlace = "extensions/KHR_materials_diffuse_transmission";

/// Every texture slot. The rasterizer leaves out the last ones first where a driver has too little room.
inline constexpr auto kTextureRows = [] {
  using M = Material;
  using enum TextureUse;
  return std::to_array<TextureRow>({
      {"base_color", &M::base_color_texture, {kPbrPlace, "baseColorTexture"}, color},
      {"metallic_roughness", &M::metallic_roughness_texture, {kPbrPlace, "metallicRoughnessTexture"}, data},
      {"normal", &M::normal_texture, {kPlaceOfMaterial, "normalTexture"}, normal},
      {"occlusion", &M::occlusion_texture, {kPlaceOfMaterial, "occlusionTexture"}, data},
      {"emissive", &M::emissive_texture, {kPlaceOfMaterial, "emissiveTexture"}, color},
      {"specular", &M::specular_texture, {kSpecularPlace, "specularTexture"}, alpha},
      {"specular_color", &M::specular_color_texture, {kSpecularPlace, "specularColorTexture"}, color},
      {"clearcoat", &M::clearcoat_texture, {kClearcoatPlace, "clearcoatTexture"}, data},
      {"clearcoat_roughness", &M::clearcoat_roughness_texture, {kClearcoatPlace, "clearcoatRoughnessTexture"}, data},
      {"clearcoat_normal", &M::clearcoat_normal_texture, {kClearcoatPlace, "clearcoatNormalTexture"}, normal},
      {"clearcoat_color", &M::clearcoat_color_texture, {kClearcoatColorPlace, "clearcoatColorTexture"}, color},
      {"clearcoat_darkening",
       &M::clearcoat_darkening_texture,
       {kClearcoatDarkeningPlace, "clearcoatDarkeningTexture"},
       data},
      {"clearcoat_anisotropy",
       &M::clearcoat_anisotropy_texture,
       {kClearcoatAnisotropyPlace, "clearcoatAnisotropyTexture"},
       data},
      {"sheen_color", &M::sheen_color_texture, {kSheenPlace, "sheenColorTexture"}, color},
      {"sheen_roughness", &M::sheen_roughness_texture, {kSheenPlace, "sheenRoughnessTexture"}, alpha},
      {"anisotropy", &M::anisotropy_texture, {kAnisotropyPlace, "anisotropyTexture"}, data},
      {"iridescence", &M::iridescence_texture, {kIridescencePlace, "iridescenceTexture"}, data},
      {"iridescence_thickness",
       &M::iridescence_thickness_texture,
       {kIridescencePlace, "iridescenceThicknessTexture"},
       data},
      {"transmission", &M::transmission_texture, {kTransmissionPlace, "transmissionTexture"}, data},
      {"thickness", &M::thickness_texture, {kVolumePlace, "thicknessTexture"}, data},
      {"diffuse_transmission",
       &M::diffuse_transmission_texture,
       {kDiffuseTransmissionPlace, "diffuseTransmissionTexture"},
       alpha},
      {"diffuse_transmission_color",
       &M::diffuse_transmission_color_texture,
       {kDiffuseTransmissionPlace, "diffuseTransmissionColorTexture"},
       color},
      {"diffuse_roughness", &M::diffuse_roughness_texture, {kDiffuseRoughnessPlace, "diffuseRoughnessTexture"}, data},
      {"retroreflection", &M::retroreflection_texture, {kRetroreflectionPlace, "retroreflectionTexture"}, data},
      {"fuzz", &M::fuzz_texture, {kFuzzPlace, "fuzzTexture"}, data},
      {"fuzz_color", &M::fuzz_color_texture, {kFuzzPlace, "fuzzColorTexture"}, color},
      {"fuzz_roughness", &M::fuzz_roughness_texture, {kFuzzPlace, "fuzzRoughnessTexture"}, alpha},
      {"scatter_strength", &M::scatter_strength_texture, {kSpecialPlace, "scatterStrengthTexture"}, alpha},
      {"multiscatter_color", &M::multiscatter_color_texture, {kSpecialPlace, "multiscatterColorTexture"}, color},
      {"specular_glossiness", &M::specular_glossiness_texture, {kSpecialPlace, "specularGlossinessTexture"}, color},
      {"height", &M::height_texture, {kSpecialPlace, "heightTexture"}, data},
  });
}();
inline constexpr std::size_t kTextureSlots = kTextureRows.size();

/// The place of a slot among all of them.
constexpr std::size_t texture_slot_index(TextureSlot Material::*slot) {
  std::size_t i = 0;
  while (kTextureRows[i].slot != slot) ++i;
  return i;
}

/// Pointers to every texture slot of a material (const or not), in the order of the rows.
template <class M>
auto texture_slots(M& m) {
  std::array<decltype(&m.base_color_texture), kTextureSlots> slots{};
  for (std::size_t i = 0; i < kTextureSlots; ++i) slots[i] = &(m.*kTextureRows[i].slot);
  return slots;
}

// ----- properties

/// A member that is a number or a colour.
template <class Owner>
struct NumberOrColor {
  float Owner::*number = nullptr;
  vec3 Owner::*color = nullptr;

  constexpr NumberOrColor() = default;
  // NOLINTBEGIN(google-explicit-constructor): rows say &Material::metallic
  constexpr NumberOrColor(float Owner::*member) : number(member) {}
  constexpr NumberOrColor(vec3 Owner::*member) : color(member) {}
  // NOLINTEND(google-explicit-constructor)

  constexpr explicit operator bool() const { return number != nullptr || color != nullptr; }
  constexpr bool is_color() const { return color != nullptr; }
  constexpr bool operator==(const NumberOrColor&) const = default;
  constexpr int size() const { return is_color() ? 3 : 1; }
  /// The i-th number of it.
  template <class O>
  auto& at(O& owner, int i) const {
    return is_color() ? (owner.*color)[i] : owner.*number;
  }
  bool is_zero(const Owner& owner) const { return is_color() ? owner.*color == vec3(0.0f) : owner.*number == 0.0f; }
};

/// Numbers that a property may have. The reader brings others there, `validate` refuses them.
struct Range {
  float lower = 0.0f;
  float upper = 1.0f;
  bool has_zero = false;  ///< 0 too, which is a mode of its own

  constexpr bool contains(float x) const { return (x >= lower && x <= upper) || (has_zero && x == 0.0f); }
};

/// Which numbers of its texture a property is multiplied by; or a function of the renderers' own knows.
enum class Texel { red, green, blue, alpha, rgb, special };

struct TextureFactor {
  TextureSlot Material::*slot = nullptr;
  Texel texel = Texel::special;
  /// What stands where the texture is 0; null = 0. The property's own value stands where it is 1.
  float Material::*low = nullptr;

  constexpr explicit operator bool() const { return slot != nullptr; }
  constexpr std::size_t index() const { return texture_slot_index(slot); }
};

struct LobeRow {
  int bit;                 ///< shade's kLobe…
  std::string_view words;  ///< for people
  std::string_view name;   ///< in the shaders
};

/// The lobes that a material may have beyond the base, in the order in which they are listed for people.
inline constexpr auto kLobes = std::to_array<LobeRow>({
    {shade::kLobeConductor, "conductor", "conductor"},
    {shade::kLobeAnisotropy, "anisotropy", "anisotropy"},
    {shade::kLobeIridescence, "iridescence", "iridescence"},
    {shade::kLobeClearcoat, "clearcoat", "clearcoat"},
    {shade::kLobeSheen, "sheen", "sheen"},
    {shade::kLobeTransmission, "transmission", "transmission"},
    {shade::kLobeDiffuseTransmission, "diffuse transmission", "diffuse_transmission"},
    {shade::kLobeDiffuseRoughness, "diffuse roughness", "diffuse_roughness"},
    {shade::kLobeRetroreflection, "retroreflection", "retroreflection"},
    {shade::kLobeFuzz, "fuzz", "fuzz"},
    {shade::kLobeCoatAnisotropy, "clearcoat anisotropy", "clearcoat_anisotropy"},
    {shade::kLobeEdgeColor, "specular edge color", "edge_color"},
});

/// The lobe that alone reads a property.
struct LobeOf {
  int bit = 0;             ///< shade's kLobe…; 0 = the base has it
  bool is_switch = false;  ///< a material has the lobe where this property is above 0
};

/// What of a surface a property is; the name where it is not the property's own.
struct ParamOf {
  NumberOrColor<shade::SurfaceParams> member;
  std::string_view name;

  constexpr ParamOf() = default;
  // NOLINTBEGIN(google-explicit-constructor): rows say &SurfaceParams::metallic
  constexpr ParamOf(float shade::SurfaceParams::*m, std::string_view n = {}) : member(m), name(n) {}
  constexpr ParamOf(vec3 shade::SurfaceParams::*m, std::string_view n = {}) : member(m), name(n) {}
  // NOLINTEND(google-explicit-constructor)
};

struct MaterialProperty {
  std::string_view name;  ///< of the member, and in the shaders
  NumberOrColor<Material> member;
  JsonSource source;
  Range range;
  TextureFactor texture;
  LobeOf lobe;
  NumberOrColor<shade::SurfaceParams> param;  ///< none: no lobe reads it by itself
  std::string_view param_name;
  std::string_view doc;

  constexpr MaterialProperty(std::string_view name_, NumberOrColor<Material> member_, JsonSource source_, Range range_,
                             TextureFactor texture_, LobeOf lobe_, ParamOf param_, std::string_view doc_)
      : name(name_),
        member(member_),
        source(source_),
        range(range_),
        texture(texture_),
        lobe(lobe_),
        param(param_.member),
        param_name(param_.name.empty() ? name_ : param_.name),
        doc(doc_) {}
};

namespace material_ranges {
inline constexpr float kMost = std::numeric_limits<float>::max();
inline constexpr Range kUnit{0.0f, 1.0f};
inline constexpr Range kNotNegative{0.0f, kMost};
inline constexpr Range kFinite{-kMost, kMost};
inline constexpr Range kPositive{std::numeric_limits<float>::min(), kMost};
// Beyond these nothing changes any more, and formulas that square them stay finite.
inline constexpr float kLargestIor = 1e6f;
inline constexpr Range kFilmNm{0.0f, 1e6f};
inline constexpr Range kDispersion{0.0f, 1e3f};
inline constexpr Range kThickness{0.0f, 1e9f};
inline constexpr Range kHeight{0.0f, 1e6f};
// An absorption coefficient -ln(color) / distance has to be finite.
inline constexpr Range kAttenuationDistance{1e-9f, kInfinity};
// Henyey and Greenstein's lobe is a delta at ±1.
inline constexpr Range kScatterAnisotropy{-0.999f, 0.999f};
}  // namespace material_ranges

/// Every number and colour of a material. Lobes are those of shade/surface_params.glsl.h.
inline constexpr auto kMaterialProperties = [] {
  using M = Material;
  using P = shade::SurfaceParams;
  using Row = MaterialProperty;
  using enum Texel;
  using namespace material_ranges;
  using namespace shade;
  constexpr std::string_view kMaterial = kPlaceOfMaterial;
  constexpr JsonSource kSpecial{kSpecialPlace, {}};
  constexpr LobeOf kBase;
  constexpr bool kSwitch = true;
  constexpr TextureFactor kNoTexture;
  constexpr ParamOf kNoParam;
  return std::to_array<MaterialProperty>({
      Row("base_color", &M::base_color, {kPbrPlace, "baseColorFactor", 0, 4}, kUnit, {&M::base_color_texture, rgb},
          kBase, &P::base_color, "of metal its F0, of the rest the albedo below the boundary"),
      Row("opacity", &M::opacity, {kPbrPlace, "baseColorFactor", 3, 4}, kUnit, {&M::base_color_texture, alpha}, kBase,
          kNoParam, "after the alpha mode"),
      Row("metallic", &M::metallic, {kPbrPlace, "metallicFactor"}, kUnit, {&M::metallic_roughness_texture, blue}, kBase,
          &P::metallic, "share of metal"),
      Row("roughness", &M::roughness, {kPbrPlace, "roughnessFactor"}, kUnit, {&M::metallic_roughness_texture, green},
          kBase, &P::roughness, "square root of the facets' alpha"),
      Row("emission", &M::emission, kSpecial, kNotNegative, {&M::emissive_texture, rgb}, kBase, kNoParam,
          "emissiveFactor x emissiveStrength, cd/m2"),
      Row("normal_scale", &M::normal_scale, {kMaterial, "normalTexture/scale"}, kFinite, {&M::normal_texture}, kBase,
          kNoParam, "of a normal map's x and y"),
      Row("occlusion_strength", &M::occlusion_strength, {kMaterial, "occlusionTexture/strength"}, kUnit,
          {&M::occlusion_texture, red}, kBase, kNoParam, "how much of its texture's occlusion counts"),
      Row("alpha_cutoff", &M::alpha_cutoff, {kMaterial, "alphaCutoff"}, kNotNegative, kNoTexture, kBase, kNoParam,
          "the least alpha that a mask leaves"),

      Row("ior", &M::ior, {"extensions/KHR_materials_ior", "ior"}, {1.0f, kLargestIor, true}, kNoTexture, kBase,
          &P::ior, "of the dielectric; 0 = F is 1"),
      Row("specular", &M::specular, {kSpecularPlace, "specularFactor"}, kUnit, {&M::specular_texture, alpha}, kBase,
          &P::specular, "weight of the dielectric's boundary"),
      Row("specular_color", &M::specular_color, {kSpecularPlace, "specularColorFactor"}, kNotNegative,
          {&M::specular_color_texture, rgb}, kBase, &P::specular_color, "of its F0"),

      Row("specular_edge_color", &M::specular_edge_color,
          JsonSource{"extensions/KHR_materials_specular/extensions/EXT_materials_specular_edge_color",
                     "specularEdgeColorEnabled"}
              .flag(),
          kUnit, kNoTexture, {kLobeEdgeColor, kSwitch}, kNoParam, "1: the specular colour is that of the whole lobe"),

      Row("clearcoat", &M::clearcoat, {kClearcoatPlace, "clearcoatFactor"}, kUnit, {&M::clearcoat_texture, red},
          {kLobeClearcoat, kSwitch}, &P::clearcoat, "weight of the coat"),
      Row("clearcoat_roughness", &M::clearcoat_roughness, {kClearcoatPlace, "clearcoatRoughnessFactor"}, kUnit,
          {&M::clearcoat_roughness_texture, green}, {kLobeClearcoat}, &P::clearcoat_roughness, "of the coat's facets"),
      Row("clearcoat_normal_scale", &M::clearcoat_normal_scale, {kClearcoatPlace, "clearcoatNormalTexture/scale"},
          kFinite, {&M::clearcoat_normal_texture}, {kLobeClearcoat}, kNoParam, "of the coat's normal map"),
      Row("clearcoat_ior", &M::clearcoat_ior,
          {"extensions/KHR_materials_clearcoat/extensions/KHR_materials_clearcoat_ior", "clearcoatIor"},
          {1.0f, kLargestIor, true}, kNoTexture, {kLobeClearcoat}, &P::clearcoat_ior,
          "of the coat; 0 = it reflects all"),
      Row("clearcoat_color", &M::clearcoat_color, {kClearcoatColorPlace, "clearcoatColorFactor"}, kUnit,
          {&M::clearcoat_color_texture, rgb}, {kLobeClearcoat}, &P::clearcoat_color,
          "what the coat leaves of light that crosses it twice"),
      Row("clearcoat_darkening", &M::clearcoat_darkening,
          JsonSource{kClearcoatDarkeningPlace, "clearcoatDarkeningFactor"}.implying(1.0f), kUnit,
          {&M::clearcoat_darkening_texture, red}, {kLobeClearcoat}, &P::clearcoat_darkening,
          "how much counts of what the coat sends back down"),

      Row("clearcoat_anisotropy", &M::clearcoat_anisotropy, {kClearcoatAnisotropyPlace, "clearcoatAnisotropyStrength"},
          kUnit, {&M::clearcoat_anisotropy_texture, blue}, {kLobeCoatAnisotropy, kSwitch}, &P::clearcoat_anisotropy,
          "how much wider the coat's lobe is along its direction"),
      Row("clearcoat_anisotropy_rotation", &M::clearcoat_anisotropy_rotation,
          {kClearcoatAnisotropyPlace, "clearcoatAnisotropyRotation"}, kFinite, {&M::clearcoat_anisotropy_texture},
          {kLobeCoatAnisotropy}, kNoParam, "of that direction, from the tangent"),

      Row("sheen_color", &M::sheen_color, {kSheenPlace, "sheenColorFactor"}, kUnit, {&M::sheen_color_texture, rgb},
          {kLobeSheen, kSwitch}, &P::sheen_color, "of the fibres"),
      Row("sheen_roughness", &M::sheen_roughness, {kSheenPlace, "sheenRoughnessFactor"}, kUnit,
          {&M::sheen_roughness_texture, alpha}, {kLobeSheen}, &P::sheen_roughness, "how far fibres stray"),

      Row("anisotropy", &M::anisotropy, {kAnisotropyPlace, "anisotropyStrength"}, kUnit, {&M::anisotropy_texture, blue},
          {kLobeAnisotropy, kSwitch}, &P::anisotropy, "how much wider the lobe is along its direction"),
      Row("anisotropy_rotation", &M::anisotropy_rotation, {kAnisotropyPlace, "anisotropyRotation"}, kFinite,
          {&M::anisotropy_texture}, {kLobeAnisotropy}, kNoParam, "of that direction, from the tangent"),

      Row("iridescence", &M::iridescence, {kIridescencePlace, "iridescenceFactor"}, kUnit,
          {&M::iridescence_texture, red}, {kLobeIridescence, kSwitch}, &P::iridescence, "weight of the thin film"),
      Row("iridescence_ior", &M::iridescence_ior, {kIridescencePlace, "iridescenceIor"}, {1.0f, kLargestIor},
          kNoTexture, {kLobeIridescence}, {&P::film_ior, "film_ior"}, "of the film"),
      Row("iridescence_thickness_min_nm", &M::iridescence_thickness_min_nm,
          {kIridescencePlace, "iridescenceThicknessMinimum"}, kFilmNm, kNoTexture, {kLobeIridescence}, kNoParam,
          "where the texture is 0"),
      Row("iridescence_thickness_max_nm", &M::iridescence_thickness_max_nm,
          {kIridescencePlace, "iridescenceThicknessMaximum"}, kFilmNm,
          {&M::iridescence_thickness_texture, green, &M::iridescence_thickness_min_nm}, {kLobeIridescence},
          {&P::film_nm, "film_nm"}, "where it is 1, and without one"),

      Row("conductor_n", &M::conductor_n, kSpecial, kPositive, kNoTexture, {kLobeConductor}, &P::conductor_n,
          "n + ik of a measured metal"),
      Row("conductor_k", &M::conductor_k, kSpecial, kNotNegative, kNoTexture, {kLobeConductor, kSwitch},
          &P::conductor_k, "and k"),

      Row("transmission", &M::transmission, {kTransmissionPlace, "transmissionFactor"}, kUnit,
          {&M::transmission_texture, red}, {kLobeTransmission, kSwitch}, &P::transmission,
          "share of the dielectric that is clear"),
      Row("thickness", &M::thickness, {kVolumePlace, "thicknessFactor"}, kThickness, {&M::thickness_texture, green},
          kBase, kNoParam, "of the body, metres in the mesh's space; 0 = a sheet"),
      Row("attenuation_distance", &M::attenuation_distance, {kVolumePlace, "attenuationDistance"}, kAttenuationDistance,
          kNoTexture, kBase, kNoParam, "metres"),
      Row("attenuation_color", &M::attenuation_color, {kVolumePlace, "attenuationColor"}, kUnit, kNoTexture, kBase,
          kNoParam, "what is left of white light after that distance"),
      Row("dispersion", &M::dispersion, {"extensions/KHR_materials_dispersion", "dispersion"}, kDispersion, kNoTexture,
          kBase, kNoParam, "20 / Abbe number"),

      Row("diffuse_transmission", &M::diffuse_transmission, {kDiffuseTransmissionPlace, "diffuseTransmissionFactor"},
          kUnit, {&M::diffuse_transmission_texture, alpha}, {kLobeDiffuseTransmission, kSwitch},
          &P::diffuse_transmission, "share of the diffuse layer that lets light through"),
      Row("diffuse_transmission_color", &M::diffuse_transmission_color,
          {kDiffuseTransmissionPlace, "diffuseTransmissionColorFactor"}, kUnit,
          {&M::diffuse_transmission_color_texture, rgb}, {kLobeDiffuseTransmission}, &P::diffuse_transmission_color,
          "of that light"),
      Row("diffuse_roughness", &M::diffuse_roughness, {kDiffuseRoughnessPlace, "diffuseRoughnessFactor"}, kUnit,
          {&M::diffuse_roughness_texture, red}, {kLobeDiffuseRoughness, kSwitch}, &P::diffuse_roughness,
          "of the diffuse layer's own facets"),
      Row("retroreflection", &M::retroreflection, {kRetroreflectionPlace, "retroreflectionFactor"}, kUnit,
          {&M::retroreflection_texture, red}, {kLobeRetroreflection, kSwitch}, &P::retroreflection,
          "share of what facets reflect that returns to where it came from"),
      Row("fuzz", &M::fuzz, {kFuzzPlace, "fuzzFactor"}, kUnit, {&M::fuzz_texture, red}, {kLobeFuzz, kSwitch}, &P::fuzz,
          "weight of fibres above everything"),
      Row("fuzz_color", &M::fuzz_color, {kFuzzPlace, "fuzzColorFactor"}, kUnit, {&M::fuzz_color_texture, rgb},
          {kLobeFuzz}, &P::fuzz_color, "of these fibres"),
      Row("fuzz_roughness", &M::fuzz_roughness, {kFuzzPlace, "fuzzRoughnessFactor"}, kUnit,
          {&M::fuzz_roughness_texture, alpha}, {kLobeFuzz}, &P::fuzz_roughness, "how far they stray"),
      Row("sheet_scatter", &M::sheet_scatter, kSpecial, kUnit, {&M::scatter_strength_texture, alpha},
          {kLobeDiffuseTransmission}, {&P::scatter, "scatter"}, "share of what a sheet transmits that is scattered"),
      Row("multiscatter_color", &M::multiscatter_color, kSpecial, kUnit, {&M::multiscatter_color_texture, rgb},
          {kLobeDiffuseTransmission}, {&P::scatter_color, "scatter_color"}, "what of scattered light comes out again"),
      Row("scatter_anisotropy", &M::scatter_anisotropy, kSpecial, kScatterAnisotropy, kNoTexture,
          {kLobeDiffuseTransmission}, &P::scatter_anisotropy, "g of Henyey and Greenstein"),

      Row("height_scale", &M::height_scale, kSpecial, kHeight, {&M::height_texture}, kBase, kNoParam,
          "of the relief between black and white, metres in the mesh's space"),
      Row("height_level", &M::height_level, kSpecial, kUnit, kNoTexture, kBase, kNoParam,
          "the value that lies on the mesh"),
  });
}();

// ----- directions

/// A direction in the surface that a lobe follows: so far from the tangent, and farther by what red and green of a
/// texture say.
struct DirectionRow {
  float Material::*rotation;  ///< radians, counter-clockwise
  TextureSlot Material::*texture;
  int lobe;                           ///< that follows it
  vec3 shade::SurfaceParams::*param;  ///< in the shading frame; none: it is the x axis of that frame
  std::string_view param_name;
};

inline constexpr auto kDirectionRows = std::to_array<DirectionRow>({
    {&Material::anisotropy_rotation, &Material::anisotropy_texture, shade::kLobeAnisotropy, nullptr, {}},
    {&Material::clearcoat_anisotropy_rotation, &Material::clearcoat_anisotropy_texture, shade::kLobeCoatAnisotropy,
     &shade::SurfaceParams::clearcoat_direction, "clearcoat_direction"},
});

/// Whether the texels of a slot say a direction, whatever else they say.
constexpr bool is_direction_texture(std::size_t slot) {
  return std::any_of(kDirectionRows.begin(), kDirectionRows.end(),
                     [slot](const DirectionRow& row) { return row.texture == kTextureRows[slot].slot; });
}

/// Lobes that need tangents.
inline constexpr int kLobesWithDirection = [] {
  int lobes = 0;
  for (const DirectionRow& row : kDirectionRows) lobes |= row.lobe;
  return lobes;
}();

/// The texture whose coordinates say where tangents point: an empty one (set 0 as it is) when only a direction's
/// factors ask for them; null when nothing does.
const TextureSlot* tangent_slot(const Material& material);

// ----- loops

/// Calls `f` with the number of each row as a std::integral_constant, for what the compiler shall unroll.
template <class F>
constexpr void for_each_property(F&& f) {
  [&]<std::size_t... I>(std::index_sequence<I...>) { (f(std::integral_constant<std::size_t, I>{}), ...); }
  (std::make_index_sequence<kMaterialProperties.size()>{});
}

/// The same for the slots.
template <class F>
constexpr void for_each_texture(F&& f) {
  [&]<std::size_t... I>(std::index_sequence<I...>) { (f(std::integral_constant<std::size_t, I>{}), ...); }
  (std::make_index_sequence<kTextureSlots>{});
}

/// The same for the directions.
template <class F>
constexpr void for_each_direction(F&& f) {
  [&]<std::size_t... I>(std::index_sequence<I...>) { (f(std::integral_constant<std::size_t, I>{}), ...); }
  (std::make_index_sequence<kDirectionRows.size()>{});
}

/// The row of a member.
constexpr const MaterialProperty& property_of(NumberOrColor<Material> member) {
  std::size_t i = 0;
  while (kMaterialProperties[i].member != member) ++i;
  return kMaterialProperties[i];
}

/// The bits of the lobes that a material's properties switch on.
int lobes_of(const Material& material);

/// Whether a texture changes anything, going by the factors that it is multiplied by and the lobe that reads it.
bool has_effect(const Material& material, std::size_t slot);

}  // namespace candela
