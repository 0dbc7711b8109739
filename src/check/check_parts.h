#pragma once

#include <vector>

#include "check/check.h"
#include "check/check_samples.h"

// The parts of check_asset, one per theme; each appends what it finds.
namespace candela::check {

void check_surfaces(const Scene& scene, const std::vector<MaterialSurface>& surfaces, const Limits& limits,
                    std::vector<Finding>& findings);
void check_textures(const Scene& scene, const std::vector<MaterialSurface>& surfaces, std::vector<Finding>& findings);
/// What texture files say of themselves, against what their slots are.
void check_texture_files(const CheckInput& input, std::vector<Finding>& findings);
void check_normal_maps(const Scene& scene, const std::vector<MaterialSurface>& surfaces,
                       std::vector<Finding>& findings);
void check_volumes(const Scene& scene, std::vector<Finding>& findings);
void check_lights(const Scene& scene, std::vector<Finding>& findings);
/// Light of EXT_lights_image_based, said twice.
void check_image_light(const CheckInput& input, std::vector<Finding>& findings);
/// How large it is, against limits that were asked for.
void check_size(const CheckInput& input, std::vector<Finding>& findings);
void check_file(const CheckInput& input, std::vector<Finding>& findings);

}  // namespace candela::check
