#include "candela/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostics.h"
#include "base/error.h"
#include "base/file.h"
#include "base/parallel.h"
#include "cli/films.h"
#include "cli/interrupt.h"
#include "cli/jobs.h"
#include "cli/option.h"
#include "cli/output.h"
#include "cli/plan.h"
#include "cli/progress.h"
#include "cli/render_options.h"
#include "cli/render_outputs.h"
#include "cli/values.h"
#include "cli/verbs.h"

namespace candela::cli {

namespace fs = std::filesystem;

namespace {

constexpr double kPieceS = 300.0;

struct PlanOptions {
  std::vector<std::string> job;
  std::string output;
  double piece_s = kPieceS;
  std::optional<double> picture_s;
  std::optional<std::string> folder;  ///< as the machines see it; empty = the lines do not change it
  bool quiet = false;
};

/// A word that a shell reads as it stands.
std::string quoted(const std::string& word) {
  const auto is_plain = [](char c) {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    return is_letter || std::string_view("_@%+=:,./-").find(c) != std::string_view::npos;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), is_plain)) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

/// The words without those that say where pictures go.
std::vector<std::string> without_outputs(const std::vector<std::string>& words) {
  std::vector<std::string> rest;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (word == "-o" || word == "--output") {
      ++i;
    } else if (!word.starts_with("--output=") && !(word.starts_with("-o") && !word.starts_with("--"))) {
      rest.push_back(word);
    }
  }
  return rest;
}

/// What one render command becomes.
struct PlannedJob {
  std::vector<std::string> lines;
  std::vector<std::string> merges;  ///< after them
  double work_s = 0.0;
};

class Planner {
 public:
  Planner(const PlanOptions& options, std::vector<fs::path> lists, ProgressLine& progress)
      : options_(options), lists_(std::move(lists)), progress_(progress) {
    const std::string folder = options.folder.value_or(fs::current_path().string());
    if (!folder.empty()) prefix_ = "cd " + quoted(folder) + " && ";
  }

  PlannedJob plan(const std::vector<std::string>& words, const std::string& list) {
    const RenderOptions o = parse_job(words, list, options_.quiet);
    check(o);
    const std::size_t pictures = count_of(o);
    WorkTimes times;
    if (options_.picture_s) {
      times.picture_s = *options_.picture_s;
    } else {
      times = measure(o);
    }
    PlannedJob job;
    job.work_s = times.picture_s * static_cast<double>(pictures);
    const std::vector<WorkPiece> pieces =
        divide_work(pictures, o.is_batch ? 1 : most_parts(o.shot), times, options_.piece_s);
    job.work_s += times.start_s * static_cast<double>(pieces.size());
    for (const WorkPiece& piece : pieces) {
      job.lines.push_back(piece.part ? part_line(o, words, piece) : line_of(words, piece, pictures));
    }
    if (!pieces.empty() && pieces[0].part) job.merges = merge_lines(o, pieces[0].part->count);
    return job;
  }

 private:
  /// What is written once for all pictures of a command cannot be written by several.
  static void check(const RenderOptions& o) {
    const auto refuse = [](const char* option, const std::string& why) {
      throw UsageError(std::string(option) + ": " + why);
    };
    if (o.dataset) refuse("--dataset", "is made as a whole; plan a command for each scene");
    if (o.pictures) refuse("--pictures", "the plan says which");
    if (o.shot.part) refuse("--part", "the plan says which");
    if (o.checkpoint) refuse("--checkpoint", "of a line that takes some minutes there is none");
    if (o.stats) refuse("--stats", "would be written by every line");
    if (o.written_cameras) refuse("--write-cameras", "would be written by every line");
    for (const std::string& output : o.outputs) {
      if (is_film(o, output)) {
        refuse("--output", output + " is a film: plan its pictures, NAME%03d.png, and join them with ffmpeg");
      }
    }
  }

  /// Opens the scene: a variant or an animation that it has not is known here.
  std::size_t count_of(const RenderOptions& o) {
    if (o.is_batch && o.shot.has_many_pictures()) {
      throw UsageError("SCENE: several of one picture each, or one; plan a command for each scene");
    }
    Inputs inputs = inputs_of_options(o);
    names_.clear();
    if (o.is_batch) {
      add_scene_files(o.scenes, o.shot.load.root, inputs);
    } else {
      Diagnostics diagnostics;
      Take take(o.shot, &diagnostics);
      for (const Diagnostic& warning : diagnostics.warnings()) progress_.warn(warning);
      names_ = name_pictures(o, take.labels());
      inputs.add(take.files());
      check_overwriting(o, names_, inputs);
    }
    for (const fs::path& list : lists_) inputs.refuse(list);
    return o.is_batch ? o.scenes.size() : names_.size();
  }

  WorkTimes measure(const RenderOptions& o) {
    progress_.phase("measuring " + o.shot.scene);
    const ThreadLimit threads(o.threads);
    const Interrupt interrupt;
    return measure_work(o.shot, progress_.job());
  }

  std::string line_of(const std::vector<std::string>& words, const WorkPiece& piece, std::size_t pictures) const {
    std::string line = prefix_ + "candela render";
    for (const std::string& word : words) line += " " + quoted(word);
    if (pictures == 1) return line;
    const PictureRange& range = piece.pictures;
    return line + (range.count() == 1 ? fmt::format(" --pictures {}", range.first)
                                      : fmt::format(" --pictures {}-{}", range.first, range.last));
  }

  static std::string part_name(const fs::path& picture, const PartRange& part) {
    const fs::path name = fmt::format("{}-{}of{}.part", picture.stem().string(), part.index, part.count);
    return (picture.parent_path() / "parts" / name).string();
  }

  std::string part_line(const RenderOptions& o, const std::vector<std::string>& words, const WorkPiece& piece) const {
    std::string line = prefix_ + "candela render";
    for (const std::string& word : without_outputs(words)) line += " " + quoted(word);
    if (names_.size() > 1) line += fmt::format(" --pictures {}", piece.pictures.first);
    return line + fmt::format(" --part {}/{} -o {}", piece.part->index, piece.part->count,
                              quoted(part_name(o.outputs[0], *piece.part)));
  }

  std::vector<std::string> merge_lines(const RenderOptions& o, int parts) const {
    std::vector<std::string> lines;
    for (const std::vector<fs::path>& outputs : names_) {
      std::string line = prefix_ + "candela merge";
      for (int part = 1; part <= parts; ++part) line += " " + quoted(part_name(outputs[0], {part, parts}));
      for (const fs::path& output : outputs) line += " -o " + quoted(output.string());
      if (o.strict) line += " --strict";
      lines.push_back(line);
    }
    return lines;
  }

  const PlanOptions& options_;
  std::vector<fs::path> lists_;  ///< that are written
  ProgressLine& progress_;
  std::string prefix_;
  PictureNames names_;  ///< of the command at hand, unless it has several scenes
};

/// The lines of a file of jobs, without "candela render".
std::vector<std::vector<std::string>> jobs_of(const std::string& file) {
  std::ifstream lines(file);
  if (!lines) throw Error("cannot be read", file);
  std::vector<std::vector<std::string>> jobs;
  for (std::string line; std::getline(lines, line);) {
    std::vector<std::string> words = words_of(line);
    if (!words.empty()) jobs.push_back(without_verb(std::move(words)));
  }
  return jobs;
}

/// A list, a command in one word, or in several.
std::vector<std::vector<std::string>> jobs_of(const std::vector<std::string>& job, std::string& list) {
  if (job.size() > 1) return {without_verb(job)};
  const bool is_file = fs::is_regular_file(job[0]);
  if (is_file && has_extension(job[0], ".txt")) return jobs_of(list = job[0]);
  return {is_file ? job : without_verb(words_of(job[0]))};
}

void write_list(const fs::path& file, const std::vector<std::string>& lines) {
  const FolderFor folder(file);
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  write_file(file, text);
}

fs::path list_of(const PlanOptions& o) {
  if (o.output.empty()) throw UsageError("--output: where to is missing: -o LIST.txt, or a folder: -o DIR/");
  const bool is_folder = o.output.ends_with('/') || fs::is_directory(o.output);
  return is_folder ? fs::path(o.output) / kJobList : fs::path(o.output);
}

void run_plan(const PlanOptions& o) {
  if (o.job.empty()) throw UsageError("JOB is missing: a render command, in quotes or after --, or a .txt of them");
  const fs::path list = list_of(o), merges = merge_list_of(list);
  fs::path work = list;
  work += ".work";
  if (fs::exists(work)) throw Error("is of an earlier plan: remove it to begin anew", work.string());
  ProgressLine progress(o.quiet);
  std::string source;
  const std::vector<std::vector<std::string>> jobs = jobs_of(o.job, source);
  if (jobs.empty()) throw Error("has no jobs", source);
  Planner planner(o, {list, merges}, progress);
  PlannedJob all;
  for (const std::vector<std::string>& job : jobs) {
    const PlannedJob one = planner.plan(job, source);
    all.lines.insert(all.lines.end(), one.lines.begin(), one.lines.end());
    all.merges.insert(all.merges.end(), one.merges.begin(), one.merges.end());
    all.work_s += one.work_s;
  }
  write_list(list, all.lines);
  if (!all.merges.empty()) {
    write_list(merges, all.merges);
  } else {
    std::error_code code;
    fs::remove(merges, code);  // of an earlier plan
  }
  const auto count_text = [](std::size_t count) { return fmt::format("{} {}", count, count == 1 ? "line" : "lines"); };
  std::string text = fmt::format("{}: {}, {} of work on one machine like this", list.string(),
                                 count_text(all.lines.size()), duration_text(all.work_s));
  if (!all.merges.empty()) text += fmt::format("; then {}: {}", merges.string(), count_text(all.merges.size()));
  progress.line(text);
}

}  // namespace

fs::path merge_list_of(const fs::path& list) {
  return list.parent_path() / (list.stem().string() + "-merge" + list.extension().string());
}

Verb add_plan(Command& command) {
  const auto options = std::make_shared<PlanOptions>();
  PlanOptions& o = *options;
  command.texts("JOB", o.job, "A render command, in quotes or after --, or a .txt with one on each line");
  command.text("-o,--output", o.output, "The list of lines to write; of DIR/ it is DIR/jobs.txt").type("FILE|DIR/");
  add_value(command, "--each", "5min", o.piece_s, parse_duration,
            "How long a line shall take on a machine like this one [5min]");
  add_value(command, "--picture-time", "90s", o.picture_s, parse_duration,
            "How long a picture takes [measured by a look at the first]");
  add_value(
      command, "--folder", "DIR", o.folder, [](const std::string& text) { return text; },
      "Where the machines have this folder; '' = the lines begin where they are run [this folder's own path]");
  command.flag("-q,--quiet", o.quiet, "Nothing on standard error but errors");
  command.help();
  command.footer(
      "Each line is a command of its own: ranges of the pictures of a set, or parts of one where it takes longer.\n"
      "Parts are merged by the lines of LIST-merge.txt, once all others are done. candela worker runs both, as do\n"
      "GNU parallel, Slurm, Kubernetes and OpenCue: docs/farm.md.\n\n"
      "Examples:\n"
      "  candela plan -o city/ -- city.glb --spp 4096 --turntable 48 -o frames/%03d.exr\n"
      "  candela plan \"city.glb --spp 65536 -o city.exr\" -o city.txt --each 10min\n"
      "  candela worker city/\n");
  return [options] { run_plan(*options); };
}

}  // namespace candela::cli
