#include "candela/light.h"

#include <fmt/format.h>

#include <memory>
#include <utility>

#include "base/file.h"
#include "ibl/cube.h"
#include "image/cube_file.h"
#include "image/image_file.h"
#include "path/capture.h"

namespace candela {

namespace {

void warn(const Job& job, const Diagnostic& warning) {
  if (job.diagnostics != nullptr) job.diagnostics->warn(warning.message, warning.where);
}

/// A panorama of a file.
Environment make_panorama(Image image, const std::string& path, const Job& job) {
  check_panorama(image, path);
  const ImageFormat format = sniff_image_format(read_head(parse_image_name(path).path, kSniffedBytes));
  if (is_display_format(format)) {
    warn(job, {"8 or 16 bits per channel end at white: what is brighter, the sun above all, is missing", path});
  }
  Environment environment;
  environment.name = path;
  environment.map = std::make_shared<Image>(std::move(image));
  return environment;
}

Environment adjusted(Environment environment, const LightChoice& choice) {
  environment.rotation += choice.rotation;
  environment.intensity *= choice.intensity;
  return environment;
}

LoadedLight capture(const LightChoice& choice, int size, const Job& job) {
  path::check_built();
  auto scene = std::make_shared<const Scene>(load(choice.scene, job.diagnostics, choice.load));
  const bool has_own_light = choice.environment.empty() && scene->image_light.has_value();
  const Environment environment =
      has_own_light ? scene->image_light->environment
                    : make_environment(choice.environment.empty() ? "studio" : choice.environment, job.diagnostics);
  const path::Tracer tracer(std::move(scene), adjusted(environment, choice));
  return trace_light(tracer, choice.position, choice.samples, size, job);
}

void keep_texels(const CubeFaces& faces, ibl::Bake& bake) {
  if (bake.levels.at(0).roughness != 0.0) return;
  int size = faces[0].width;
  if (size % bake.specular.size() != 0 || (size & (size - 1)) != 0) return;
  const Cubemap halved = ibl::cube_mips(faces);
  std::size_t level = 0;
  for (; size > bake.specular.size(); size /= 2) ++level;
  bake.specular.levels[0] = halved.levels.at(level);
}

void check_bound(const ibl::Bake& bake, double error) {
  const auto look = [&](const std::string& name, const ibl::Level& level) {
    if (level.holds) return;
    throw Error(fmt::format("{} errs by {:.2g} %, which {} refinements did not bring below {:.2g} %", name,
                            100.0 * level.proof.at_texels.max, level.refinements, 100.0 * error),
                "--error");
  };
  for (const ibl::Level& level : bake.levels) look(fmt::format("roughness {:.4g}", level.roughness), level);
  for (const ibl::Level& level : bake.sheen_levels) look(fmt::format("sheen {:.4g}", level.roughness), level);
  look("irradiance", bake.irradiance_level);
}

}  // namespace

LoadedLight trace_light(const path::Tracer& tracer, vec3 position, int samples, int size, const Job& job) {
  path::Settings settings;
  settings.samples = samples;
  LoadedLight light;
  light.faces = path::capture_environment(tracer, position, size, settings, job).levels.at(0);
  light.source = ibl::make_source(*light.faces);
  return light;
}

LoadedLight load_light(const LightChoice& choice, int size, const Job& job) {
  if (!choice.scene.empty()) return capture(choice, size, job);
  LoadedLight light;
  const bool is_built_in = is_built_in_environment(choice.environment);
  EnvironmentFile file;
  check_environment_name(choice.environment);
  if (!is_built_in) file = read_clean_environment(choice.environment, choice.axes);
  for (const Diagnostic& warning : file.warnings) warn(job, warning);
  if (!file.cube.empty()) {
    light.faces = std::move(file.cube.levels.at(0));
    for (Image& face : *light.faces)
      for (float& v : face.pixels) v *= choice.intensity;
    light.source = ibl::make_source(*light.faces);
    light.source.rotation += static_cast<double>(choice.rotation);
    if (choice.rotation != 0.0f) light.faces.reset();
    return light;
  }
  if (choice.axes) throw Error(choice.environment + " is no cube map", "--axes");
  const Environment environment =
      adjusted(is_built_in ? make_environment(choice.environment)
                           : make_panorama(std::move(file.panorama), choice.environment, job),
               choice);
  light.source = ibl::make_source(environment);
  light.is_panorama = environment.map != nullptr && environment.rotation == 0.0f && environment.suns.empty();
  return light;
}

ibl::Bake bake_light(const LoadedLight& light, const ibl::BakeSettings& settings, const Job& job) {
  ibl::Bake bake = ibl::bake(light.source, settings, job);
  if (light.faces) keep_texels(*light.faces, bake);
  check_bound(bake, settings.error);
  return bake;
}

}  // namespace candela
