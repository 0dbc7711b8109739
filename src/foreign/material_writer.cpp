#include "foreign/material_writer.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace candela::foreign {

using Json = nlohmann::json;

namespace {

constexpr float kPlainRoughness = 0.5f;  // where nothing says how rough a metallic-roughness surface is

Json list(vec3 v) { return {v.x, v.y, v.z}; }
float unit(float v) { return std::isfinite(v) ? std::clamp(v, 0.0f, 1.0f) : 0.0f; }
vec3 finite(vec3 v) {
  for (int i = 0; i < 3; ++i) v[i] = std::isfinite(v[i]) ? std::max(v[i], 0.0f) : 0.0f;
  return v;
}

/// Walter et al. 2007, §5.2: the Beckmann lobe as wide as a Phong lobe of this exponent; GGX of that width.
float roughness_of_shininess(float shininess) { return std::pow(2.0f / (std::max(shininess, 0.0f) + 2.0f), 0.25f); }

}  // namespace

std::size_t MaterialWriter::image(const std::string& file) {
  const auto [found, is_new] = images_.try_emplace(file);
  if (is_new) found->second = draft_.add("images", picture_(file));
  return found->second;
}

int MaterialWriter::source(const Map& map) {
  if (!map) return -1;
  const auto [found, is_new] = sources_.try_emplace(map.file);
  if (is_new) {
    found->second = static_cast<int>(draft_.sources.size());
    draft_.sources.push_back(picture_(map.file));
  }
  return found->second;
}

/// An image that is mixed from others once threads may run.
std::size_t MaterialWriter::mixture(Json recipe) {
  const auto [found, is_new] = mixtures_.try_emplace(recipe.dump());
  if (is_new) {
    found->second = draft_.add("images", Json::object());
    recipe["image"] = found->second;
    draft_.mixtures.push_back(std::move(recipe));
  }
  return found->second;
}

Json MaterialWriter::texture_of_image(const Map& map, std::size_t image) {
  constexpr int kRepeat = 10497, kClamp = 33071, kMirror = 33648;
  const int wrap = map.is_clamped ? kClamp : map.is_mirrored ? kMirror : kRepeat;
  const auto [found, is_new] = textures_.try_emplace(fmt::format("{} {}", image, wrap));
  if (is_new) {
    const std::size_t sampler = draft_.add("samplers", {{"wrapS", wrap}, {"wrapT", wrap}});
    found->second = draft_.add("textures", {{"source", image}, {"sampler", sampler}});
  }
  Json info{{"index", found->second}};
  if (map.uv_set != 0) info["texCoord"] = map.uv_set;
  if (map.scale != vec2(1.0f) || map.offset != vec2(0.0f)) {
    // v' = s v + o upwards is 1 - v' = s (1 - v) + 1 - s - o downwards.
    info["extensions"]["KHR_texture_transform"] = {{"scale", {map.scale.x, map.scale.y}},
                                                   {"offset", {map.offset.x, 1.0f - map.scale.y - map.offset.y}}};
    draft_.use_extension("KHR_texture_transform");
  }
  return info;
}

Json MaterialWriter::texture(const Map& map) { return texture_of_image(map, image(map.file)); }

Json& MaterialWriter::extension(Json& material, const char* name) {
  draft_.use_extension(name);
  Json& found = material["extensions"][name];
  if (found.is_null()) found = Json::object();
  return found;
}

void MaterialWriter::write_color(const Look& look, Json& material) {
  const vec3 color = glm::min(finite(look.color), vec3(1.0f));
  Json& pbr = material["pbrMetallicRoughness"];
  pbr["baseColorFactor"] = {color.x, color.y, color.z, unit(look.opacity)};
  if (look.opacity_map && look.opacity_map.file != look.color_map.file) {
    const std::size_t mixed =
        mixture({{"kind", "cover"}, {"color", source(look.color_map)}, {"opacity", source(look.opacity_map)}});
    pbr["baseColorTexture"] = texture_of_image(look.color_map ? look.color_map : look.opacity_map, mixed);
  } else if (look.color_map) {
    pbr["baseColorTexture"] = texture(look.color_map);
  }
  if (look.opacity_map || unit(look.opacity) < 1.0f) material["alphaMode"] = "BLEND";
}

void MaterialWriter::write_roughness(const Look& look, Json& pbr) {
  if (look.packed_map) {
    pbr["metallicRoughnessTexture"] = texture(look.packed_map);
  } else if (look.roughness_map && !look.metallic_map && pbr["metallicFactor"] == 0.0f) {
    pbr["metallicRoughnessTexture"] = texture(look.roughness_map);  // its blue does not count
  } else if (look.roughness_map || look.metallic_map) {
    const std::size_t mixed =
        mixture({{"kind", "pack"}, {"roughness", source(look.roughness_map)}, {"metallic", source(look.metallic_map)}});
    pbr["metallicRoughnessTexture"] =
        texture_of_image(look.roughness_map ? look.roughness_map : look.metallic_map, mixed);
  }
}

void MaterialWriter::write_surface(const Look& look, Json& material) {
  Json& pbr = material["pbrMetallicRoughness"];
  const bool has_metal_map = look.metallic_map || look.packed_map;
  const bool has_rough_map = look.roughness_map || look.packed_map;
  pbr["metallicFactor"] = unit(look.metallic.value_or(has_metal_map ? 1.0f : 0.0f));
  pbr["roughnessFactor"] = unit(look.roughness.value_or(has_rough_map ? 1.0f : kPlainRoughness));
  write_roughness(look, pbr);
  if (look.ior && *look.ior > 1.0f && *look.ior != 1.5f && std::isfinite(*look.ior)) {
    extension(material, "KHR_materials_ior")["ior"] = *look.ior;
  }
}

void MaterialWriter::write_phong(const Look& look, Json& material) {
  Json& pbr = material["pbrMetallicRoughness"];
  pbr["metallicFactor"] = 0.0f;
  pbr["roughnessFactor"] = roughness_of_shininess(look.shininess.value_or(0.0f));
  const vec3 specular = finite(look.specular.value_or(vec3(look.specular_map ? 1.0f : 0.5f)));
  if (specular == vec3(0.5f) && !look.specular_map) return;
  Json& mirror = extension(material, "KHR_materials_specular");
  if (specular == vec3(0.0f)) {
    mirror["specularFactor"] = 0.0f;
    return;
  }
  // F0 of index 1.5 is 0.04.
  mirror["specularColorFactor"] = list(2.0f * glm::min(specular, vec3(1.0f)));
  if (look.specular_map) mirror["specularColorTexture"] = texture(look.specular_map);
}

void MaterialWriter::write_layers(const Look& look, Json& material) {
  if (look.sheen > 0.0f || look.sheen_map) {
    Json& sheen = extension(material, "KHR_materials_sheen");
    const float amount = look.sheen > 0.0f ? unit(look.sheen) : 1.0f;
    sheen = {{"sheenColorFactor", {amount, amount, amount}}, {"sheenRoughnessFactor", 0.5f}};
    if (look.sheen_map) sheen["sheenColorTexture"] = texture(look.sheen_map);
  }
  if (look.clearcoat > 0.0f || look.clearcoat_map) {
    Json& coat = extension(material, "KHR_materials_clearcoat");
    coat["clearcoatFactor"] = look.clearcoat > 0.0f ? unit(look.clearcoat) : 1.0f;
    coat["clearcoatRoughnessFactor"] = unit(look.clearcoat_roughness);
    if (look.clearcoat_map) coat["clearcoatTexture"] = texture(look.clearcoat_map);
  }
  if (look.anisotropy > 0.0f) {
    Json& anisotropy = extension(material, "KHR_materials_anisotropy");
    anisotropy["anisotropyStrength"] = unit(look.anisotropy);
    // A full turn is 1.
    if (std::isfinite(look.anisotropy_turns)) anisotropy["anisotropyRotation"] = 2.0f * kPi * look.anisotropy_turns;
  }
  if (look.transmission > 0.0f) {
    extension(material, "KHR_materials_transmission")["transmissionFactor"] = unit(look.transmission);
  }
}

void MaterialWriter::write_bumps(const Look& look, Json& material) {
  if (look.normal_map) {
    Json info = texture(look.normal_map);
    if (look.normal_map.strength != 1.0f) info["scale"] = look.normal_map.strength;
    material["normalTexture"] = std::move(info);
  } else if (look.bump_map) {
    const std::size_t relief =
        mixture({{"kind", "relief"}, {"source", source(look.bump_map)}, {"strength", look.bump_map.strength}});
    material["normalTexture"] = texture_of_image(look.bump_map, relief);
  }
  if (look.occlusion_map) material["occlusionTexture"] = texture(look.occlusion_map);
}

std::size_t MaterialWriter::add(const Look& look) {
  Json material{{"name", look.name}};
  // None of these formats says that a surface is seen from one side only.
  material["doubleSided"] = true;
  write_color(look, material);
  if (look.is_physical()) {
    write_surface(look, material);
  } else {
    write_phong(look, material);
  }
  write_layers(look, material);
  write_bumps(look, material);
  vec3 emission = finite(look.emission);
  if (look.emission_map && emission == vec3(0.0f)) emission = vec3(1.0f);
  if (const float most = max_component(emission); most > 0.0f) {
    material["emissiveFactor"] = list(emission / std::max(most, 1.0f));
    if (most > 1.0f) extension(material, "KHR_materials_emissive_strength")["emissiveStrength"] = most;
    if (look.emission_map) material["emissiveTexture"] = texture(look.emission_map);
  }
  if (!look.unused.empty()) {
    draft_.diagnostics.warn(
        fmt::format("material '{}': {} is not carried over", look.name, fmt::join(look.unused, ", ")));
  }
  return draft_.add("materials", std::move(material));
}

}  // namespace candela::foreign
