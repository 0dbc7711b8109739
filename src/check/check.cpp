#include "check/check.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/parallel.h"
#include "check/check_parts.h"

namespace candela::check {

const char* severity_name(Severity severity) {
  switch (severity) {
    case Severity::note:
      return "note";
    case Severity::warning:
      return "warning";
    case Severity::error:
      return "error";
  }
  return "";
}

std::string material_label(const Scene& scene, int material) {
  const auto index = static_cast<std::size_t>(material);
  const std::string& name = scene.materials[index].name;
  return name.empty() ? fmt::format("material {}", number_of(scene.materials, index))
                      : fmt::format("material '{}'", name);
}

std::string texture_label(const Scene& scene, int texture, const FileSurvey* survey) {
  const auto index = static_cast<std::size_t>(texture);
  const Texture& t = scene.textures[index];
  std::string name = t.name;
  const auto image = static_cast<std::size_t>(t.image);
  if (name.empty() && survey != nullptr && image < survey->images.size()) name = survey->images[image].name;
  return name.empty() ? fmt::format("texture {}", number_of(scene.textures, index)) : fmt::format("texture '{}'", name);
}

std::vector<Finding> check_asset(const CheckInput& input) {
  const StopScope scope(input.stop);
  std::vector<Finding> findings;
  const std::vector<MaterialSurface> surfaces = material_surfaces(input.scene);
  check_file(input, findings);
  StopScope::check();
  check_textures(input.scene, surfaces, findings);
  check_texture_files(input, findings);
  StopScope::check();
  check_normal_maps(input.scene, surfaces, findings);
  StopScope::check();
  check_surfaces(input.scene, surfaces, findings);
  StopScope::check();
  check_volumes(input.scene, findings);
  StopScope::check();
  check_lights(input.scene, findings);
  check_image_light(input, findings);
  std::stable_sort(findings.begin(), findings.end(),
                   [](const Finding& a, const Finding& b) { return a.severity > b.severity; });
  return findings;
}

}  // namespace candela::check
