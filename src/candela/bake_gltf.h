#pragma once

#include <filesystem>

#include "candela/bake.h"

namespace candela {

/// Writes `environment.gltf`, whose scene EXT_lights_image_based lights with the bake, and its faces in RGBD. Of three
/// bands of harmonics or more, the first three.
EncodingLoss write_gltf_light(const std::filesystem::path& folder, const BakeResult& result);

}  // namespace candela
