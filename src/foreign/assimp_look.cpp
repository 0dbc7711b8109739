#include "foreign/assimp_look.h"

#include <assimp/commonMetaData.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace candela::foreign {

namespace {

std::optional<float> number(const aiMaterial& material, const char* key, unsigned type, unsigned index) {
  ai_real value = 0;
  if (material.Get(key, type, index, value) != aiReturn_SUCCESS || !std::isfinite(value)) return std::nullopt;
  return static_cast<float>(value);
}
std::optional<vec3> color(const aiMaterial& material, const char* key, unsigned type, unsigned index) {
  aiColor4D value;
  if (material.Get(key, type, index, value) != aiReturn_SUCCESS) return std::nullopt;
  return vec3(value.r, value.g, value.b);
}

Map map_of(const aiScene& scene, const aiMaterial& material, aiTextureType type) {
  aiString path;
  if (material.GetTexture(type, 0, &path) != aiReturn_SUCCESS || path.length == 0) return {};
  Map map;
  map.file = path.C_Str();
  // A texture in the file may be asked for by its number or by its name.
  if (const auto [texture, index] = scene.GetEmbeddedTextureAndIndex(path.C_Str()); texture != nullptr && index >= 0) {
    map.file = "*" + std::to_string(index);
  }
  int set = 0, mode = aiTextureMapMode_Wrap;
  if (material.Get(AI_MATKEY_UVWSRC(type, 0), set) == aiReturn_SUCCESS) map.uv_set = std::max(set, 0);
  material.Get(AI_MATKEY_MAPPINGMODE_U(type, 0), mode);
  map.is_clamped = mode == aiTextureMapMode_Clamp || mode == aiTextureMapMode_Decal;
  map.is_mirrored = mode == aiTextureMapMode_Mirror;
  aiUVTransform transform;
  if (material.Get(AI_MATKEY_UVTRANSFORM(type, 0), transform) == aiReturn_SUCCESS) {
    map.scale = {transform.mScaling.x, transform.mScaling.y};
    map.offset = {transform.mTranslation.x, transform.mTranslation.y};
  }
  return map;
}

Map first_map(const aiScene& scene, const aiMaterial& material, std::initializer_list<aiTextureType> types) {
  for (const aiTextureType type : types) {
    if (Map map = map_of(scene, material, type)) return map;
  }
  return {};
}

/// Which texture types the look has no place for.
void list_unused(const aiMaterial& material, Look& look) {
  constexpr std::pair<aiTextureType, const char*> kUnused[] = {{aiTextureType_DISPLACEMENT, "a displacement map"},
                                                               {aiTextureType_LIGHTMAP, "a light map"},
                                                               {aiTextureType_REFLECTION, "a reflection map"},
                                                               {aiTextureType_SHININESS, "a shininess map"}};
  for (const auto& [type, name] : kUnused) {
    if (material.GetTextureCount(type) > 0) look.unused.emplace_back(name);
  }
}

void read_maps(const aiScene& scene, const aiMaterial& material, Look& look) {
  look.color_map = first_map(scene, material, {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE});
  look.opacity_map = map_of(scene, material, aiTextureType_OPACITY);
  look.specular_map = map_of(scene, material, aiTextureType_SPECULAR);
  look.emission_map = first_map(scene, material, {aiTextureType_EMISSION_COLOR, aiTextureType_EMISSIVE});
  look.normal_map = first_map(scene, material, {aiTextureType_NORMAL_CAMERA, aiTextureType_NORMALS});
  look.bump_map = map_of(scene, material, aiTextureType_HEIGHT);
  look.roughness_map = map_of(scene, material, aiTextureType_DIFFUSE_ROUGHNESS);
  look.metallic_map = map_of(scene, material, aiTextureType_METALNESS);
  look.occlusion_map = map_of(scene, material, aiTextureType_AMBIENT_OCCLUSION);
  if (const auto strength = number(material, AI_MATKEY_BUMPSCALING)) {
    look.normal_map.strength = look.bump_map.strength = *strength;
  }
}

/// Blender keeps metalness where Phong has the share of a mirror.
bool is_by_blender(const aiScene& scene) {
  aiString generator;
  return scene.mMetaData != nullptr && scene.mMetaData->Get(AI_METADATA_SOURCE_GENERATOR, generator) &&
         std::string_view(generator.C_Str()).starts_with("Blender");
}

}  // namespace

Look plain_look(bool has_colors) {
  Look look;
  look.color = vec3(has_colors ? 1.0f : 0.8f);
  look.roughness = 0.5f;
  return look;
}

Look look_of(const aiScene& scene, const aiMaterial& material, Format format) {
  Look look;
  look.name = material.GetName().C_Str();
  read_maps(scene, material, look);
  look.metallic = number(material, AI_MATKEY_METALLIC_FACTOR);
  look.roughness = number(material, AI_MATKEY_ROUGHNESS_FACTOR);
  const auto base = color(material, AI_MATKEY_BASE_COLOR);
  const auto diffuse = color(material, AI_MATKEY_COLOR_DIFFUSE);
  // In all these formats a texture stands in place of the colour.
  look.color = look.color_map ? vec3(1.0f) : base.value_or(diffuse.value_or(look.color));
  int model = aiShadingMode_Phong;
  material.Get(AI_MATKEY_SHADING_MODEL, model);
  // Assimp writes Gouraud for what files call Lambert.
  const bool has_mirror = model != aiShadingMode_Gouraud && model != aiShadingMode_Flat;
  look.specular = has_mirror ? color(material, AI_MATKEY_COLOR_SPECULAR) : vec3(0.0f);
  if (const auto strength = number(material, AI_MATKEY_SHININESS_STRENGTH); strength && look.specular && has_mirror) {
    look.specular = *look.specular * std::max(*strength, 0.0f);
  }
  look.shininess = number(material, AI_MATKEY_SHININESS);
  if (is_by_blender(scene) && !look.metallic) look.metallic = number(material, AI_MATKEY_REFLECTIVITY);
  look.ior = number(material, AI_MATKEY_REFRACTI);
  look.emission = color(material, AI_MATKEY_COLOR_EMISSIVE).value_or(vec3(0.0f));
  if (const auto strength = number(material, AI_MATKEY_EMISSIVE_INTENSITY)) look.emission *= *strength;
  look.clearcoat = number(material, AI_MATKEY_CLEARCOAT_FACTOR).value_or(0.0f);
  look.clearcoat_roughness = number(material, AI_MATKEY_CLEARCOAT_ROUGHNESS_FACTOR).value_or(0.0f);
  look.transmission = number(material, AI_MATKEY_TRANSMISSION_FACTOR).value_or(0.0f);
  look.opacity = number(material, AI_MATKEY_OPACITY).value_or(1.0f);
  if (look.opacity <= 0.0f) {
    // Writers disagree about which end is opaque, and nobody models what cannot be seen.
    look.opacity = 1.0f;
    look.unused.emplace_back("an opacity of 0");
  }
  // Of a Lambert surface Assimp makes a roughness all the same.
  if (!has_mirror && !base && !look.metallic) look.roughness.reset();
  if (format == Format::three_mf) look.roughness = plain_look(false).roughness;
  list_unused(material, look);
  return look;
}

}  // namespace candela::foreign
