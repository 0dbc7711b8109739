#include "candela/explain.h"

#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/file.h"
#include "base/parallel.h"
#include "cli/camera_options.h"
#include "cli/explain_report.h"
#include "cli/inputs.h"
#include "cli/interrupt.h"
#include "cli/option.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/render_outputs.h"
#include "cli/scene_options.h"
#include "cli/threads.h"
#include "cli/verbs.h"

namespace candela::cli {

namespace {

struct ExplainOptions {
  std::string output;
  std::vector<std::string> pixels;
  RenderOptions recipe;
  ExplainSettings settings;
  bool json = false;
};

/// "320,180"
ivec2 parse_pixel(const std::string& text) {
  constexpr int kMost = 65535;
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos) throw UsageError("--pixel: '" + text + "' is not a column and a row, as 320,180");
  try {
    return {parse_count(text.substr(0, comma), 0, kMost), parse_count(text.substr(comma + 1), 0, kMost)};
  } catch (const UsageError& error) {
    throw UsageError(std::string("--pixel: ") + error.what());
  }
}

void add_pictures(Command& command, ExplainOptions& o) {
  const std::string group = "Picture";
  Shot& shot = o.recipe.shot;
  shot.size = {640, 360};
  constexpr int kMostSamples = 1 << 24, kMostPaths = 1000;
  add_value(command, "--size", "WxH", shot.size, parse_size, "Pixels of the whole picture [640x360]").group(group);
  add_value(command, "--spp", "N", o.settings.samples, count_within(2, kMostSamples), "Paths that are followed [1024]")
      .group(group);
  add_value(command, "--paths", "N", o.settings.paths, count_within(0, kMostPaths),
            "How many of the brightest are shown [3]")
      .group(group);
  add_value(command, "--frames", "N", shot.drawn.frames, count_within(1, 4096),
            "Frames whose mean the real-time one is [1]")
      .group(group);
  add_value(command, "--bounces", "N", shot.traced.bounces, count_within(1, 1024), "Of the path tracer [8]")
      .group(group);
  add_value(command, "--seed", "N", shot.traced.seed, parse_seed, "Of the paths [0]").group(group);
  add_value(command, "--exposure", "auto|EV|f/N,1/T,ISO", shot.exposure, parse_exposure,
            "Of the picture in the page [the scene's wish, else metered]")
      .group(group);
}

void finish(const Command& command, ExplainOptions& o) {
  finish_scene_options(command, o.recipe);
  for (const std::string& text : o.pixels) o.settings.pixels.push_back(parse_pixel(text));
  if (o.output.empty()) return;
  if (!has_extension(o.output, ".html")) throw UsageError("--output: a page .html: " + o.output);
  scene_inputs(o.recipe).refuse(o.output);
  check_writable(o.output);
}

void run_explain(const Command& command, ExplainOptions& o) {
  finish(command, o);
  const Threads threads(o.recipe.threads);
  const Interrupt interrupt;
  ProgressLine progress(o.recipe.quiet);
  Diagnostics diagnostics;
  Job job = progress.job();
  job.diagnostics = &diagnostics;
  const Explanation explanation = explain(o.recipe.shot, o.settings, job);
  progress.clear();
  for (const Diagnostic& warning : diagnostics.warnings()) progress.warn(warning);
  const std::string& scene = o.recipe.shot.scene;
  print(o.json ? explain_json(scene, explanation) : explain_text(explanation));
  if (o.output.empty()) return;
  const FolderFor folder(o.output);
  write_file(o.output, explain_page(scene, explanation));
}

}  // namespace

Verb add_explain(Command& command) {
  const auto options = std::make_shared<ExplainOptions>();
  ExplainOptions& o = *options;
  add_scene_argument(command, o.recipe);
  command.texts("--pixel", o.pixels, "Column and row, from the top left corner, which is 0,0; may be repeated")
      .type("X,Y")
      .required();
  command.text("-o,--output", o.output, "Also a page with the picture and the lobes drawn").type("FILE.html");
  command.flag("--json", o.json, "For a machine: one JSON object");
  command.flag("!--no-frame", o.settings.has_frame, "The path tracer alone");
  add_value(command, "--threads", "N", o.recipe.threads, count_within(0, kMostThreads), "0 is all [0]");
  command.flag("-q,--quiet", o.recipe.quiet, "No progress on standard error");
  add_scene_options(command, o.recipe);
  add_pictures(command, o);
  add_camera_options(command, o.recipe, CameraPictures::report);
  add_light_options(command, o.recipe);
  add_drawing_options(command, o.recipe.shot, o.recipe.keeps_cache, "The frame");
  command.footer(
      "Examples:\n  candela explain helmet.glb --pixel 320,180\n"
      "  candela explain helmet.glb --env sky --pixel 320,180 --pixel 400,100 -o pixels.html\n"
      "  candela explain cornell.glb --size 512x512 --pixel 100,300 --spp 16384 --paths 10 --json\n\n"
      "What is at the middle of the pixel, its material after all textures, each lobe's share and each light's part, "
      "the\nterms of the real-time frame, and what the path tracer finds of the whole pixel, within 95 % confidence, "
      "by\nsource, by turns and by its brightest paths. Radiances are linear, in cd/m2 by channel.");
  return [options, &command] { run_explain(command, *options); };
}

}  // namespace candela::cli
