#include "cli/scene_options.h"

#include "candela/cache.h"
#include "cli/camera_options.h"
#include "cli/option.h"
#include "cli/render_outputs.h"

namespace candela::cli {

void add_scene_argument(Command& command, RenderOptions& options) {
  options.scenes.resize(1);
  command.text("SCENE", options.scenes[0], "A file (" + kSceneFiles + ") or a built-in demo:NAME")
      .choices(demo_words())
      .required();
}

void add_scene_options(Command& command, RenderOptions& options) {
  const std::string group = "Scene";
  const auto text = [](const std::string& value) { return value; };
  Shot& shot = options.shot;
  add_scene_choice(command, shot.load.scene).group(group);
  add_measures(command, shot.load.measures, group);
  add_value(command, "--variant", "NAME", shot.load.variant, text, "One of the file's material variants").group(group);
  add_value(command, "--frame-time", "1.5s", shot.moment_s, parse_moment, "The moment of the animation [at rest]")
      .group(group);
  add_value(command, "--animation", "NAME|INDEX|all", shot.animation, text, "Which animation [the first]").group(group);
  add_root(command, shot.load.root).group(group);
  add_texture_memory(command, shot.load.texture_memory).group(group);
}

void finish_scene_options(const Command& command, RenderOptions& options) {
  Shot& shot = options.shot;
  shot.scene = options.scenes.front();
  if (options.keeps_cache) shot.drawn.cache = cache_folder();
  if (shot.drawn.light_radius > 0.0f) shot.drawn.has_soft_shadows = true;
  shot.focuses_on_target = command.has("--focus-distance");
  finish_camera_options(command, options);
  finish_light_options(options);
}

Inputs scene_inputs(const RenderOptions& options) {
  const Shot& shot = options.shot;
  Inputs inputs;
  inputs.add(shot.scene, "the scene");
  add_scene_files({shot.scene}, shot.load.root, inputs);
  if (options.camera_file) inputs.add(*options.camera_file, "the cameras");
  inputs.add_environment(shot.environment.value_or(""));
  return inputs;
}

}  // namespace candela::cli
