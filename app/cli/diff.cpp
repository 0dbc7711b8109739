#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <utility>

#include "base/error.h"
#include "base/file.h"
#include "base/parallel.h"
#include "candela/difference.h"
#include "cli/diff_report.h"
#include "cli/diff_scenes.h"
#include "cli/inputs.h"
#include "cli/interrupt.h"
#include "cli/option.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/render_outputs.h"
#include "cli/values.h"
#include "cli/verbs.h"

namespace candela::cli {

namespace {

namespace fs = std::filesystem;

struct DiffOptions {
  std::string first, second;
  std::string output;
  DifferenceSettings settings;
  SceneRecipe recipe;
  std::optional<float> max_flip;
  bool json = false;
  bool quiet = false;
};

/// What is compared with what.
struct Pairs {
  std::vector<FilePair> files;
  bool are_scenes = false;
  bool is_one = false;  ///< no folders
};

const char* text_of(Comparable kind) {
  switch (kind) {
    case Comparable::picture:
      return "a picture";
    case Comparable::folder:
      return "a folder";
    case Comparable::scene:
      return "a model";
  }
  return "";
}

Pairs pairs_of(const DiffOptions& o) {
  const Comparable first = comparable_of(o.first), second = comparable_of(o.second);
  if (first != second) {
    throw Error(fmt::format("is {}, but the first is {}", text_of(second), text_of(first)), o.second);
  }
  if (first != Comparable::folder) return {{{o.second, o.first, o.second}}, first == Comparable::scene, true};
  std::vector<FilePair> scenes = scene_pairs(o.first, o.second);
  if (!scenes.empty()) return {std::move(scenes), true, false};
  return {picture_pairs(o.first, o.second), false, false};
}

/// The names of the maps of two scenes; of one name the same for all.
RenderOptions maps_of_scenes(const DiffOptions& o) {
  RenderOptions maps;
  maps.shot = o.recipe.shot;
  maps.outputs = {o.output};
  return maps;
}

bool is_map(const DiffOptions& o) { return has_extension(o.output, ".png"); }

/// Refuses what cannot be written, and what would overwrite something that is read.
void check_output(const DiffOptions& o, const Pairs& pairs) {
  if (o.output.empty()) return;
  if (!pairs.is_one && is_map(o)) throw Error("a pair has a map; folders have a page, an .html", o.output);
  if (pairs.are_scenes && is_map(o)) check_patterns(maps_of_scenes(o));
  Inputs inputs;
  for (const std::string& name : {o.first, o.second}) {
    if (!pairs.is_one) {
      inputs.add_folder(name, "a folder to compare");
    } else if (pairs.are_scenes) {
      inputs.add(name, "a scene to compare");
      add_scene_files({name}, o.recipe.shot.load.root, inputs);
    } else {
      inputs.add(parse_image_name(name).path, "a picture to compare");
    }
  }
  if (o.recipe.camera_file) inputs.add(*o.recipe.camera_file, "the cameras");
  inputs.add_environment(o.recipe.shot.environment.value_or(""));
  if (pairs.are_scenes && is_map(o)) {
    const RenderOptions maps = maps_of_scenes(o);
    check_overwriting(maps, name_pictures(maps, labels_before_loading(maps.shot)), inputs);
  } else {
    inputs.refuse(o.output);
  }
  check_writable(o.output);
}

void write_map(const fs::path& path, const PictureDifference& difference) {
  const FolderFor folder(path);
  write_png(path, error_map(difference.error));
}

void write_output(const DiffOptions& o, const Pairs& pairs, const std::vector<Compared>& all) {
  if (!is_map(o)) {
    const FolderFor folder(o.output);
    return write_file(o.output, report_html(o.first, o.second, all, o.max_flip));
  }
  if (!pairs.are_scenes) return write_map(o.output, *all.front().difference);
  std::vector<PictureLabel> labels;
  labels.reserve(all.size());
  for (const Compared& c : all) labels.push_back(c.label);
  const PictureNames names = name_pictures(maps_of_scenes(o), labels);
  for (std::size_t i = 0; i < all.size(); ++i) write_map(names[i][0], *all[i].difference);
}

void require_small(const DiffOptions& o, const std::vector<Compared>& all) {
  std::size_t beyond = 0;
  const Compared* worst = nullptr;
  for (const Compared& c : all) {
    if (!c.is_beyond(o.max_flip) && c.fault.empty()) continue;
    ++beyond;
    if (worst == nullptr || c.badness() > worst->badness()) worst = &c;
  }
  if (worst == nullptr) return;
  std::string what = absence_text(*worst);
  if (worst->difference) what = fmt::format("FLIP {:.4f} is above {} (--max-flip)", worst->badness(), *o.max_flip);
  throw Error(what + (beyond > 1 ? fmt::format(", and {} more", beyond - 1) : ""), worst->title());
}

/// The work at hand, and what has come of it.
class Comparison {
 public:
  Comparison(const DiffOptions& o, const Pairs& pairs) : o_(o), pairs_(pairs), progress_(o.quiet) {
    job_ = progress_.job();
    job_.diagnostics = &diagnostics_;
  }

  std::vector<Compared> run() {
    const JobParts parts(job_, pairs_.files.size());
    for (std::size_t i = 0; i < pairs_.files.size(); ++i) {
      if (Interrupt::requested()) {
        throw Interrupted(fmt::format("{} of {} pairs are compared", i, pairs_.files.size()));
      }
      compare(pairs_.files[i], i, parts);
    }
    return std::move(all_);
  }

 private:
  void compare(const FilePair& pair, std::size_t index, const JobParts& parts) {
    const Compared none{.name = pair.name,
                        .label = {},
                        .has_first = !pair.first.empty(),
                        .has_second = !pair.second.empty(),
                        .fault = {},
                        .difference = {}};
    if (!none.has_first || !none.has_second) return add(none);
    const std::string what = fmt::format("{} of {}: {}", index + 1, pairs_.files.size(), pair.name);
    progress_.phase(what);
    try {
      pairs_.are_scenes ? compare_scenes(pair, parts.part(index, pairs_.is_one ? "" : what + ", "))
                        : compare_pictures_of(pair);
    } catch (const Error& error) {
      if (pairs_.is_one) throw;
      Compared failed = none;
      failed.fault = error.what();
      add(std::move(failed));
    }
    report_warnings();
  }

  void compare_pictures_of(const FilePair& pair) {
    Compared compared{.name = pair.name, .label = {}, .fault = {}, .difference = {}};
    compared.difference =
        compare_pictures(parse_image_name(pair.first.string()), parse_image_name(pair.second.string()), o_.settings);
    add(std::move(compared));
  }

  void compare_scenes(const FilePair& pair, const Job& job) {
    const auto [first, second] = shots_of(o_.recipe, pair.first.string(), pair.second.string());
    compare_shots(
        first, second, o_.settings,
        [&](ShotDifference d) {
          add({.name = pair.name, .label = d.label, .fault = {}, .difference = std::move(d.difference)});
        },
        job);
  }

  void add(Compared compared) {
    if (o_.output.empty() && compared.difference) {  // many pictures need not be kept
      compared.difference->error = {};
      compared.difference->first = compared.difference->second = {};
    }
    progress_.clear();  // both may be the same terminal
    if (!o_.json) print(difference_text(compared));
    all_.push_back(std::move(compared));
  }

  void report_warnings() {
    for (; reported_ < diagnostics_.warnings().size(); ++reported_) progress_.warn(diagnostics_.warnings()[reported_]);
  }

  const DiffOptions& o_;
  const Pairs& pairs_;
  ProgressLine progress_;
  Diagnostics diagnostics_;
  std::size_t reported_ = 0;  ///< of these
  Job job_;
  std::vector<Compared> all_;
};

void run_diff(const Command& command, DiffOptions& o) {
  if (!o.output.empty() && !is_map(o) && !has_extension(o.output, ".html")) {
    throw UsageError("--output: a map is a .png, a page an .html: " + o.output);
  }
  const Pairs pairs = pairs_of(o);
  if (pairs.are_scenes) {
    o.recipe.shot.tone_curve = o.settings.tone_curve;
    if (command.has("--exposure")) o.recipe.shot.exposure = o.settings.exposure;
    finish_scene_recipe(command, o.recipe);
    check_memory(o.recipe);
  } else {
    refuse_scene_recipe(command);
  }
  check_output(o, pairs);
  const ThreadLimit threads(o.recipe.threads);
  const Interrupt interrupt;
  const std::vector<Compared> all = Comparison(o, pairs).run();
  if (o.json) print(report_json(all, o.max_flip));
  if (!o.output.empty()) write_output(o, pairs, all);
  require_small(o, all);
}

}  // namespace

Verb add_diff(Command& command) {
  const auto options = std::make_shared<DiffOptions>();
  DiffOptions& o = *options;
  command
      .text("FIRST", o.first,
            "The reference: a picture (.png .jpg .webp .avif .hdr .exr, FILE.exr:LAYER), a scene (" + kSceneFiles +
                ", demo:NAME) or a folder of either")
      .choices(demo_words())
      .required();
  command.text("SECOND", o.second, "What is judged; of two folders, the files of equal names")
      .choices(demo_words())
      .required();
  command
      .text("-o,--output", o.output,
            "Also write the error of each pixel as a .png (of several views NAME-{view}.png), or a page of all pairs "
            "as .html")
      .type("FILE");
  add_value(command, "--max-flip", "X", o.max_flip, number_within(0.0f, 1.0f),
            "Exit code 1 where the mean FLIP is above that, or one folder lacks a file of the other");
  add_value(command, "--tolerance", "X", o.settings.tolerance, number_within(0.0f, kInfinity),
            "A pixel has changed where a channel differs by more: of 0 to 1 in a display picture, else linear [0]");
  add_value(command, "--exposure", "auto|EV|f/N,1/T,ISO", o.settings.exposure, parse_exposure,
            "How .hdr, .exr and scenes are seen [auto: metered from FIRST, for both; of scenes as in render]");
  add_value(command, "--tonemap", "CURVE", o.settings.tone_curve, parse_tone_curve, "Likewise [pbr-neutral]")
      .choices(names_of_rows(kToneCurves));
  command.flag("--json", o.json, "For a machine: one JSON object");
  command.flag("-q,--quiet", o.quiet, "No progress on standard error");
  add_scene_recipe(command, o.recipe);
  command.footer(
      "Examples:\n  candela diff before.png after.png\n  candela diff golden/ out/ --max-flip 0.01 -o page.html\n"
      "  candela diff truth.exr:albedo frame.exr:albedo -o error.png\n"
      "  candela diff helmet.glb helmet-packed.glb -o page.html\n"
      "  candela diff models/ packed/ --engine raster --max-flip 0.02\n\n"
      "FLIP is how different two pictures look when one flips between them, 0 to 1 (Andersson et al. 2020).\n"
      "Of two scenes, pictures from the same places are compared, which show both whole, with the same noise.");
  return [options, &command] { run_diff(command, *options); };
}

}  // namespace candela::cli
