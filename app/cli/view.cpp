#include <filesystem>
#include <memory>

#include "cli/option.h"
#include "cli/values.h"
#include "cli/verbs.h"
#include "cli/viewer.h"

namespace candela::cli {

namespace fs = std::filesystem;

Verb add_view(Command& command) {
  const auto options = std::make_shared<ViewOptions>();
  command.text("SCENE", options->scene, "A file (" + kSceneFiles + ") or a built-in demo:NAME")
      .choices(demo_words())
      .required();
  add_value(
      command, "--env", "FILE|NAME", options->environment, [](const std::string& value) { return value; },
      "An .exr (:LAYER) or .hdr, a cube map, or studio, sky, furnace, none [the scene's wish, else studio]")
      .choices(environment_words());
  add_value(command, "--size", "WxH", options->size, parse_size, "Of the window, pixels [1280x720]");
  const auto folder = [](const std::string& value) {
    if (!fs::is_directory(value)) throw UsageError("is no folder: " + value);
    return value;
  };
  add_value(command, "--shaders", "DIR", options->shader_folder, folder,
            "For development: read shaders from there, and again whenever they change");
  add_root(command, options->root);
  add_texture_memory(command, options->texture_memory);
  add_scene_choice(command, options->scene_choice);
  add_measures(command, options->measures);
  add_value(command, "--frames", "N", options->frames, count_within(1, 1000000),
            "Close after N frames, and say how long they took");
  command.footer(
      R"(Drag turns the scene, the wheel comes closer. Space starts and stops its first animation, S saves the picture as
NAME.png, R reads --shaders again, Escape closes.

Examples:
  candela view helmet.glb
  candela view helmet.glb --env sky --size 800x600
  candela view demo:materials --shaders src/raster/shaders)");
  return [options] {
    if (options->scene.empty()) throw UsageError("SCENE: the name is empty");
    show(*options);
  };
}

}  // namespace candela::cli
