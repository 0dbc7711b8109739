#include "candela/preview.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "base/parts.h"
#include "base/stopwatch.h"
#include "base/text.h"
#include "cli/inputs.h"
#include "cli/interrupt.h"
#include "cli/json_text.h"
#include "cli/option.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/render_outputs.h"
#include "cli/scene_list.h"
#include "cli/threads.h"
#include "cli/values.h"
#include "cli/verbs.h"
#include "cli/verdict_json.h"

namespace candela::cli {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

struct PreviewOptions {
  std::string scene;
  std::string output;
  PreviewSettings settings;
  std::optional<Engine> engine;  ///< else the path tracer, or the rasterizer in a build without
  std::optional<int> thumbnail;  ///< pixels a side
  bool json = false;
  bool quiet = false;
  int threads = 0;
};

Json vec3_json(vec3 v) { return {v.x, v.y, v.z}; }

Json preview_json(const Preview& p) {
  Json json = verdict_json(p.verdict);
  const Json findings = std::move(json["findings"]);
  json.erase("findings"), json.erase("readable"), json.erase("reason");
  json["size_m"] = p.bounds.empty() ? Json(nullptr) : vec3_json(p.bounds.size());
  json["bounds"] = nullptr;
  if (!p.bounds.empty()) json["bounds"] = {{"lower", vec3_json(p.bounds.lower)}, {"upper", vec3_json(p.bounds.upper)}};
  json["vertices"] = p.vertices;
  json["meshes"] = p.meshes;
  json["nodes"] = p.nodes;
  json["images"] = p.images;
  json["image_bytes"] = p.image_bytes;
  json["cameras"] = p.cameras;
  json["lights"] = p.lights;
  json["material_names"] = p.materials;
  json["variants"] = p.variants;
  json["animations"] = Json::array();
  for (const io::AnimationInfo& a : p.animations) {
    json["animations"].push_back({{"name", a.name}, {"duration_s", a.duration_s}});
  }
  json["views"] = Json::array();
  for (const PreviewView& view : p.views) {
    json["views"].push_back({{"name", view.name},
                             {"azimuth_deg", degrees(view.orbit.azimuth)},
                             {"elevation_deg", degrees(view.orbit.elevation)},
                             {"x", view.corner.x},
                             {"y", view.corner.y},
                             {"width", p.view_size},
                             {"height", p.view_size}});
  }
  json["findings"] = findings;
  return json;
}

/// A display picture, by the extension of its name; any other name is a PNG's.
void write_display(const fs::path& path, const DisplayImage& image) {
  const bool is_jpeg = has_extension(path, ".jpg") || has_extension(path, ".jpeg");
  if (is_jpeg) return write_jpeg(path, image);
  has_extension(path, ".webp") ? write_webp(path, image) : write_png(path, image);
}

void write_to(const std::string& output, const DisplayImage& image) {
  if (const std::string format = standard_output_format(output); !format.empty()) {
    return write_standard_output(format, [&](const fs::path& file) { write_display(file, image); });
  }
  const FolderFor folder(output);
  write_display(output, image);
}

Inputs inputs_of(const PreviewOptions& o) {
  Inputs inputs;
  inputs.add(o.scene, "the scene " + o.scene);
  inputs.add_environment(o.settings.environment.value_or(""));
  add_scene_files({o.scene}, o.settings.load.root, inputs);
  return inputs;
}

void check_usage(const PreviewOptions& o) {
  if (o.scene.empty()) throw UsageError("SCENE: the name is empty");
  if (o.thumbnail && o.output.empty()) throw UsageError("--thumbnail: where to is missing: -o FILE");
  if (o.thumbnail && o.json) throw UsageError("--json: a thumbnail says nothing of the model");
  const std::string piped = standard_output_format(o.output);
  if (o.json && !piped.empty()) throw UsageError("--json: standard output takes the picture: give -o FILE");
  const std::string extension = piped.empty() ? lower_extension(o.output) : piped;
  const bool is_known =
      extension == ".png" || extension == ".jpg" || extension == ".jpeg" || extension == ".webp" || extension.empty();
  // A thumbnailer chooses any name.
  if (!is_known && !o.thumbnail) throw UsageError("--output: is a .png, a .webp or a .jpg: " + o.output);
}

Engine default_engine() {
  try {
    path::check_built();
    return Engine::path;
  } catch (const Error&) {
    return Engine::raster;
  }
}

void run_preview(PreviewOptions& o) {
  check_usage(o);
  o.settings.engine = o.engine ? *o.engine : default_engine();
  check_environment_name(o.settings.environment.value_or("none"));
  const Stopwatch watch;
  const ThreadLimit threads(o.threads);
  ProgressLine progress(o.quiet);
  const Interrupt interrupt;
  Diagnostics diagnostics;
  Job job = progress.job();
  job.diagnostics = &diagnostics;
  const Inputs inputs = inputs_of(o);
  if (o.json && o.output.empty()) return print(json_text(preview_json(describe(o.scene, o.settings, job))));
  if (o.output.empty()) o.output = free_name({}, default_stem(o.scene) + "-preview", inputs).string();
  if (standard_output_format(o.output).empty()) inputs.refuse(o.output);
  check_writable(o.output);
  progress.phase("loading " + o.scene);
  if (o.thumbnail) {
    o.settings.view_size = *o.thumbnail;
    return write_to(o.output, make_thumbnail(o.scene, o.settings, job));
  }
  const Preview preview = make_preview(o.scene, o.settings, job);
  write_to(o.output, preview.sheet);
  progress.line(fmt::format("{}: {}x{} in {}", o.output, preview.sheet.width, preview.sheet.height,
                            duration_text(watch.seconds())));
  if (o.json) {
    Json json = preview_json(preview);
    json["sheet"] = o.output;
    print(json_text(json));
  }
}

}  // namespace

Verb add_preview(Command& command) {
  const auto options = std::make_shared<PreviewOptions>();
  PreviewOptions& o = *options;
  constexpr int kLeastSide = 16, kMostSide = 2048;
  command.text("SCENE", o.scene, "A file (" + kSceneFiles + ") or a built-in demo:NAME")
      .choices(demo_words())
      .required();
  command.text("-o,--output", o.output, "The sheet: a .png, .webp or .jpg; - is standard output [NAME-preview.png]")
      .type("FILE");
  command.flag("--json", o.json, "What the sheet says, for a machine; without -o no sheet is made");
  add_value(command, "--thumbnail", "N", o.thumbnail, count_within(kLeastSide, kMostSide),
            "In place of the sheet one picture of N x N pixels without words, transparent");
  add_value(command, "--size", "N", o.settings.view_size, count_within(kLeastSide, kMostSide),
            "Width and height of each view, pixels [320]");
  add_value(
      command, "--env", "FILE|NAME", o.settings.environment, [](const std::string& text) { return text; },
      "What lights it: a file, studio, sky, sky:DEG, furnace, none [the scene's wish, else studio]")
      .choices(environment_words());
  add_choice(command, "--engine", "path|raster", o.engine, kEngines, "What draws it [path]");
  add_root(command, o.settings.load.root);
  add_texture_memory(command, o.settings.load.texture_memory);
  add_scene_choice(command, o.settings.load.scene);
  add_measures(command, o.settings.load.measures);
  add_value(command, "--threads", "N", o.threads, count_within(0, kMostThreads), "0 is all [0]");
  command.flag("-q,--quiet", o.quiet, "No progress on standard error");
  command.footer(
      "Examples:\n  candela preview helmet.glb\n  candela preview helmet.glb -o sheet.png --json\n"
      "  candela preview helmet.glb -o - | display\n  candela preview helmet.glb -o icon.png --thumbnail 256");
  return [options] { run_preview(*options); };
}

}  // namespace candela::cli
