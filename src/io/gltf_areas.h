#pragma once

#include <optional>

#include "io/gltf_warnings.h"
#include "scene/scene.h"

namespace candela::io {

/// A lamp of EXT_lights_area as a mesh that glows: a rectangle or a disc about the origin that shines along -z, in
/// metres, with a black material of its own (Material::is_lamp). Adds both to `scene` and returns the mesh's index; of
/// a lamp without area it is empty. Numbers out of range are clamped, each with a warning.
int add_area_light(const JsonView& json, Scene& scene, Warnings& warnings);

/// Where that mesh stands: as its node is turned, and larger by the largest of its scales, the same to all sides. Empty
/// where nothing is left of it.
std::optional<mat4> place_of_area_light(const mat4& world_from_node);

}  // namespace candela::io
