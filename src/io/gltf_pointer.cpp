#include "io/gltf_pointer.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "io/gltf_extensions.h"
#include "scene/material_table.h"

namespace candela::io {

namespace {

using nlohmann::json;

constexpr std::size_t kLongestPointer = 200;  // characters that are worth repeating

/// A property of the object model. In its pattern {} stands for any index, * for the way from a material to any of its
/// textures. One without a default has to stand in the file.
struct Property {
  std::string_view pattern;
  PropertyType type;
  bool has_default = true;
};

using enum PropertyType;

/// Beside those of the table of materials.
constexpr auto kOtherProperties = std::to_array<Property>({
    {"nodes/{}/translation", vec3},
    {"nodes/{}/rotation", rotation},
    {"nodes/{}/scale", vec3},
    {"nodes/{}/weights", numbers},
    {"nodes/{}/weights/{}", number},
    {"meshes/{}/weights", numbers},
    {"meshes/{}/weights/{}", number},
    {"nodes/{}/extensions/KHR_node_visibility/visible", boolean},

    {"cameras/{}/orthographic/xmag", number, false},
    {"cameras/{}/orthographic/ymag", number, false},
    {"cameras/{}/orthographic/znear", number, false},
    {"cameras/{}/orthographic/zfar", number, false},
    {"cameras/{}/perspective/aspectRatio", number, false},
    {"cameras/{}/perspective/yfov", number, false},
    {"cameras/{}/perspective/znear", number, false},
    {"cameras/{}/perspective/zfar", number, false},
    {"cameras/{}/extensions/EXT_camera_physical/fStop", number, false},
    {"cameras/{}/extensions/EXT_camera_physical/focalLength", number, false},
    {"cameras/{}/extensions/EXT_camera_physical/focusDistance", number, false},

    {"extensions/KHR_lights_punctual/lights/{}/color", vec3},
    {"extensions/KHR_lights_punctual/lights/{}/intensity", number},
    {"extensions/KHR_lights_punctual/lights/{}/range", number, false},
    {"extensions/KHR_lights_punctual/lights/{}/spot/innerConeAngle", number},
    {"extensions/KHR_lights_punctual/lights/{}/spot/outerConeAngle", number},
    {"extensions/KHR_lights_punctual/lights/{}/extras/candela/temperature_k", number, false},
    {"extensions/KHR_lights_punctual/lights/{}/extras/candela/lumens", number, false},
    {"extensions/EXT_lights_area/lights/{}/color", vec3},
    {"extensions/EXT_lights_area/lights/{}/intensity", number},
    {"extensions/EXT_lights_area/lights/{}/size", number},
    {"extensions/EXT_lights_area/lights/{}/rect/aspect", number},
    {"nodes/{}/extensions/EXT_lights_ies/multiplier", number},
    {"nodes/{}/extensions/EXT_lights_ies/color", vec3},
    {"extensions/EXT_lights_image_based/lights/{}/rotation", rotation},
    {"extensions/EXT_lights_image_based/lights/{}/intensity", number},

    {"materials/{}/emissiveFactor", vec3},
    {"materials/{}/extensions/KHR_materials_emissive_strength/emissiveStrength", number},
    {"materials/{}/extensions/KHR_materials_pbrSpecularGlossiness/diffuseFactor", vec4},
    {"materials/{}/extensions/KHR_materials_pbrSpecularGlossiness/specularFactor", vec3},
    {"materials/{}/extensions/KHR_materials_pbrSpecularGlossiness/glossinessFactor", number},
    {"materials/{}/extensions/KHR_materials_scatter/scatterStrengthFactor", number},
    {"materials/{}/extensions/KHR_materials_scatter/multiscatterColorFactor", vec3},
    {"materials/{}/extensions/KHR_materials_scatter/scatterAnisotropy", number},
    {"materials/{}/extensions/KHR_materials_volume_scatter/multiscatterColor", vec3},
    {"materials/{}/extensions/KHR_materials_volume_scatter/multiscatterColorFactor", vec3},
    {"materials/{}/extensions/KHR_materials_volume_scatter/scatterAnisotropy", number},
    {"materials/{}/extras/candela/heightTexture/scale", number, false},
    {"materials/{}/extras/candela/heightTexture/level", number},
    {"materials/{}/*/extensions/KHR_texture_transform/offset", vec2},
    {"materials/{}/*/extensions/KHR_texture_transform/rotation", number},
    {"materials/{}/*/extensions/KHR_texture_transform/scale", vec2},
});

/// RFC 6901 §3 and 4; none where it is no JSON pointer, or that of the whole document.
std::optional<std::vector<std::string>> split_pointer(std::string_view pointer) {
  std::vector<std::string> tokens;
  if (!pointer.starts_with('/')) return std::nullopt;
  for (std::size_t i = 0; i < pointer.size(); ++i) {
    if (pointer[i] == '/') {
      tokens.emplace_back();
    } else if (pointer[i] != '~') {
      tokens.back() += pointer[i];
    } else {
      ++i;
      if (i >= pointer.size() || (pointer[i] != '0' && pointer[i] != '1')) return std::nullopt;
      tokens.back() += pointer[i] == '0' ? '~' : '/';
    }
  }
  return tokens;
}

/// Of an array's element: digits without leading zeros.
std::optional<std::size_t> index_of(const std::string& token) {
  std::size_t index = 0;
  const auto [end, code] = std::from_chars(token.data(), token.data() + token.size(), index);
  const bool is_whole = code == std::errc() && end == token.data() + token.size();
  return is_whole && (token.size() == 1 || token[0] != '0') ? std::optional(index) : std::nullopt;
}

const json* child(const json& value, const std::string& token) {
  if (value.is_object()) {
    const auto found = value.find(token);
    return found != value.end() ? &*found : nullptr;
  }
  const auto index = value.is_array() ? index_of(token) : std::nullopt;
  return index && *index < value.size() ? &value[*index] : nullptr;
}

/// What the first `count` tokens lead to; null where that is nothing.
const json* follow(const json& root, const std::vector<std::string>& tokens, std::size_t count) {
  const json* value = &root;
  for (std::size_t i = 0; i < count && value != nullptr; ++i) value = child(*value, tokens[i]);
  return value;
}

std::string join(const std::vector<std::string>& tokens, std::size_t count) {
  std::string pointer;
  for (std::size_t i = 0; i < count; ++i) pointer += '/' + escaped_token(tokens[i]);
  return pointer;
}

std::vector<std::string_view> split_pattern(std::string_view pattern) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= pattern.size();) {
    const std::size_t end = std::min(pattern.find('/', begin), pattern.size());
    parts.push_back(pattern.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

bool matches(std::string_view pattern, const std::vector<std::string>& tokens) {
  const std::vector<std::string_view> parts = split_pattern(pattern);
  const bool has_way = std::find(parts.begin(), parts.end(), "*") != parts.end();
  if (has_way ? tokens.size() < parts.size() : tokens.size() != parts.size()) return false;
  std::size_t at = 0;
  for (const std::string_view part : parts) {
    if (part == "*") {
      at += 1 + tokens.size() - parts.size();
    } else if (part == "{}" ? !index_of(tokens[at]) : part != tokens[at]) {
      return false;
    } else {
      ++at;
    }
  }
  return true;
}

/// The type of a property that the table of materials has. The numbers of one array are one.
std::optional<PropertyType> type_in_table(const std::vector<std::string>& tokens) {
  if (tokens.size() < 3 || tokens[0] != "materials" || !index_of(tokens[1])) return std::nullopt;
  const std::string way = fmt::format("{}", fmt::join(tokens.begin() + 2, tokens.end(), "/"));
  for (const MaterialProperty& row : kMaterialProperties) {
    if (row.source.is_special() || row.source.first > 0) continue;
    const std::string_view slash = row.source.place.empty() ? "" : "/";
    if (way != fmt::format("{}{}{}", row.source.place, slash, row.source.key)) continue;
    const int count = std::max(row.member.size(), row.source.count);
    return count == 1 ? number : count == 3 ? vec3 : vec4;
  }
  return std::nullopt;
}

std::optional<Property> find_row(const std::vector<std::string>& tokens) {
  if (const auto type = type_in_table(tokens)) return Property{{}, *type};
  const auto found = std::find_if(kOtherProperties.begin(), kOtherProperties.end(),
                                  [&](const Property& p) { return matches(p.pattern, tokens); });
  return found != kOtherProperties.end() ? std::optional(*found) : std::nullopt;
}

/// How many morph targets the mesh has that a node or a mesh of the pointer shows; 0 where there is none.
std::size_t morph_targets(const json& root, const std::vector<std::string>& tokens) {
  const json* owner = follow(root, tokens, 2);
  if (tokens[0] == "nodes" && owner != nullptr) {
    const json* mesh = child(*owner, "mesh");
    // Whole and in range, as the nodes are read.
    const bool is_number =
        mesh != nullptr && mesh->is_number() && mesh->get<double>() >= 0 && mesh->get<double>() < 1e9;
    owner = is_number ? follow(root, {"meshes", std::to_string(mesh->get<std::size_t>())}, 2) : nullptr;
  }
  const json* targets = owner != nullptr ? follow(*owner, {"primitives", "0", "targets"}, 3) : nullptr;
  return targets != nullptr && targets->is_array() ? targets->size() : 0;
}

bool is_of_weights(const std::vector<std::string>& tokens) { return tokens.size() >= 3 && tokens[2] == "weights"; }

/// Whether weights, which stand for those of a mesh wherever they are written, and a single one of them are there.
bool has_weights(const json& root, const std::vector<std::string>& tokens) {
  const std::size_t count = morph_targets(root, tokens);
  return tokens.size() == 3 ? count > 0 : index_of(tokens[3]).value_or(count) < count;
}

/// Why a pointer leads to no property; empty where it does.
std::string fault_of(const json& root, const std::vector<std::string>& tokens, const std::optional<Property>& row) {
  if (row && is_of_weights(tokens)) {
    return has_weights(root, tokens) ? "" : "there is no such morph target";
  }
  for (std::size_t count = 1; count < tokens.size(); ++count) {
    const json* value = follow(root, tokens, count);
    if (value == nullptr || !value->is_structured()) return fmt::format("there is no {}", join(tokens, count));
  }
  if (!row || row->has_default || follow(root, tokens, tokens.size()) != nullptr) return "";
  return fmt::format("{} has no value in the file, and no default", tokens.back());
}

/// Whether what a pointer passes is read, and if not, whether any pixel depends on it.
enum class Reading { read, ignored, unseen };

Reading reading_of(const std::vector<std::string>& tokens, const std::optional<Property>& row) {
  Reading reading = row ? Reading::read : Reading::ignored;
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    if (!row && tokens[i] == "extras") return Reading::unseen;
    if (i == 0 || tokens[i - 1] != "extensions" || is_supported_extension(tokens[i])) continue;
    if (is_unseen_extension(tokens[i])) return Reading::unseen;
    reading = Reading::ignored;
  }
  return reading;
}

constexpr std::string_view kIor = "KHR_materials_ior";

}  // namespace

std::string Target::pointer() const { return join(tokens, tokens.size()); }

std::size_t Target::index(std::size_t token) const { return index_of(tokens[token]).value(); }

std::optional<JsonView> pointer_extension(const JsonView& channel) {
  const auto target = channel.find("target");
  return target ? target->extension("KHR_animation_pointer") : std::nullopt;
}

std::optional<Target> find_property(const json& root, const JsonView& pointer, Warnings& warnings) {
  const std::string text = pointer.string().substr(0, kLongestPointer);
  auto tokens = split_pointer(pointer.string());
  if (!tokens) throw pointer.error(fmt::format("'{}' is no JSON pointer to a property", text));
  const std::optional<Property> row = find_row(*tokens);
  const Reading reading = reading_of(*tokens, row);
  if (reading == Reading::unseen) {
    warnings.note(fmt::format("an animation of '{}' changes no pixel and is not read", text), pointer);
    return std::nullopt;
  }
  if (const std::string fault = fault_of(root, *tokens, row); !fault.empty()) {
    throw pointer.error(fmt::format("'{}' points at nothing: {}", text, fault.substr(0, kLongestPointer)));
  }
  if (reading == Reading::ignored) {
    warnings.warn(fmt::format("an animation of '{}' is not supported and will be ignored", text), pointer);
    return std::nullopt;
  }
  return Target{*std::move(tokens), row->type, true};
}

struct MovedDocument::Change {
  json* owner;
  std::string key;
  std::optional<json> before;  ///< none: it was not there
};

MovedDocument::MovedDocument(json& root) : root_(root) {}

MovedDocument::~MovedDocument() {
  for (auto change = changes_.rbegin(); change != changes_.rend(); ++change) {
    if (change->before) {
      (*change->owner)[change->key] = *std::move(change->before);
    } else {
      change->owner->erase(change->key);
    }
  }
}

void MovedDocument::set(const Target& target, const std::vector<float>& values, const JsonView& channel,
                        Warnings& warnings) {
  const std::vector<std::string>& tokens = target.tokens;
  json value;
  if (target.type == PropertyType::boolean) {
    value = values[0] != 0.0f;
  } else if (target.type == PropertyType::number) {
    value = values[0];
  } else {
    value = values;
  }
  // A single weight is written among the others of its mesh.
  const bool is_element = is_of_weights(tokens) && tokens.size() == 4;
  const std::size_t depth = is_element ? 3 : tokens.size();
  // What leads to a property is there, and its owner an object.
  json* owner = &root_;
  for (std::size_t i = 0; i + 1 < depth; ++i) {
    owner = owner->is_array() ? &(*owner)[index_of(tokens[i]).value()] : &(*owner)[tokens[i]];
  }
  const std::string& key = tokens[depth - 1];
  const auto found = owner->find(key);
  if (is_element) {
    json all = found != owner->end() && found->is_array() ? *found : json::array();
    while (all.size() < morph_targets(root_, tokens)) all.push_back(0.0f);
    all[index_of(tokens[3]).value()] = value;
    value = std::move(all);
  }
  if (std::find(tokens.begin(), tokens.end(), kIor) != tokens.end()) {
    // 0 is a mode that a material has or has not, and no number; KHR_materials_ior.
    if (found != owner->end() && found->is_number() && found->get<double>() == 0.0) {
      warnings.warn("an index of refraction of 0 cannot be animated and stays", channel);
      return;
    }
    if (values[0] < 1.0f) {
      warnings.warn("an index of refraction below 1 cannot be animated; 1 is taken", channel);
      value = 1.0f;
    }
  }
  changes_.push_back({owner, key, found != owner->end() ? std::optional<json>(*found) : std::nullopt});
  (*owner)[key] = std::move(value);
  if (tokens[0] == "materials") materials_.insert(target.index(1));
}

}  // namespace candela::io
