#pragma once

#include <cstddef>
#include <optional>

#include "io/gltf_warnings.h"
#include "io/json_view.h"
#include "scene/scene.h"

namespace candela::io {

/// One material with everything its extensions say. Numbers outside their range are brought there, and what the
/// extensions exclude is left out, each with a warning that names the material (by its name, else by `index`). Texture
/// slots hold the file's texture indices.
///
/// Extensions that exclude each other: KHR_materials_unlit wins over all that shape reflection, and
/// KHR_materials_pbrSpecularGlossiness over the rest of them, metallic-roughness included.
///
/// `"extras": {"candela": {"conductor": "gold"}}` makes the metallic part a measured metal (find_metal).
Material read_material(const JsonView& root, const JsonView& json, std::size_t index, Warnings& warnings);

/// The index of a texture's image: of an extension that has it in another form, before the one that every reader knows.
/// Empty where there is none.
std::optional<JsonView> texture_source(const JsonView& texture);

}  // namespace candela::io
