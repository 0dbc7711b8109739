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

std::vector<Finding> check_asset(const CheckInput& input, const Job& job) {
  const StopScope scope(job.stop);
  std::vector<Finding> findings;
  const Scene& scene = input.scene;
  const Stopwatch watch;
  const auto begin = [&](int step, const char* what) {
    constexpr int kSteps = 6;
    StopScope::check();
    job.report({.fraction = static_cast<double>(step) / kSteps, .seconds = watch.seconds(), .what = what});
  };
  begin(0, "the file");
  const std::vector<MaterialSurface> surfaces = material_surfaces(scene);
  check_file(input, findings);
  check_size(input, findings);
  begin(1, "textures");
  check_textures(scene, surfaces, findings);
  check_texture_files(input, findings);
  begin(2, "normal maps");
  check_normal_maps(scene, surfaces, findings);
  begin(3, "surfaces");
  check_surfaces(scene, surfaces, input.limits, findings);
  begin(4, "bodies");
  check_volumes(scene, findings);
  begin(5, "lights");
  check_lights(scene, findings);
  check_image_light(input, findings);
  std::stable_sort(findings.begin(), findings.end(),
                   [](const Finding& a, const Finding& b) { return a.severity > b.severity; });
  return findings;
}

}  // namespace candela::check
