#include "io/gltf_material_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "scene/metals.h"

namespace candela::io {

namespace {

/// Where textures have images beside the plain one; of several the first that a texture has is shown.
constexpr std::array<const char*, 4> kImageExtensions = {"KHR_texture_basisu", "EXT_texture_astc", "EXT_texture_avif",
                                                         "EXT_texture_webp"};

// A float of this size has no fraction left, so that no texture could be told apart from one texel.
constexpr float kLargestTransform = 1e6f;
// Beyond these nothing changes any more, and formulas that square them stay finite.
constexpr float kLargestIor = 1e6f;
constexpr float kThickestFilmNm = 1e6f;
constexpr float kLargestDispersion = 1e3f;
constexpr float kLargestThickness = 1e9f;
// An absorption coefficient -ln(color) / distance has to be finite: black means that a millionth is left.
constexpr float kDarkestAttenuation = 1e-6f;
constexpr float kShortestAttenuation = 1e-9f;
// Henyey and Greenstein's lobe is a delta at ±1.
constexpr float kLargestScatterAnisotropy = 0.999f;

/// One material while it is read: brings numbers into their range and says so.
class MaterialReader {
 public:
  MaterialReader(const JsonView& root, const JsonView& json, std::size_t index, Warnings& warnings)
      : root_(root), json_(json), warnings_(warnings) {
    material_.name = json.string_or("name");
    label_ = material_.name.empty() ? fmt::format("material {}", index) : fmt::format("material '{}'", material_.name);
  }

  Material read();

 private:
  void warn(const std::string& message, const JsonView& place) { warnings_.warn(label_ + ": " + message, place); }
  /// Of what changes no pixel.
  void note(const std::string& message, const JsonView& place) { warnings_.note(label_ + ": " + message, place); }
  float clamped(const JsonView& json, const char* key, float value, float lower, float upper);
  float factor(const JsonView& json, const char* key, float fallback, float lower = 0.0f, float upper = 1.0f);
  template <class V>
  V factors(const JsonView& json, const char* key, V fallback, float upper = 1.0f);
  TextureSlot slot(const JsonView& owner, const char* key);
  std::optional<JsonView> own_extra(const char* name);
  /// An extension that describes reflection or transmission, unless another one excludes it.
  std::optional<JsonView> layer(const char* name);

  void read_metallic_roughness(const JsonView& json);
  void read_specular_glossiness(const JsonView& json);
  vec3 read_emission();
  void read_surface();
  void read_specular();
  void read_clearcoat();
  void read_sheen();
  void read_anisotropy();
  void read_iridescence();
  void read_transmission();
  void read_volume();
  void read_scatter_members(const JsonView& json);
  void read_scattering();
  void read_conductor();
  void read_height();

  const JsonView& root_;
  const JsonView& json_;
  Warnings& warnings_;
  std::string label_;
  const char* winner_ = nullptr;  ///< the extension that excludes the layers, if any
  Material material_;
};

float MaterialReader::clamped(const JsonView& json, const char* key, float value, float lower, float upper) {
  const float result = std::clamp(value, lower, upper);
  if (result != value) warn(fmt::format("{} {} becomes {}", key, value, result), json);
  return result;
}

float MaterialReader::factor(const JsonView& json, const char* key, float fallback, float lower, float upper) {
  const auto number = json.find(key);
  return number ? clamped(json, key, number->real(), lower, upper) : fallback;
}

template <class V>
V MaterialReader::factors(const JsonView& json, const char* key, V fallback, float upper) {
  V result = json.vector_or(key, fallback);
  for (int i = 0; i < V::length(); ++i) result[i] = clamped(json, key, result[i], 0.0f, upper);
  return result;
}

/// KHR_texture_transform: scale first, then rotate, then move. A positive angle turns the uvs counter-clockwise as seen
/// with v pointing down, i.e. u' = u cos + v sin, which is what viewers do; the GLSL printed in the extension turns the
/// other way.
void read_transform(const JsonView& json, TextureSlot& slot) {
  const vec2 offset = json.vector_or("offset", vec2(0));
  const vec2 scale = json.vector_or("scale", vec2(1));
  const float angle = json.real_or("rotation", 0.0f);
  const float c = std::cos(angle), s = std::sin(angle);
  slot.transform = {vec2(c, -s) * scale.x, vec2(s, c) * scale.y, offset};
  for (const vec2 column : slot.transform) {
    if (!(std::fabs(column.x) <= kLargestTransform && std::fabs(column.y) <= kLargestTransform)) {
      throw json.error(fmt::format("the texture transform is beyond {:g}", kLargestTransform));
    }
  }
}

TextureSlot MaterialReader::slot(const JsonView& owner, const char* key) {
  const auto info = owner.find(key);
  if (!info) return {};
  TextureSlot result;
  const std::size_t texture = info->at("index").index(count_of(root_, "textures"), "texture");
  std::uint64_t set = info->whole_or("texCoord", 0);
  if (const auto transform = info->extension("KHR_texture_transform")) {
    set = transform->whole_or("texCoord", set);
    read_transform(*transform, result);
  }
  constexpr std::uint64_t kHighestSet = 999;  // no file has as many
  if (set > kHighestSet) {
    warn(fmt::format("{} uses TEXCOORD_{}, which is beyond {}, and is ignored", key, set, kHighestSet), *info);
    return {};
  }
  if (!texture_source(root_.at("textures")[texture])) {
    warn(fmt::format("{} has no image in a format that is read and is ignored", key), *info);
    return {};
  }
  result.texture = static_cast<int>(texture);
  result.uv_set = static_cast<int>(set);
  return result;
}

std::optional<JsonView> MaterialReader::layer(const char* name) {
  auto extension = json_.extension(name);
  if (!extension || winner_ == nullptr) return extension;
  const std::string message = fmt::format("{} is ignored beside {}", name, winner_);
  // What unlit surfaces are for others, as its extension asks for, is no loss.
  if (material_.unlit) {
    note(message, *extension);
  } else {
    warn(message, *extension);
  }
  return std::nullopt;
}

void MaterialReader::read_metallic_roughness(const JsonView& json) {
  const vec4 base = factors(json, "baseColorFactor", vec4(1));
  material_.base_color = vec3(base);
  material_.opacity = base.a;
  material_.base_color_texture = slot(json, "baseColorTexture");
  material_.metallic = factor(json, "metallicFactor", 1.0f);
  material_.roughness = factor(json, "roughnessFactor", 1.0f);
  material_.metallic_roughness_texture = slot(json, "metallicRoughnessTexture");
}

void MaterialReader::read_specular_glossiness(const JsonView& json) {
  material_.specular_glossiness = true;
  const vec4 diffuse = factors(json, "diffuseFactor", vec4(1));
  material_.base_color = vec3(diffuse);
  material_.opacity = diffuse.a;
  material_.base_color_texture = slot(json, "diffuseTexture");
  material_.metallic = 0.0f;
  material_.ior = 0.0f;
  material_.specular_color = factors(json, "specularFactor", vec3(1));
  material_.roughness = 1.0f - factor(json, "glossinessFactor", 1.0f);
  material_.specular_glossiness_texture = slot(json, "specularGlossinessTexture");
}

/// Above 1 is what converters make of OBJ's Ke: not allowed, and plain what is meant.
vec3 MaterialReader::read_emission() {
  const vec3 given = json_.vector_or("emissiveFactor", vec3(0));
  const vec3 result = glm::max(given, vec3(0));
  if (result != given) warn("emissiveFactor has a negative channel, which becomes 0", json_);
  if (max_component(result) > 1.0f) {
    warn(fmt::format("emissiveFactor {:g} {:g} {:g} is above 1; kept, as KHR_materials_emissive_strength would say it",
                     result.x, result.y, result.z),
         json_);
  }
  // A texture that cannot be read would say what glows: without it a factor makes a lamp of everything.
  return json_.find("emissiveTexture") && !material_.emissive_texture ? vec3(0) : result;
}

/// What the core of glTF says beside metallic-roughness.
void MaterialReader::read_surface() {
  if (const auto normal = json_.find("normalTexture")) {
    material_.normal_texture = slot(json_, "normalTexture");
    material_.normal_scale = normal->real_or("scale", 1.0f);
  }
  if (const auto occlusion = json_.find("occlusionTexture")) {
    material_.occlusion_texture = slot(json_, "occlusionTexture");
    material_.occlusion_strength = factor(*occlusion, "strength", 1.0f);
  }
  material_.emissive_texture = slot(json_, "emissiveTexture");
  material_.emission = read_emission();
  if (const auto strength = json_.extension("KHR_materials_emissive_strength")) {
    material_.emission *= factor(*strength, "emissiveStrength", 1.0f, 0.0f, kInfinity);
    if (!is_finite(material_.emission)) throw strength->error("the emission is not finite");
  }
  const std::string mode = json_.string_or("alphaMode", "OPAQUE");
  if (mode == "MASK") {
    material_.alpha_mode = AlphaMode::mask;
  } else if (mode == "BLEND") {
    material_.alpha_mode = AlphaMode::blend;
  } else if (mode != "OPAQUE") {
    throw json_.at("alphaMode").error("must be OPAQUE, MASK or BLEND");
  }
  material_.alpha_cutoff = factor(json_, "alphaCutoff", 0.5f, 0.0f, kInfinity);
  material_.double_sided = json_.boolean_or("doubleSided", false);
}

void MaterialReader::read_specular() {
  if (const auto ior = layer("KHR_materials_ior")) {
    const float value = ior->real_or("ior", 1.5f);
    // 0 is the compatibility mode; between 0 and 1 nothing is defined.
    material_.ior = value == 0.0f ? 0.0f : clamped(*ior, "ior", value, 1.0f, kLargestIor);
  }
  if (const auto specular = layer("KHR_materials_specular")) {
    material_.specular = factor(*specular, "specularFactor", 1.0f);
    material_.specular_texture = slot(*specular, "specularTexture");
    material_.specular_color = factors(*specular, "specularColorFactor", vec3(1), kInfinity);
    material_.specular_color_texture = slot(*specular, "specularColorTexture");
  }
}

void MaterialReader::read_clearcoat() {
  const auto coat = layer("KHR_materials_clearcoat");
  if (!coat) return;
  material_.clearcoat = factor(*coat, "clearcoatFactor", 0.0f);
  material_.clearcoat_texture = slot(*coat, "clearcoatTexture");
  material_.clearcoat_roughness = factor(*coat, "clearcoatRoughnessFactor", 0.0f);
  material_.clearcoat_roughness_texture = slot(*coat, "clearcoatRoughnessTexture");
  if (const auto normal = coat->find("clearcoatNormalTexture")) {
    material_.clearcoat_normal_texture = slot(*coat, "clearcoatNormalTexture");
    material_.clearcoat_normal_scale = normal->real_or("scale", 1.0f);
  }
}

void MaterialReader::read_sheen() {
  const auto sheen = layer("KHR_materials_sheen");
  if (!sheen) return;
  material_.sheen_color = factors(*sheen, "sheenColorFactor", vec3(0));
  material_.sheen_color_texture = slot(*sheen, "sheenColorTexture");
  material_.sheen_roughness = factor(*sheen, "sheenRoughnessFactor", 0.0f);
  material_.sheen_roughness_texture = slot(*sheen, "sheenRoughnessTexture");
}

void MaterialReader::read_anisotropy() {
  const auto anisotropy = layer("KHR_materials_anisotropy");
  if (!anisotropy) return;
  material_.anisotropy = factor(*anisotropy, "anisotropyStrength", 0.0f);
  material_.anisotropy_rotation = anisotropy->real_or("anisotropyRotation", 0.0f);
  material_.anisotropy_texture = slot(*anisotropy, "anisotropyTexture");
}

/// The minimum of the thickness may be above its maximum: the texture is then read upside down.
void MaterialReader::read_iridescence() {
  const auto film = layer("KHR_materials_iridescence");
  if (!film) return;
  material_.iridescence = factor(*film, "iridescenceFactor", 0.0f);
  material_.iridescence_texture = slot(*film, "iridescenceTexture");
  material_.iridescence_ior = factor(*film, "iridescenceIor", 1.3f, 1.0f, kLargestIor);
  material_.iridescence_thickness_min_nm = factor(*film, "iridescenceThicknessMinimum", 100.0f, 0.0f, kThickestFilmNm);
  material_.iridescence_thickness_max_nm = factor(*film, "iridescenceThicknessMaximum", 400.0f, 0.0f, kThickestFilmNm);
  material_.iridescence_thickness_texture = slot(*film, "iridescenceThicknessTexture");
}

void MaterialReader::read_transmission() {
  if (const auto transmission = layer("KHR_materials_transmission")) {
    material_.transmission = factor(*transmission, "transmissionFactor", 0.0f);
    material_.transmission_texture = slot(*transmission, "transmissionTexture");
  }
  if (const auto diffuse = layer("KHR_materials_diffuse_transmission")) {
    material_.diffuse_transmission = factor(*diffuse, "diffuseTransmissionFactor", 0.0f);
    material_.diffuse_transmission_texture = slot(*diffuse, "diffuseTransmissionTexture");
    material_.diffuse_transmission_color = factors(*diffuse, "diffuseTransmissionColorFactor", vec3(1));
    material_.diffuse_transmission_color_texture = slot(*diffuse, "diffuseTransmissionColorTexture");
  }
}

void MaterialReader::read_volume() {
  const auto volume = layer("KHR_materials_volume");
  if (volume) {
    material_.thickness = factor(*volume, "thicknessFactor", 0.0f, 0.0f, kLargestThickness);
    material_.thickness_texture = slot(*volume, "thicknessTexture");
    material_.attenuation_distance = factor(*volume, "attenuationDistance", kInfinity, kShortestAttenuation, kInfinity);
    material_.attenuation_color = glm::max(factors(*volume, "attenuationColor", vec3(1)), vec3(kDarkestAttenuation));
  }
  if (const auto dispersion = layer("KHR_materials_dispersion")) {
    material_.dispersion = factor(*dispersion, "dispersion", 0.0f, 0.0f, kLargestDispersion);
    if (material_.dispersion > 0.0f && !(volume && json_.extension("KHR_materials_transmission"))) {
      note("KHR_materials_dispersion has no effect without KHR_materials_transmission and KHR_materials_volume",
           *dispersion);
      material_.dispersion = 0.0f;
    }
  }
}

/// What both drafts of scattering have.
void MaterialReader::read_scatter_members(const JsonView& json) {
  material_.scatter_anisotropy =
      factor(json, "scatterAnisotropy", 0.0f, -kLargestScatterAnisotropy, kLargestScatterAnisotropy);
  material_.multiscatter_color_texture = slot(json, "multiscatterColorTexture");
}

/// KHR_materials_volume_scatter, or in its place its successor among the drafts, KHR_materials_scatter. The colour of
/// the first is called multiscatterColorFactor since February 2026.
void MaterialReader::read_scattering() {
  if (const auto scatter = layer("KHR_materials_volume_scatter")) {
    if (!json_.extension("KHR_materials_volume")) {
      note("KHR_materials_volume_scatter has no effect without KHR_materials_volume", *scatter);
      return;
    }
    const char* name = scatter->find("multiscatterColorFactor") ? "multiscatterColorFactor" : "multiscatterColor";
    material_.multiscatter_color = factors(*scatter, name, vec3(0));
    read_scatter_members(*scatter);
    if (const auto successor = json_.extension("KHR_materials_scatter")) {
      note("KHR_materials_scatter is ignored beside KHR_materials_volume_scatter", *successor);
    }
  } else if (const auto successor = layer("KHR_materials_scatter")) {
    if (json_.extension("KHR_materials_diffuse_transmission")) {
      warn("KHR_materials_scatter is ignored beside KHR_materials_diffuse_transmission", *successor);
      return;
    }
    if (!json_.extension("KHR_materials_transmission")) {
      note("KHR_materials_scatter has no effect without KHR_materials_transmission", *successor);
      return;
    }
    const float strength = factor(*successor, "scatterStrengthFactor", 0.0f);
    if (strength <= 0.0f) {
      note("KHR_materials_scatter has no effect: its scatterStrengthFactor is 0, as it is unless given", *successor);
    }
    material_.multiscatter_color = factors(*successor, "multiscatterColorFactor", vec3(1));
    material_.scatter_strength_texture = slot(*successor, "scatterStrengthTexture");
    read_scatter_members(*successor);
    if (material_.has_volume()) {
      material_.multiscatter_color *= strength;
    } else {
      material_.sheet_scatter = strength;
    }
  }
}

/// Extras may be anything: what has not our shape is not ours.
std::optional<JsonView> MaterialReader::own_extra(const char* name) {
  const auto extras = json_.find("extras");
  const auto own = extras && extras->is_object() ? extras->find("candela") : std::nullopt;
  return own && own->is_object() ? own->find(name) : std::nullopt;
}

void MaterialReader::read_height() {
  const auto height = own_extra("heightTexture");
  if (!height) return;
  material_.height_scale = factor(*height, "scale", 0.0f, 0.0f, 1e6f);
  material_.height_level = factor(*height, "level", 1.0f, 0.0f, 1.0f);
  if (material_.height_scale <= 0.0f) {
    warn("extras.candela.heightTexture has no scale above 0 and is ignored", *height);
  } else {
    material_.height_texture = slot(*json_.find("extras")->find("candela"), "heightTexture");
  }
}

void MaterialReader::read_conductor() {
  const auto name = own_extra("conductor");
  if (!name) return;
  if (winner_ != nullptr) {
    warn(fmt::format("extras.candela.conductor is ignored beside {}", winner_), *name);
  } else if (const Metal* metal = find_metal(name->string())) {
    material_.conductor_n = metal->n;
    material_.conductor_k = metal->k;
  } else {
    warn(fmt::format("there is no measured metal '{}'", name->string()), *name);
  }
}

Material MaterialReader::read() {
  material_.unlit = json_.extension("KHR_materials_unlit").has_value();
  if (material_.unlit) winner_ = "KHR_materials_unlit";
  if (const auto glossy = layer("KHR_materials_pbrSpecularGlossiness")) {
    winner_ = "KHR_materials_pbrSpecularGlossiness";
    read_specular_glossiness(*glossy);
  } else if (const auto pbr = json_.find("pbrMetallicRoughness")) {
    read_metallic_roughness(*pbr);
  }
  read_surface();
  read_specular();
  read_clearcoat();
  read_sheen();
  read_anisotropy();
  read_iridescence();
  read_transmission();
  read_volume();
  read_scattering();
  read_conductor();
  read_height();
  return material_;
}

}  // namespace

std::optional<JsonView> texture_source(const JsonView& texture) {
  for (const char* name : kImageExtensions) {
    const auto extension = texture.extension(name);
    if (extension && extension->find("source")) return extension->find("source");
  }
  return texture.find("source");
}

Material read_material(const JsonView& root, const JsonView& json, std::size_t index, Warnings& warnings) {
  return MaterialReader(root, json, index, warnings).read();
}

}  // namespace candela::io
