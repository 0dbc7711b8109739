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
#include "base/text.h"
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

/// A render command that has been understood.
struct RenderCommand {
  std::vector<std::string> words;
  RenderOptions options;
  PictureNames names;
};

/// What render commands become.
struct PlannedWork {
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

  /// Opens the scenes of a command: a variant or an animation that it has not is known here.
  void add(const std::vector<std::string>& words, const std::string& list) {
    RenderOptions o = parse_job(words, list, options_.quiet);
    check(o);
    Inputs inputs = inputs_of_options(o);
    PictureNames names = o.is_batch ? names_of_batch(o, inputs) : names_of_shot(o, inputs);
    inputs_.add(inputs);
    commands_.push_back({words, std::move(o), std::move(names)});
  }

  PlannedWork plan() {
    check_files();
    PlannedWork work;
    for (const RenderCommand& command : commands_) plan(command, work);
    return work;
  }

 private:
  void plan(const RenderCommand& command, PlannedWork& work) {
    const RenderOptions& o = command.options;
    const std::size_t pictures = command.names.size();
    WorkTimes times;
    if (options_.picture_s) {
      times.picture_s = *options_.picture_s;
    } else {
      times = measure(o);
    }
    const std::vector<WorkPiece> pieces =
        divide_work(pictures, o.is_batch ? 1 : most_parts(o.shot), times, options_.piece_s);
    work.work_s += times.picture_s * static_cast<double>(pictures);
    work.work_s += times.start_s * static_cast<double>(pieces.size());
    for (const WorkPiece& piece : pieces) {
      work.lines.push_back(piece.part ? part_line(command, piece) : line_of(command.words, piece, pictures));
    }
    if (!pieces.empty() && pieces[0].part) add_merges(command, pieces[0].part->count, work.merges);
  }

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

  PictureNames names_of_batch(const RenderOptions& o, Inputs& inputs) const {
    if (o.shot.has_many_pictures()) {
      throw UsageError("SCENE: several of one picture each, or one; plan a command for each scene");
    }
    add_scene_files(o.scenes, o.shot.load.root, inputs);
    PictureNames names;
    for (const fs::path& output : batch_outputs(o.stems, o.outputs[0], inputs)) names.push_back({output});
    return names;
  }

  PictureNames names_of_shot(const RenderOptions& o, Inputs& inputs) {
    Diagnostics diagnostics;
    const Take take(o.shot, &diagnostics);
    for (const Diagnostic& warning : diagnostics.warnings()) progress_.warn(warning);
    inputs.add(take.files());
    return name_pictures(o, take.labels());
  }

  /// Nobody knows in which order lines are run: what one command reads or writes, no other may write.
  void check_files() {
    for (const fs::path& list : lists_) inputs_.refuse(list);
    for (const RenderCommand& command : commands_) {
      check_overwriting(command.options, command.names, inputs_);
      for (const fs::path& file : written_files(command.options, command.names)) add_written(file);
    }
  }

  void add_written(const fs::path& file) { inputs_.add_written(file, "written by another command of the plan"); }

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

  std::string part_line(const RenderCommand& command, const WorkPiece& piece) const {
    std::string line = prefix_ + "candela render";
    for (const std::string& word : without_outputs(command.words)) line += " " + quoted(word);
    if (command.names.size() > 1) line += fmt::format(" --pictures {}", piece.pictures.first);
    return line + fmt::format(" --part {}/{} -o {}", piece.part->index, piece.part->count,
                              quoted(part_name(command.options.outputs[0], *piece.part)));
  }

  void add_merges(const RenderCommand& command, int parts, std::vector<std::string>& merges) {
    for (const std::vector<fs::path>& outputs : command.names) {
      std::string line = prefix_ + "candela merge";
      for (int part = 1; part <= parts; ++part) {
        const std::string name = part_name(outputs[0], {part, parts});
        inputs_.refuse(name);  // a.png and a.exr have parts of one name
        add_written(name);
        line += " " + quoted(name);
      }
      for (const fs::path& output : outputs) line += " -o " + quoted(output.string());
      if (command.options.strict) line += " --strict";
      merges.push_back(line);
    }
  }

  const PlanOptions& options_;
  std::vector<fs::path> lists_;  ///< that are written
  ProgressLine& progress_;
  std::string prefix_;
  std::vector<RenderCommand> commands_;
  Inputs inputs_;  ///< of all, and what those have written that were looked at
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

/// A list, commands of one word each, or one in several.
std::vector<std::vector<std::string>> jobs_of(const std::vector<std::string>& job, std::string& list) {
  std::error_code ignored;  // a command may be too long for a name
  // Of one in several words hardly each has a blank, unless it is a file's name.
  const auto is_command = [&](const std::string& word) {
    return word.find(' ') != std::string::npos && !fs::exists(word, ignored);
  };
  if (job.size() > 1 && std::all_of(job.begin(), job.end(), is_command)) {
    std::vector<std::vector<std::string>> jobs;
    for (const std::string& line : job) jobs.push_back(without_verb(words_of(line)));
    return jobs;
  }
  if (job.size() > 1) return {without_verb(job)};
  const bool is_file = fs::is_regular_file(job[0], ignored);
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
  for (const std::vector<std::string>& job : jobs) planner.add(job, source);
  const PlannedWork all = planner.plan();
  write_list(list, all.lines);
  if (!all.merges.empty()) {
    write_list(merges, all.merges);
  } else {
    std::error_code code;
    fs::remove(merges, code);  // of an earlier plan
  }
  std::string text = fmt::format("{}: {}, {} of work on one machine like this", list.string(),
                                 counted(all.lines.size(), "line"), duration_text(all.work_s));
  if (!all.merges.empty()) text += fmt::format("; then {}: {}", merges.string(), counted(all.merges.size(), "line"));
  progress.line(text);
}

}  // namespace

fs::path merge_list_of(const fs::path& list) {
  return list.parent_path() / (list.stem().string() + "-merge" + list.extension().string());
}

Verb add_plan(Command& command) {
  const auto options = std::make_shared<PlanOptions>();
  PlanOptions& o = *options;
  command.texts("JOB", o.job, "Render commands, each in quotes, or one after --, or a .txt with one on each line");
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
