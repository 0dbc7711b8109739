#include "render.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "background.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "cli/render_options.h"
#include "picture.h"
#include "scene.h"

namespace candela::python {

namespace {

/// Options of `candela render` that are of files, of sets of pictures or of a terminal.
constexpr auto kNotOfOnePicture = std::to_array<std::string_view>({"--output",
                                                                   "--scene",
                                                                   "--unit",
                                                                   "--up",
                                                                   "--variant",
                                                                   "--variants",
                                                                   "--turntable",
                                                                   "--sequence",
                                                                   "--fps",
                                                                   "--frame-time",
                                                                   "--animation",
                                                                   "--animations",
                                                                   "--shutter",
                                                                   "--root",
                                                                   "--stats",
                                                                   "--quiet",
                                                                   "--strict",
                                                                   "--jobs",
                                                                   "--texture-memory",
                                                                   "--help",
                                                                   "--write-cameras",
                                                                   "--cameras",
                                                                   "--shaders",
                                                                   "--no-cache",
                                                                   "-o",
                                                                   "-q",
                                                                   "-h",
                                                                   "--part",
                                                                   "--checkpoint",
                                                                   "--resume",
                                                                   "--dataset",
                                                                   "--instances"});

/// What these options mean, with all their checks, as for `candela render`.
cli::RenderOptions read_options(std::vector<std::string> arguments) {
  for (const std::string& argument : arguments) {
    const std::string_view name = std::string_view(argument).substr(0, argument.find('='));
    if (std::find(kNotOfOnePicture.begin(), kNotOfOnePicture.end(), name) != kNotOfOnePicture.end()) {
      throw Error("is no option of one picture of a scene", std::string(name));
    }
  }
  // A scene and a file that nobody opens: what the options are of is there already.
  arguments.insert(arguments.begin(), {"render", "demo:spheres", "--output=picture.exr"});
  cli::RenderOptions options;
  cli::CommandLine line("candela", "", version());
  cli::Command command = line.add_verb("render", "");
  cli::add_render_options(command, options);
  line.parse(arguments);
  cli::finish_options(command, options);
  return options;
}

PictureOf render(const SharedScene& scene, const std::vector<std::string>& arguments,
                 const std::optional<CameraAt>& camera, const std::optional<EnvironmentOf>& environment,
                 bool knows_objects, const nb::object& progress) {
  cli::RenderOptions options = read_options(arguments);
  Shot& shot = options.shot;
  std::shared_ptr<const Environment> light;
  if (environment) {
    light = environment->environment;
  } else if (!shot.environment && scene->environment) {
    light = scene->environment->environment;
  } else if (!shot.environment) {
    shot.environment = scene->environment_name;
  }
  if (camera) {
    PosedCamera& posed = shot.cameras.emplace_back();
    posed.view = camera->view;
    posed.name = camera->name;
    if (camera->size && *camera->size != shot.size) {
      throw Error("the camera is for pictures of " + std::to_string(camera->size->x) + " by " +
                      std::to_string(camera->size->y) + " pixels",
                  "size");
    }
  }
  if (knows_objects) {
    shot.has_masks = true;
    shot.layers.insert({Layer::instance, Layer::depth});
  }
  require_memory(picture_bytes(shot), available_memory(), "the picture", "size");
  if (shot.has_many_pictures()) throw Error("one picture at a time", "camera");
  const ivec2 size = shot.size;
  const LiveScene::Moment moment = scene->live.begin(std::move(shot));
  auto picture = std::make_shared<LivePicture>();
  Diagnostics diagnostics;
  run_in_background(progress, [&](const Job& job) {
    const ThreadLimit limit(options.threads);
    *picture = moment.render(light, &diagnostics, job);
  });
  tell_warnings(diagnostics);
  return {std::move(picture), size};
}

}  // namespace

void bind_render(nb::module_& module) {
  module.def(
      "render", &render, nb::arg("scene"), nb::arg("arguments"), nb::arg("camera").none(),
      nb::arg("environment").none(), nb::arg("objects"), nb::arg("progress").none(),
      nb::sig("def render(scene: Scene, arguments: list[str], camera: PosedCamera | None, environment: Environment "
              "| None, objects: bool, progress: collections.abc.Callable[[Progress], object] | None) -> Picture"));
  nb::dict spellings;
  for (const Spelling& row : kSpellings) {
    spellings[nb::str(row.keyword.data(), row.keyword.size())] = nb::str(row.option.data(), row.option.size());
  }
  module.attr("spellings") = spellings;
  module.def("layer_names", [] {
    std::vector<std::string> names;
    names.reserve(kLayers.size());
    for (const LayerInfo& layer : kLayers) names.emplace_back(layer.name);
    return names;
  });
}

}  // namespace candela::python
