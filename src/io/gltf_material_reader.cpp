#include "io/gltf_material_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

#include "scene/material_table.h"
#include "scene/metals.h"

namespace candela::io {

namespace {

/// Where textures have images beside the plain one; of several the first that a texture has is shown.
constexpr std::array<const char*, 4> kImageExtensions = {"KHR_texture_basisu", "EXT_texture_astc", "EXT_texture_avif",
                                                         "EXT_texture_webp"};

// A float of this size has no fraction left, so that no texture could be told apart from one texel.
constexpr float kLargestTransform = 1e6f;
// An absorption coefficient -ln(color) / distance has to be finite: black means that a millionth is left.
constexpr float kDarkestAttenuation = 1e-6f;

/// What a way of keys leads to.
std::optional<JsonView> follow(const JsonView& from, std::string_view way) {
  std::optional<JsonView> at = from;
  while (at && !way.empty()) {
    const std::string_view key = way.substr(0, way.find('/'));
    at = at->find(std::string(key).c_str());
    way.remove_prefix(std::min(key.size() + 1, way.size()));
  }
  return at;
}

/// Where the table's properties and textures stand, each place once.
const std::vector<std::string_view>& material_places() {
  static const std::vector<std::string_view> kPlaces = [] {
    std::vector<std::string_view> places;
    const auto add = [&places](const JsonSource& source) {
      const bool is_known = std::find(places.begin(), places.end(), source.place) != places.end();
      if (!source.is_special() && !is_known) places.push_back(source.place);
    };
    for (const MaterialProperty& row : kMaterialProperties) add(row.source);
    for (const TextureRow& row : kTextureRows) add(row.source);
    return places;
  }();
  return kPlaces;
}

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
  float clamped(const JsonView& json, std::string_view key, float value, const Range& range);
  /// A member keeps its default where `json` has no such key.
  void read(NumberOrColor<Material> member, const JsonView& json, std::string_view key, const Range& range,
            int first = 0, int count = 0);
  void read(const MaterialProperty& row, const JsonView& json, std::string_view key) {
    if (row.source.is_flag) {
      row.member.at(material_, 0) = json.boolean_or(std::string(key).c_str(), false) ? 1.0f : 0.0f;
    } else {
      read(row.member, json, key, row.range, row.source.first, row.source.count);
    }
  }
  TextureSlot slot(const JsonView& owner, std::string_view key);
  std::optional<JsonView> own_extra(const char* name);
  /// An extension that describes reflection or transmission, unless another one excludes it.
  std::optional<JsonView> layer(std::string_view name);
  std::optional<JsonView> find_place(std::string_view place);

  void read_table();
  void read_specular_glossiness(const JsonView& json);
  void read_emission();
  void read_alpha_and_sides();
  void settle_volume();
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

float MaterialReader::clamped(const JsonView& json, std::string_view key, float value, const Range& range) {
  if (range.contains(value)) return value;
  const float result = std::clamp(value, range.lower, range.upper);
  warn(fmt::format("{} {} becomes {}", key, value, result), json);
  return result;
}

void MaterialReader::read(NumberOrColor<Material> member, const JsonView& json, std::string_view key,
                          const Range& range, int first, int count) {
  const std::size_t slash = key.rfind('/');
  const std::string name(key.substr(slash + 1));
  const auto owner = follow(json, slash == std::string_view::npos ? std::string_view() : key.substr(0, slash));
  const auto value = owner ? owner->find(name.c_str()) : std::nullopt;
  if (!value) return;
  const int size = member.size();
  const std::vector<float> numbers = size == 1 && count == 0
                                         ? std::vector{value->real()}
                                         : value->reals(static_cast<std::size_t>(std::max(size, count)));
  for (int i = 0; i < size; ++i) {
    member.at(material_, i) = clamped(*owner, name, numbers[static_cast<std::size_t>(first + i)], range);
  }
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

TextureSlot MaterialReader::slot(const JsonView& owner, std::string_view key) {
  const auto info = owner.find(std::string(key).c_str());
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

std::optional<JsonView> MaterialReader::layer(std::string_view name) {
  auto extension = json_.extension(std::string(name).c_str());
  for (const FallbackExtension& entry : kFallbackExtensions) {
    const bool is_replaced = extension && entry.name == name && winner_ == nullptr;
    if (is_replaced && json_.extension(std::string(entry.replaced_by).c_str())) return std::nullopt;
  }
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

/// The object that holds a place of the table, unless an extension excludes it.
std::optional<JsonView> MaterialReader::find_place(std::string_view place) {
  if (place == kPbrPlace && material_.specular_glossiness) return std::nullopt;
  if (!place.starts_with("extensions/")) return follow(json_, place);
  const std::string_view name = extension_of_place(place);
  if (place.size() == std::string_view("extensions/").size() + name.size()) return layer(name);
  return winner_ == nullptr ? follow(json_, place) : std::nullopt;
}

/// All that the table says where to find.
void MaterialReader::read_table() {
  for (const std::string_view place : material_places()) {
    const auto object = find_place(place);
    if (!object) continue;
    for (const TextureRow& row : kTextureRows) {
      if (row.source.place == place) material_.*row.slot = slot(*object, row.source.key);
    }
    for (const MaterialProperty& row : kMaterialProperties) {
      if (row.source.place != place) continue;
      for (int i = 0; row.source.implied && i < row.member.size(); ++i) {
        row.member.at(material_, i) = *row.source.implied;
      }
      read(row, *object, row.source.key);
    }
  }
}

void MaterialReader::read_specular_glossiness(const JsonView& json) {
  material_.specular_glossiness = true;
  read(property_of(&Material::base_color), json, "diffuseFactor");
  read(property_of(&Material::opacity), json, "diffuseFactor");
  material_.base_color_texture = slot(json, "diffuseTexture");
  material_.metallic = 0.0f;
  material_.ior = 0.0f;
  read(&Material::specular_color, json, "specularFactor", material_ranges::kUnit);
  read(property_of(&Material::roughness), json, "glossinessFactor");
  material_.roughness = 1.0f - (json.find("glossinessFactor") ? material_.roughness : 1.0f);
  material_.specular_glossiness_texture = slot(json, "specularGlossinessTexture");
}

void MaterialReader::read_emission() {
  // Above 1 is what converters make of OBJ's Ke: not allowed, and plain what is meant.
  const vec3 given = json_.vector_or("emissiveFactor", vec3(0));
  vec3 emission = glm::max(given, vec3(0));
  if (emission != given) warn("emissiveFactor has a negative channel, which becomes 0", json_);
  if (max_component(emission) > 1.0f) {
    warn(fmt::format("emissiveFactor {:g} {:g} {:g} is above 1; kept, as KHR_materials_emissive_strength would say it",
                     emission.x, emission.y, emission.z),
         json_);
  }
  // A texture that cannot be read would say what glows: without it a factor makes a lamp of everything.
  if (json_.find("emissiveTexture") && !material_.emissive_texture) emission = vec3(0);
  if (const auto extension = json_.extension("KHR_materials_emissive_strength")) {
    const float strength = extension->real_or("emissiveStrength", 1.0f);
    emission *= clamped(*extension, "emissiveStrength", strength, material_ranges::kNotNegative);
    if (!is_finite(emission)) throw extension->error("the emission is not finite");
  }
  material_.emission = emission;
}

void MaterialReader::read_alpha_and_sides() {
  const std::string mode = json_.string_or("alphaMode", "OPAQUE");
  if (mode == "MASK") {
    material_.alpha_mode = AlphaMode::mask;
  } else if (mode == "BLEND") {
    material_.alpha_mode = AlphaMode::blend;
  } else if (mode != "OPAQUE") {
    throw json_.at("alphaMode").error("must be OPAQUE, MASK or BLEND");
  }
  material_.double_sided = json_.boolean_or("doubleSided", false);
}

void MaterialReader::settle_volume() {
  material_.attenuation_color = glm::max(material_.attenuation_color, vec3(kDarkestAttenuation));
  const bool is_body = json_.extension("KHR_materials_transmission") && json_.extension("KHR_materials_volume");
  if (material_.dispersion > 0.0f && !is_body) {
    note("KHR_materials_dispersion has no effect without KHR_materials_transmission and KHR_materials_volume",
         *json_.extension("KHR_materials_dispersion"));
    material_.dispersion = 0.0f;
  }
}

/// What both drafts of scattering have.
void MaterialReader::read_scatter_members(const JsonView& json) {
  read(property_of(&Material::scatter_anisotropy), json, "scatterAnisotropy");
  material_.multiscatter_color_texture = slot(json, "multiscatterColorTexture");
}

/// KHR_materials_volume_scatter, or in its place its successor among the drafts, KHR_materials_scatter. The colour of
/// the first is called multiscatterColorFactor since February 2026.
void MaterialReader::read_scattering() {
  const MaterialProperty& color = property_of(&Material::multiscatter_color);
  if (const auto scatter = layer("KHR_materials_volume_scatter")) {
    if (!json_.extension("KHR_materials_volume")) {
      note("KHR_materials_volume_scatter has no effect without KHR_materials_volume", *scatter);
      return;
    }
    read(color, *scatter, scatter->find("multiscatterColorFactor") ? "multiscatterColorFactor" : "multiscatterColor");
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
    read(property_of(&Material::sheet_scatter), *successor, "scatterStrengthFactor");
    if (material_.sheet_scatter <= 0.0f) {
      note("KHR_materials_scatter has no effect: its scatterStrengthFactor is 0, as it is unless given", *successor);
    }
    material_.multiscatter_color = vec3(1.0f);
    read(color, *successor, "multiscatterColorFactor");
    material_.scatter_strength_texture = slot(*successor, "scatterStrengthTexture");
    read_scatter_members(*successor);
    if (material_.has_volume()) {
      material_.multiscatter_color *= material_.sheet_scatter;
      material_.sheet_scatter = 0.0f;
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
  read(property_of(&Material::height_scale), *height, "scale");
  read(property_of(&Material::height_level), *height, "level");
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
  }
  read_table();
  read_emission();
  read_alpha_and_sides();
  settle_volume();
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
