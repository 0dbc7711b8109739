#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "candela/verdict.h"
#include "cli/interrupt.h"
#include "cli/option.h"
#include "cli/progress.h"
#include "cli/values.h"
#include "cli/verbs.h"

namespace candela::cli {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using check::Finding;
using check::Severity;

std::vector<std::string> scenes_of(const std::vector<std::string>& names) {
  std::vector<std::string> result;
  for (const std::string& name : names) {
    if (name.empty()) throw UsageError("SCENE: the name is empty");
    std::error_code ignored;
    if (fs::is_directory(name, ignored)) {
      const std::vector<std::string> below = scenes_below(name);
      result.insert(result.end(), below.begin(), below.end());
    } else {
      result.push_back(name);
    }
  }
  return result;
}

struct Totals {
  std::size_t files = 0, clean = 0, unreadable = 0, errors = 0, warnings = 0, notes = 0;

  void add(const Verdict& v) {
    ++files;
    if (v.unreadable) ++unreadable;
    if (!v.unreadable && v.findings.empty()) ++clean;
    errors += v.count(Severity::error);
    warnings += v.count(Severity::warning);
    notes += v.count(Severity::note);
  }
};

std::string plural(std::size_t count, const char* what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

std::string counts_text(std::size_t errors, std::size_t warnings, std::size_t notes) {
  return plural(errors, "error") + ", " + plural(warnings, "warning") + ", " + plural(notes, "note");
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
    return text +
           fmt::format("clean ({}, {})\n", plural(v.material_count, "material"), plural(v.triangle_count, "triangle"));
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

Json name_or_null(const std::string& label) { return label.empty() ? Json(nullptr) : Json(label); }

Json verdict_json(const Verdict& v) {
  Json findings = Json::array();
  for (const auto& [f, material, texture] : v.findings) {
    Json measured = Json::object();
    for (const auto& [name, value] : f.measured) measured[name] = value;
    findings.push_back({{"severity", severity_name(f.severity)},
                        {"code", f.code},
                        {"material", name_or_null(material)},
                        {"material_index", f.material < 0 ? Json(nullptr) : Json(f.material)},
                        {"texture", name_or_null(texture)},
                        {"texture_index", f.texture < 0 ? Json(nullptr) : Json(f.texture)},
                        {"subject", name_or_null(f.subject)},
                        {"share", f.share ? Json(*f.share) : Json(nullptr)},
                        {"share_of", f.share ? Json(f.share_of) : Json(nullptr)},
                        {"message", f.message},
                        {"fix", name_or_null(f.fix)},
                        {"measured", measured}});
  }
  return {{"file", v.file},
          {"readable", !v.unreadable},
          {"reason", v.unreadable ? Json(*v.unreadable) : Json(nullptr)},
          {"materials", v.material_count},
          {"triangles", v.triangle_count},
          {"findings", findings}};
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
                       {"not_judged", asked - totals.files}}}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

struct CheckOptions {
  std::vector<std::string> names;
  std::string root;
  std::string scene;
  foreign::Measures measures;
  bool json = false;
  bool strict = false;
  bool quiet = false;
  std::string threads;
};

void run_check(const CheckOptions& options) {
  constexpr int kMostThreads = 1024;
  const ThreadLimit limit(options.threads.empty() ? 0 : parse_count(options.threads, 0, kMostThreads));
  const std::vector<std::string> scenes = scenes_of(options.names);
  const LoadOptions load_options{
      .refuse_unknown_required = false, .root = options.root, .scene = options.scene, .measures = options.measures};
  std::vector<Verdict> verdicts;
  Totals totals;
  ProgressLine progress(options.quiet);
  const Interrupt interrupt;
  const Job job = progress.job();
  const JobParts parts(job, scenes.size());
  for (std::size_t i = 0; i < scenes.size() && !job.is_stopped(); ++i) {
    const std::string text = fmt::format("{} of {}: {}", i + 1, scenes.size(), scenes[i]);
    progress.phase(text);
    Verdict verdict;
    try {
      verdict = judge(scenes[i], load_options, parts.part(i, text + ", "));
    } catch (const Interrupted&) {
      break;  // half a judgement would pass for a good one
    }
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
  } else if (scenes.size() > 1) {
    print(fmt::format("{}{}, {} clean, {} unreadable: {}\n", is_partial ? "interrupted: " : "",
                      plural(totals.files, "file"), totals.clean, totals.unreadable,
                      counts_text(totals.errors, totals.warnings, totals.notes)));
  }
  if (is_partial) throw Interrupted(fmt::format("{} of {} are judged", totals.files, plural(scenes.size(), "file")));
  if (totals.unreadable > 0) {
    throw Error(fmt::format("{} of {} cannot be read", totals.unreadable, plural(totals.files, "file")));
  }
  if (options.strict && totals.errors + totals.warnings > 0) {
    throw Error(
        fmt::format("{} and {} (--strict)", plural(totals.errors, "error"), plural(totals.warnings, "warning")));
  }
}

}  // namespace

Verb add_check(Command& command) {
  const auto options = std::make_shared<CheckOptions>();
  command.texts("SCENE", options->names, "Files (" + kSceneFiles + "), folders to search for them, or demo:NAME")
      .required();
  add_root(command, options->root);
  add_scene_choice(command, options->scene);
  add_measures(command, options->measures);
  command.flag("--json", options->json, "For a machine: one JSON object, with the measured numbers");
  command.flag("--strict", options->strict, "Exit code 1 where there is a warning or an error");
  command.text("--threads", options->threads, "Default: all the machine has").type("N");
  command.flag("-q,--quiet", options->quiet, "No progress on standard error");
  command.footer(
      "Examples:\n  candela check helmet.glb\n  candela check assets/ --strict\n  candela check helmet.glb --json\n\n"
      "docs/check.md explains every finding. Ctrl-C keeps the verdicts so far (exit code 130).");
  return [options] { run_check(*options); };
}

}  // namespace candela::cli
