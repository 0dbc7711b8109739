#include <filesystem>
#include <memory>

#include "base/error.h"
#include "cli/camera_options.h"
#include "cli/option.h"
#include "cli/render_options.h"
#include "cli/values.h"
#include "cli/verbs.h"
#include "viewer/viewer.h"

namespace candela::cli {

namespace fs = std::filesystem;

namespace {

void add_scene_options(Command& command, Shot& shot) {
  const std::string group = "Scene";
  const auto named = [](const std::string& value) {
    if (value.empty()) throw UsageError("the name is empty");
    return value;
  };
  add_scene_choice(command, shot.load.scene).group(group);
  add_measures(command, shot.load.measures, group);
  add_root(command, shot.load.root).group(group);
  add_texture_memory(command, shot.load.texture_memory).group(group);
  add_value(command, "--variant", "NAME", shot.load.variant, named, "The look that it opens with [its default look]")
      .group(group);
  add_value(command, "--animation", "NAME|INDEX|all", shot.animation, named, "What moves [the first, if any]")
      .group(group);
  add_value(command, "--frame-time", "1.5s", shot.moment_s, parse_moment, "Stands still at that moment [it plays]")
      .group(group);
}

void add_window_options(Command& command, viewer::ViewOptions& o, std::string& denoiser) {
  const std::string group = "Window";
  add_value(command, "--size", "WxH", o.render.shot.size, parse_size, "Of the window, pixels [1280x720]").group(group);
  command.flag("--watch", o.is_watching, "Read model and environment again when their files change").group(group);
  command.flag("--split", o.is_split, "Show the path traced picture beside the drawn one").group(group);
  add_value(command, "--spp", "N", o.samples, count_within(1, 1 << 20), "Samples per pixel of that [1024]")
      .group(group);
  add_value(command, "--bounces", "N", o.render.shot.traced.bounces, count_within(0, 1024), "Of its paths [8]")
      .group(group);
  command
      .flag_or_value("--denoise", "[=regression|oidn|none]", denoiser,
                     "Take out its noise, by what is built in or by Open Image Denoise where installed")
      .group(group);
  add_value(command, "--frames", "N", o.frames, count_within(1, 1000000),
            "Draw N frames, say how long they took, and close")
      .group(group);
  const auto file = [](const std::string& value) {
    if (value.empty()) throw UsageError("the name is empty");
    return fs::path(value);
  };
  add_value(command, "--script", "FILE", o.script, file,
            "Play the input that stands there, a step a line: docs/viewer.md lists them")
      .group(group);
  command.help().group(group);
}

void finish(const Command& command, const std::string& denoiser, viewer::ViewOptions& o) {
  RenderOptions& render = o.render;
  Shot& shot = render.shot;
  if (shot.scene.empty()) throw UsageError("SCENE: the name is empty");
  shot.engine = Engine::raster;
  finish_look_options(command, render);
  finish_camera_options(command, render);
  finish_light_options(render);
  if (shot.probes > 0) throw UsageError("--probes: a window has none; candela render --engine raster has");
  if (command.has("--denoise") && denoiser != "none") {
    try {
      shot.denoiser = denoiser == "true" ? denoise::Method::regression : denoise::parse_method(denoiser);
    } catch (const Error& error) {
      throw UsageError("--denoise: " + std::string(error.what()));
    }
    if (const std::string why = denoise::why_not(*shot.denoiser); !why.empty()) throw Error(why, "--denoise");
  }
}

}  // namespace

Verb add_view(Command& command) {
  struct Options {
    viewer::ViewOptions view;
    std::string denoiser;
  };
  const auto options = std::make_shared<Options>();
  RenderOptions& render = options->view.render;
  Shot& shot = render.shot;
  command.text("SCENE", shot.scene, "A file (" + kSceneFiles + ") or a built-in demo:NAME")
      .choices(demo_words())
      .required();
  add_window_options(command, options->view, options->denoiser);
  add_scene_options(command, shot);
  add_camera_options(command, render, CameraPictures::window);
  add_light_options(command, render);
  add_look_options(command, render, "Look");
  add_shading_option(command, shot, "Look");
  add_quantity_option(command, shot, "Look");
  add_drawing_options(command, shot, render.keeps_cache, "Drawing");
  command.footer(
      R"(Drag turns, shift and drag moves along, the wheel comes nearer, control and drag turns the environment, a click says
what is there. F fits the subject into the window, R goes back, T shows the path traced picture beside the drawn one,
S saves the picture under a name that is free, H lists all keys, Escape closes. Models and environments can be dropped.

Examples:
  candela view helmet.glb
  candela view helmet.glb --env sky --orbit -30,15 --split
  candela view helmet.glb --watch
  candela view demo:materials --shaders src/raster/shaders)");
  return [options, command] {
    finish(command, options->denoiser, options->view);
    viewer::show(options->view);
  };
}

}  // namespace candela::cli
