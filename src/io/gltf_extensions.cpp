#include "io/gltf_extensions.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string_view>

#include "scene/material_table.h"

namespace candela::io {

namespace {

/// Beside those of the table of materials.
constexpr auto kSupported = std::to_array<std::string_view>({
    "EXT_camera_physical",
    "EXT_lights_area",
    "EXT_lights_ies",
    "EXT_lights_image_based",
    "EXT_mesh_gpu_instancing",
    "EXT_mesh_primitive_restart",
    "EXT_meshopt_compression",
    "EXT_texture_astc",
    "EXT_texture_avif",
    "EXT_texture_webp",
    "KHR_accessor_float16",
    "KHR_accessor_float64",
    "KHR_animation_pointer",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_scatter",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume_scatter",
    "KHR_mesh_primitive_restart",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
    "KHR_texture_basisu",
    "KHR_texture_transform",
});
/// Describe the asset, what it sounds like, how it moves when someone plays with it, or another way to store what the
/// file has in a form that is read: no pixel of a picture depends on them. A name that ends in _ stands for a family.
constexpr auto kUnseen = std::to_array<std::string_view>({
    "AGI_articulations",
    "AGI_stk_metadata",
    "EXT_feature_metadata",
    "EXT_instance_features",
    "EXT_mesh_features",
    "EXT_mesh_manifold",
    "EXT_structural_metadata",
    "FB_",
    "KHR_audio",
    "KHR_audio_",
    "KHR_collision_shapes",
    "KHR_implicit_shapes",
    "KHR_interactivity",
    "KHR_interactivity_",
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "KHR_physics_",
    "KHR_rigid_bodies",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "MOZ_hubs_components",
    "MSFT_audio_emitter",
    "MSFT_collision_mesh",
    "MSFT_lod",
    "MSFT_packing_normalRoughnessMetallic",
    "MSFT_packing_occlusionRoughnessMetallic",
    "MSFT_physics",
    "MSFT_rigid_bodies",
    "MSFT_texture_dds",
    "OMI_",
    "VRMC_springBone",
    "VRMC_vrm",
    "VRMC_vrm_animation",
});
/// Of them, images in another form: unseen where the file has them in a form that is read too, needed where it requires
/// them.
constexpr auto kOtherImages = std::to_array<std::string_view>({"MSFT_texture_dds"});

bool is_in(std::span<const std::string_view> list, std::string_view name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}
bool is_unseen(std::string_view name) {
  return std::any_of(kUnseen.begin(), kUnseen.end(), [name](std::string_view entry) {
    return entry.ends_with('_') ? name.starts_with(entry) : name == entry;
  });
}

}  // namespace

bool is_supported_extension(std::string_view name) {
  return is_in(kSupported, name) ||
         std::any_of(kMaterialProperties.begin(), kMaterialProperties.end(),
                     [name](const MaterialProperty& row) { return extension_of_place(row.source.place) == name; });
}
bool is_unseen_extension(std::string_view name) { return is_unseen(name); }

void sort_extensions(const GltfDocument& document, FileInfo& info) {
  std::optional<std::map<std::string, std::set<std::string>>> places;
  for (const std::string& name : info.extensions_used) {
    if (is_supported_extension(name)) continue;
    if (!places) places = document.extension_places();
    const auto found = places->find(name);
    const bool is_about_asset = found != places->end() && found->second == std::set<std::string>{"asset"};
    (is_unseen(name) || is_about_asset ? info.extensions_unseen : info.extensions_ignored).push_back(name);
  }
  for (const std::string& name : info.extensions_required) {
    const bool is_needed = !is_supported_extension(name) && (!is_unseen(name) || is_in(kOtherImages, name));
    if (is_needed) info.extensions_missing.push_back(name);
  }
}

void check_extensions(const JsonView& root, const FileInfo& info, bool refuse_unknown, Warnings& warnings) {
  for (const std::string& name : info.extensions_missing) {
    const JsonView list = root.at("extensionsRequired");
    const std::string message = fmt::format("the file requires {}, which is not supported", name);
    if (refuse_unknown) throw list.error(message);
    warnings.warn(message, list);
  }
  for (const std::string& name : info.extensions_ignored) {
    const auto& missing = info.extensions_missing;
    if (std::find(missing.begin(), missing.end(), name) != missing.end()) continue;
    warnings.warn(fmt::format("{} is not supported and will be ignored", name), root.at("extensionsUsed"));
  }
  for (const std::string& name : info.extensions_unseen) {
    const auto& missing = info.extensions_missing;
    if (std::find(missing.begin(), missing.end(), name) != missing.end()) continue;
    warnings.note(fmt::format("{} changes no pixel and is not read", name), root.at("extensionsUsed"));
  }
}

}  // namespace candela::io
