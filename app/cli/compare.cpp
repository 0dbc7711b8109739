#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <utility>

#include "base/error.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "candela/cache.h"
#include "cli/camera_options.h"
#include "cli/gap_report.h"
#include "cli/inputs.h"
#include "cli/interrupt.h"
#include "cli/option.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/render_options.h"
#include "cli/render_outputs.h"
#include "cli/scene_options.h"
#include "cli/threads.h"
#include "cli/verbs.h"

namespace candela::cli {

namespace {

namespace fs = std::filesystem;

constexpr const char* kPage = "index.html";
constexpr const char* kNumbers = "gap.json";

struct CompareOptions {
  std::string output;
  RenderOptions recipe;
  GapSettings settings;
  std::string against;  ///< a picture of another program, in place of the frame
  std::optional<float> max_flip;
  bool json = false;

  bool is_page() const { return has_extension(output, ".html"); }
  bool is_folder() const { return !output.empty() && !is_page(); }
};

void add_pictures(Command& command, CompareOptions& o) {
  const std::string group = "Pictures";
  Shot& shot = o.recipe.shot;
  shot.size = {640, 360};
  constexpr int kMostSamples = 1 << 20, kMostFrames = 4096;
  add_value(command, "--size", "WxH", shot.size, parse_size, "Pixels [640x360]").group(group);
  add_value(command, "--spp", "N", o.settings.samples, count_within(2, kMostSamples),
            "Samples per pixel of the truth [128]")
      .group(group);
  add_value(command, "--frames", "N", o.settings.frames, count_within(1, kMostFrames),
            "Frames whose mean tells edges and textures from the other causes [16]")
      .group(group);
  add_value(command, "--bounces", "N", shot.traced.bounces, count_within(1, 1024), "Of the truth [8]").group(group);
  add_value(command, "--seed", "N", shot.traced.seed, parse_seed, "Of the truth's noise [0]").group(group);
  add_value(command, "--exposure", "auto|EV|f/N,1/T,ISO", shot.exposure, parse_exposure,
            "How both are seen [the scene's wish, else metered from the truth]")
      .group(group);
  add_value(command, "--tonemap", "CURVE", shot.tone_curve, parse_tone_curve, "Likewise [pbr-neutral]")
      .choices(names_of_rows(kToneCurves))
      .group(group);
}

void finish_against(const Command& command, CompareOptions& o) {
  for (const char* option : {"--frames", "--no-suspects", "--msaa", "--texture-anisotropy", "--ao", "--soft-shadows",
                             "--light-radius", "--ambient", "--probes", "--no-cache", "--shaders"}) {
    if (command.has(option)) throw UsageError(std::string(option) + ": of the frame, which --against stands for");
  }
  if (command.has("--size")) return;
  const Image picture = read_image_file(parse_image_name(o.against)).image;
  o.recipe.shot.size = {picture.width, picture.height};
}

void finish(const Command& command, CompareOptions& o) {
  Shot& shot = o.recipe.shot;
  if (!o.against.empty()) finish_against(command, o);
  finish_scene_options(command, o.recipe);
  const ivec2 size = shot.size;
  constexpr std::uint64_t kBytesPerPixel = 1024;  // parts of the light by both engines, and what each adds to the error
  require_memory(2 * picture_bytes(shot) +
                     kBytesPerPixel * static_cast<std::uint64_t>(size.x) * static_cast<std::uint64_t>(size.y),
                 available_memory(), fmt::format("a comparison of {}x{}", size.x, size.y), "--size");
}

/// Refuses what cannot be written, and what would overwrite something that is read.
void check_output(const CompareOptions& o) {
  if (o.output.empty()) return;
  Inputs inputs = scene_inputs(o.recipe);
  if (!o.against.empty()) inputs.add(parse_image_name(o.against).path, "the picture to judge");
  if (o.is_page()) {
    inputs.refuse(o.output);
    return check_writable(o.output);
  }
  std::error_code ignored;
  if (fs::exists(o.output, ignored) && !fs::is_directory(o.output, ignored)) {
    throw UsageError("--output: a folder, or a page .html: " + o.output);
  }
  inputs.refuse_folder(o.output);
  check_writable(fs::path(o.output) / kPage);
}

/// The linear pictures of a view in the folder.
void write_pictures(const CompareOptions& o, const ViewGap& gap) {
  const fs::path folder(o.output);
  const std::string number = o.recipe.shot.has_many_pictures() ? fmt::format("-{:03d}", gap.index) : "";
  for (const auto& [name, film] : {std::pair{"truth", &gap.truth}, {"frame", &gap.frame}}) {
    const fs::path path = folder / fmt::format("{}{}.exr", name, number);
    const FolderFor made(path);
    write_exr(path, *film);
  }
}

/// A number for its report takes little, its pictures much.
void drop_pictures(ViewGap& gap) {
  gap.truth = gap.frame = {};
  gap.difference.error = {};
  gap.difference.first = gap.difference.second = {};
  for (CauseGap& cause : gap.causes) cause.error = {};
}

void write_reports(const CompareOptions& o, const std::vector<ViewGap>& gaps,
                   const std::vector<std::string>& sections) {
  if (o.output.empty()) return;
  const std::string& scene = o.recipe.shot.scene;
  const fs::path page = o.is_page() ? fs::path(o.output) : fs::path(o.output) / kPage;
  const FolderFor folder(page);
  write_file(page, gap_page(scene, o.against, o.settings, sections));
  if (o.is_folder()) write_file(fs::path(o.output) / kNumbers, gap_json(scene, o.settings, gaps, o.max_flip));
}

void require_small(const CompareOptions& o, const std::vector<ViewGap>& gaps) {
  if (!o.max_flip) return;
  const ViewGap* worst = nullptr;
  std::size_t beyond = 0;
  for (const ViewGap& gap : gaps) {
    if (!(gap.difference.flip > static_cast<double>(*o.max_flip))) continue;
    ++beyond;
    if (worst == nullptr || gap.difference.flip > worst->difference.flip) worst = &gap;
  }
  if (worst == nullptr) return;
  throw Error(fmt::format("FLIP {:.4f} is above {} (--max-flip){}", worst->difference.flip, *o.max_flip,
                          beyond > 1 ? fmt::format(", and {} more views", beyond - 1) : ""),
              o.recipe.shot.scene + (gaps.size() > 1 ? " " + title_of(*worst) : ""));
}

void run_compare(const Command& command, CompareOptions& o) {
  finish(command, o);
  check_output(o);
  const Threads threads(o.recipe.threads);
  const Interrupt interrupt;
  ProgressLine progress(o.recipe.quiet);
  Diagnostics diagnostics;
  Job job = progress.job();
  job.diagnostics = &diagnostics;
  std::vector<ViewGap> gaps;
  std::vector<std::string> sections;
  std::size_t reported = 0;
  const auto take = [&](ViewGap gap) {
    progress.clear();  // both may be the same terminal
    for (; reported < diagnostics.warnings().size(); ++reported) progress.warn(diagnostics.warnings()[reported]);
    if (!o.json) print(gap_text(gap));
    if (o.is_folder()) write_pictures(o, gap);
    if (!o.output.empty()) sections.push_back(gap_section(gap, o.max_flip));
    drop_pictures(gap);
    gaps.push_back(std::move(gap));
  };
  if (o.against.empty()) {
    measure_gaps(o.recipe.shot, o.settings, take, job);
  } else {
    take(measure_against(o.recipe.shot, o.settings, parse_image_name(o.against), job));
  }
  progress.clear();
  if (o.json) print(gap_json(o.recipe.shot.scene, o.settings, gaps, o.max_flip));
  write_reports(o, gaps, sections);
  require_small(o, gaps);
}

}  // namespace

Verb add_compare(Command& command) {
  const auto options = std::make_shared<CompareOptions>();
  CompareOptions& o = *options;
  add_scene_argument(command, o.recipe);
  command
      .text("-o,--output", o.output,
            "Also a page with the pictures, where they differ and the tables: FILE.html; or a folder for it, for " +
                std::string(kNumbers) + " and for both pictures as .exr")
      .type("DIR|FILE.html");
  command
      .text("--against", o.against,
            "Judge a picture of the same view by another program, .png, .exr …: moved by whole pixels, its exposure "
            "matched")
      .type("FILE");
  add_value(command, "--max-flip", "X", o.max_flip, number_within(0.0f, 1.0f),
            "Exit code 1 where the mean FLIP of a view is above that");
  command.flag("--json", o.json, "For a machine: one JSON object");
  bool& suspects = o.settings.looks_for_suspects;
  command.flag("!--no-suspects", suspects, "Do not look for mistakes that would explain what is wrong");
  add_value(command, "--threads", "N", o.recipe.threads, count_within(0, kMostThreads), "0 is all [0]");
  command.flag("-q,--quiet", o.recipe.quiet, "No progress on standard error");
  add_scene_options(command, o.recipe);
  add_pictures(command, o);
  add_camera_options(command, o.recipe, CameraPictures::report);
  add_light_options(command, o.recipe);
  add_drawing_options(command, o.recipe.shot, o.recipe.keeps_cache, "The frame");
  command.footer(
      "Examples:\n  candela compare helmet.glb\n  candela compare helmet.glb -o gap/ --env sky --ao 0.05\n"
      "  candela compare chair.glb --views front,left,top -o gap.html --max-flip 0.08\n"
      "  candela compare helmet.glb --shaders my-shaders/ --json\n"
      "  candela compare helmet.glb --camera 0 --env sky --against screenshot.png -o gap.html\n\n"
      "Both engines see the same, in linear light. FLIP is how different two pictures look when one flips between "
      "them, "
      "0 to 1.\nEach cause is one approximation of the frame in place of its exact counterpart; the shares of all add "
      "up to 100 %.");
  return [options, &command] { run_compare(command, *options); };
}

}  // namespace candela::cli
