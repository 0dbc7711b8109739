#include <fmt/format.h>

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "candela/verdict.h"
#include "cli/check_filter.h"
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

namespace {

using Json = nlohmann::ordered_json;
using check::Finding;
using check::Severity;

struct Totals {
  std::size_t files = 0, clean = 0, unreadable = 0, errors = 0, warnings = 0, notes = 0, known = 0;

  void add(const Verdict& v) {
    ++files;
    if (v.unreadable) ++unreadable;
    if (!v.unreadable && v.findings.empty()) ++clean;
    errors += v.count(Severity::error);
    warnings += v.count(Severity::warning);
    notes += v.count(Severity::note);
  }
};

std::string counts_text(std::size_t errors, std::size_t warnings, std::size_t notes) {
  return counted(errors, "error") + ", " + counted(warnings, "warning") + ", " + counted(notes, "note");
}

std::string percent_text(double share) {
  return share > 0.0 && share < 0.001 ? "less than 0.1 %" : fmt::format("{:.1f} %", 100.0 * share);
}

std::string finding_text(const NamedFinding& named) {
  const Finding& f = named.finding;
  std::string about;
  const auto add = [&about](const std::string& text) {
    if (!text.empty()) about += (about.empty() ? "" : ", ") + text;
  };
  add(named.material);
  add(named.texture);
  add(f.subject);
  if (f.share) add(fmt::format("{} of its {}", percent_text(*f.share), f.share_of));
  std::string text = fmt::format("  {:<8} {:<22} ", severity_name(f.severity), f.code);
  if (!about.empty()) text += about + ": ";
  text += f.message;
  if (!f.fix.empty()) text += ". Fix: " + f.fix;
  return one_line(text) + "\n";
}

std::string verdict_text(const Verdict& v) {
  std::string text = one_line(v.file) + ": ";
  if (v.unreadable) {
    text += "cannot be read\n";
  } else if (v.findings.empty()) {
    return text + fmt::format("clean ({}, {})\n", counted(v.material_count, "material"),
                              counted(v.triangle_count, "triangle"));
  } else {
    text += counts_text(v.count(Severity::error), v.count(Severity::warning), v.count(Severity::note)) + "\n";
  }
  // What repeats for many materials would hide the rest.
  constexpr std::size_t kMostAlike = 4;
  std::map<std::string, std::size_t> alike;
  for (const NamedFinding& named : v.findings) {
    if (alike[named.finding.code]++ < kMostAlike) text += finding_text(named);
  }
  for (const auto& [code, count] : alike) {
    if (count > kMostAlike) text += fmt::format("  and {} more {} (--json lists all)\n", count - kMostAlike, code);
  }
  return text;
}

std::string report_json(const std::vector<Verdict>& verdicts, const Totals& totals, std::size_t asked) {
  Json assets = Json::array();
  for (const Verdict& v : verdicts) assets.push_back(verdict_json(v));
  const Json json = {{"assets", assets},
                     {"summary",
                      {{"files", totals.files},
                       {"clean", totals.clean},
                       {"unreadable", totals.unreadable},
                       {"errors", totals.errors},
                       {"warnings", totals.warnings},
                       {"notes", totals.notes},
                       {"known", totals.known},
                       {"not_judged", asked - totals.files}}}};
  return json_text(json);
}

/// What the verdicts are measured by, and what of them is not told.
struct CheckFilter {
  std::vector<std::string> limit_texts;  ///< as they were given
  check::Limits limits;
  std::set<std::string> ignored;  ///< codes
  std::string baseline, new_baseline;
};

struct CheckOptions {
  CheckFilter filter;
  std::vector<std::string> names;
  std::string root;
  std::string scene;
  foreign::Measures measures;
  bool json = false;
  bool strict = false;
  bool quiet = false;
  std::string threads;
};

/// Takes out what is ignored or known; a file that cannot be read stays one.
class Sieve {
 public:
  explicit Sieve(const CheckFilter& filter) : filter_(filter) {
    if (!filter.baseline.empty()) known_ = Baseline(filter.baseline);
    if (!filter.new_baseline.empty()) check_writable(filter.new_baseline);
  }

  /// Returns how many findings were known.
  std::size_t apply(Verdict& verdict) {
    leave_out([&](const NamedFinding& f) { return filter_.ignored.contains(f.finding.code); }, verdict);
    if (!filter_.new_baseline.empty()) written_.add(verdict, filter_.new_baseline);
    if (!known_) return 0;
    return leave_out([&](const NamedFinding& f) { return known_->knows(verdict.file, f); }, verdict);
  }
  void finish() const {
    if (!filter_.new_baseline.empty()) written_.write(filter_.new_baseline);
  }

 private:
  const CheckFilter& filter_;
  std::optional<Baseline> known_;
  Baseline written_;
};

/// One line after all verdicts of several files, or of one whose findings were known.
std::string totals_text(const Totals& totals, bool is_partial) {
  return fmt::format("{}{}, {} clean, {} unreadable: {}{}\n", is_partial ? "interrupted: " : "",
                     counted(totals.files, "file"), totals.clean, totals.unreadable,
                     counts_text(totals.errors, totals.warnings, totals.notes),
                     totals.known > 0 ? fmt::format(", {} known", totals.known) : "");
}

void run_check(const CheckOptions& options) {
  const ThreadLimit limit(options.threads.empty() ? 0 : parse_count(options.threads, 0, kMostThreads));
  std::vector<std::string> scenes;
  for (ListedScene& scene : list_scenes(options.names)) scenes.push_back(std::move(scene.name));
  if (!options.filter.new_baseline.empty()) {
    Inputs inputs;
    add_scene_files(scenes, options.root, inputs);
    inputs.refuse(options.filter.new_baseline);
  }
  const LoadOptions load_options{
      .refuse_unknown_required = false, .root = options.root, .scene = options.scene, .measures = options.measures};
  std::vector<Verdict> verdicts;
  Totals totals;
  ProgressLine progress(options.quiet);
  Sieve sieve(options.filter);
  const Interrupt interrupt;
  const Job job = progress.job();
  const JobParts parts(job, scenes.size());
  for (std::size_t i = 0; i < scenes.size() && !job.is_stopped(); ++i) {
    const std::string text = fmt::format("{} of {}: {}", i + 1, scenes.size(), scenes[i]);
    progress.phase(text);
    Verdict verdict;
    try {
      verdict = judge(scenes[i], load_options, parts.part(i, text + ", "), options.filter.limits);
    } catch (const Interrupted&) {
      break;  // half a judgement would pass for a good one
    }
    totals.known += sieve.apply(verdict);
    totals.add(verdict);
    if (options.json) {
      verdicts.push_back(std::move(verdict));
    } else {
      progress.clear();  // both may be the same terminal
      print(verdict_text(verdict));
    }
  }
  progress.clear();
  const bool is_partial = totals.files < scenes.size();
  if (options.json) {
    print(report_json(verdicts, totals, scenes.size()));
  } else if (scenes.size() > 1 || totals.known > 0) {
    print(totals_text(totals, is_partial));
  }
  if (is_partial) throw Interrupted(fmt::format("{} of {} are judged", totals.files, counted(scenes.size(), "file")));
  sieve.finish();
  if (totals.unreadable > 0) {
    throw Error(fmt::format("{} of {} cannot be read", totals.unreadable, counted(totals.files, "file")));
  }
  if (options.strict && totals.errors + totals.warnings > 0) {
    throw Error(
        fmt::format("{} and {} (--strict)", counted(totals.errors, "error"), counted(totals.warnings, "warning")));
  }
}

void add_filter(Command& command, CheckFilter& filter) {
  const auto file_name = [](const std::string& text) {
    if (text.empty()) throw UsageError("the name is empty");
    return text;
  };
  const std::span<const std::string> codes = check::finding_codes();
  add_value(command, "--ignore", "CODE,…", filter.ignored, parse_codes, "Findings not to be told, e.g. roughness-zero")
      .choices_of_list({codes.begin(), codes.end()});
  std::vector<std::string> limits;
  for (const check::LimitRow& row : check::limit_rows()) limits.push_back(std::string(row.name) + "=");
  command
      .texts("--limit", filter.limit_texts,
             "From where on a finding is told, may be repeated: albedo-too-bright=0.95, too-many-triangles=100000")
      .type("CODE=X")
      .choices(limits)
      .repeated();
  add_value(command, "--write-baseline", "FILE", filter.new_baseline, file_name, "Keep today's findings as known ones");
  add_value(command, "--baseline", "FILE", filter.baseline, file_name, "Tell only findings that are not known");
}

}  // namespace

Verb add_check(Command& command) {
  const auto options = std::make_shared<CheckOptions>();
  command.texts("SCENE", options->names, "Files (" + kSceneFiles + "), folders to search for them, or demo:NAME")
      .choices(demo_words())
      .required();
  add_root(command, options->root);
  add_scene_choice(command, options->scene);
  add_measures(command, options->measures);
  command.flag("--json", options->json, "For a machine: one JSON object, with the measured numbers");
  command.flag("--strict", options->strict, "Exit code 1 where there is a warning or an error");
  add_filter(command, options->filter);
  command.text("--threads", options->threads, "Default: all the machine has").type("N");
  command.flag("-q,--quiet", options->quiet, "No progress on standard error");
  command.footer(
      "Examples:\n  candela check helmet.glb\n  candela check assets/ --strict\n  candela check helmet.glb --json\n"
      "  candela check assets/ --write-baseline known.json\n  candela check assets/ --baseline known.json --strict\n"
      "  candela check assets/ --ignore roughness-zero --limit too-many-triangles=100000\n\n"
      "docs/check.md explains every finding. Ctrl-C keeps the verdicts so far (exit code 130).");
  return [options] {
    for (const std::string& text : options->filter.limit_texts) parse_limit(text, options->filter.limits);
    run_check(*options);
  };
}

}  // namespace candela::cli
