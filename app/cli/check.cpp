#include "check/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "base/diagnostics.h"
#include "base/error.h"
#include "base/parallel.h"
#include "candela/candela.h"
#include "cli/interrupt.h"
#include "cli/option.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/values.h"
#include "cli/verbs.h"
#include "io/foreign_scene.h"
#include "io/gltf.h"
#include "io/gltf_survey.h"
#include "io/scene_files.h"

namespace candela::cli {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using check::Finding;
using check::Severity;

/// A finding, and the names of what it is about; empty where it is about no such thing.
struct Told {
  Finding finding;
  std::string material, texture;
};

/// What was found in one file.
struct Verdict {
  std::string file;
  std::optional<std::string> unreadable;  ///< why it cannot be judged
  std::vector<Told> findings;
  std::size_t material_count = 0;
  std::size_t triangle_count = 0;

  std::size_t count(Severity severity) const {
    return static_cast<std::size_t>(std::count_if(
        findings.begin(), findings.end(), [severity](const Told& told) { return told.finding.severity == severity; }));
  }
};

std::size_t triangles_of(const Scene& scene) {
  std::size_t count = 0;
  for (const Mesh& mesh : scene.meshes) {
    for (const Primitive& primitive : mesh.primitives) count += primitive.triangles.size();
  }
  return count;
}

std::vector<Told> told(const Scene& scene, const FileSurvey* survey, std::vector<Finding> findings) {
  std::vector<Told> result;
  result.reserve(findings.size());
  for (Finding& f : findings) {
    std::string material = f.material < 0 ? "" : check::material_label(scene, f.material);
    std::string texture = f.texture < 0 ? "" : check::texture_label(scene, f.texture, survey);
    // From here on people read it: their numbers are the file's.
    if (f.material >= 0) f.material = number_of(scene.materials, static_cast<std::size_t>(f.material));
    if (f.texture >= 0) f.texture = number_of(scene.textures, static_cast<std::size_t>(f.texture));
    result.push_back({std::move(f), std::move(material), std::move(texture)});
  }
  return result;
}

Verdict verdict_of(const std::string& name, const check::CheckInput& input) {
  return {name, std::nullopt, told(input.scene, input.survey, check::check_asset(input)), input.scene.materials.size(),
          triangles_of(input.scene)};
}

/// What keeps a file from being judged: its images, each that fails, or else what the loader says.
std::vector<Told> causes(const std::string& name, const LoadOptions& options, const Error& error) {
  std::vector<Told> result;
  try {
    const FileSurvey survey = io::survey_gltf(
        name, {.read_geometry = false, .decode_images = true, .root = options.root, .scene = options.scene});
    for (Finding& f : check::check_images(survey)) result.push_back({std::move(f), {}, {}});
  } catch (const Error&) {
    // The file itself is damaged, as `error` says.
  }
  if (result.empty()) {
    Finding f;
    f.severity = Severity::error;
    f.code = "unreadable";
    f.message = error.what();
    result.push_back({std::move(f), {}, {}});
  }
  return result;
}

/// What a variant's materials add to the findings of those that primitives name themselves.
void add_variant(const std::string& name, LoadOptions options, const std::string& variant, Verdict& verdict) {
  Diagnostics diagnostics;
  options.variant = variant;
  const Scene scene = io::load_gltf(name, diagnostics, options);
  const auto key = [](const Told& t) { return t.finding.code + '\n' + t.material + '\n' + t.finding.message; };
  std::set<std::string> known;
  for (const Told& t : verdict.findings) known.insert(key(t));
  for (Told& own : told(scene, nullptr, check::check_asset({.scene = scene}))) {
    if (known.contains(key(own))) continue;
    own.finding.subject += (own.finding.subject.empty() ? "" : ", ") + fmt::format("variant '{}'", variant);
    verdict.findings.push_back(std::move(own));
  }
}

Verdict judge_file(const std::string& name, const LoadOptions& options) {
  try {
    Diagnostics diagnostics;
    io::FileInfo info;
    const Scene scene = io::load_gltf(name, diagnostics, options, &info);
    // Of an image that did not decode the survey says so, too.
    const bool has_lost_images =
        std::any_of(diagnostics.warnings().begin(), diagnostics.warnings().end(),
                    [](const Diagnostic& w) { return w.where.find("#/images/") != std::string::npos; });
    const FileSurvey survey =
        io::survey_gltf(name, {.decode_images = has_lost_images, .root = options.root, .scene = options.scene});
    Verdict verdict = verdict_of(name, {.scene = scene,
                                        .survey = &survey,
                                        .extensions_used = info.extensions_used,
                                        .extensions_ignored = info.extensions_ignored,
                                        .extensions_missing = info.extensions_missing,
                                        .warnings = diagnostics.warnings(),
                                        .notes = diagnostics.notes()});
    for (const std::string& variant : info.variants) add_variant(name, options, variant, verdict);
    std::stable_sort(verdict.findings.begin(), verdict.findings.end(),
                     [](const Told& a, const Told& b) { return a.finding.severity > b.finding.severity; });
    return verdict;
  } catch (const Error& error) {
    return {name, error.what(), causes(name, options, error)};
  }
}

Verdict judge(const std::string& name, const LoadOptions& options) {
  if (!name.starts_with("demo:")) return judge_file(name, options);
  const Scene scene = load(name, nullptr, options);
  return verdict_of(name, {.scene = scene});
}

/// Empty where it was stopped: half a judgement would pass for a good one.
std::optional<Verdict> judge_unless_stopped(const std::string& name, const LoadOptions& options) {
  const StopScope scope(&Interrupt::requested());
  try {
    return judge(name, options);
  } catch (const Interrupted&) {
    return std::nullopt;
  }
}

/// The scenes below a folder, in the order of their names.
std::vector<std::string> scenes_below(const fs::path& folder) {
  std::vector<std::string> result;
  std::error_code code;
  fs::recursive_directory_iterator at(folder, fs::directory_options::skip_permission_denied, code);
  for (; !code && at != fs::recursive_directory_iterator(); at.increment(code)) {
    std::error_code ignored;
    const fs::path& path = at->path();
    const bool is_scene = has_extension(path, ".gltf") || has_extension(path, ".glb") ||
                          io::has_foreign_extension(path) ||
                          (has_extension(path, ".zip") && io::is_scene_archive(path));
    if (is_scene && at->is_regular_file(ignored)) result.push_back(path.string());
  }
  if (code) throw Error("cannot list the folder: " + code.message(), folder.string());
  if (result.empty()) throw Error("there is no scene in this folder", folder.string());
  std::sort(result.begin(), result.end());
  return result;
}

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

std::string finding_text(const Told& told) {
  const Finding& f = told.finding;
  std::string about;
  const auto add = [&about](const std::string& text) {
    if (!text.empty()) about += (about.empty() ? "" : ", ") + text;
  };
  add(told.material);
  add(told.texture);
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
  for (const Told& told : v.findings) {
    if (alike[told.finding.code]++ < kMostAlike) text += finding_text(told);
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
  bool json = false;
  bool strict = false;
  bool quiet = false;
  std::string threads;
};

void run_check(const CheckOptions& options) {
  constexpr int kMostThreads = 1024;
  const ThreadLimit limit(options.threads.empty() ? 0 : parse_count(options.threads, 0, kMostThreads));
  const std::vector<std::string> scenes = scenes_of(options.names);
  const LoadOptions load_options{.refuse_unknown_required = false, .root = options.root, .scene = options.scene};
  std::vector<Verdict> verdicts;
  Totals totals;
  ProgressLine progress(options.quiet);
  const Interrupt interrupt;
  for (std::size_t i = 0; i < scenes.size() && !Interrupt::requested(); ++i) {
    progress.phase(fmt::format("{} of {}: {}", i + 1, scenes.size(), scenes[i]));
    const std::optional<Verdict> verdict = judge_unless_stopped(scenes[i], load_options);
    if (!verdict) break;
    totals.add(*verdict);
    if (options.json) {
      verdicts.push_back(*verdict);
    } else {
      progress.clear();  // both may be the same terminal
      print(verdict_text(*verdict));
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

Verb add_check(CLI::App& app) {
  const auto options = std::make_shared<CheckOptions>();
  CLI::App* verb =
      app.add_subcommand("check", "Judge materials, textures and meshes as a physicist would")->group("Verbs");
  verb->add_option("SCENE", options->names,
                   "Files (.glb, .gltf, .obj, .fbx, .stl, .ply, .dae, .3ds, .3mf, a .zip with one of them), folders to "
                   "search for them, or demo:NAME")
      ->required()
      ->type_name("");
  add_root(verb, options->root);
  add_scene_choice(verb, options->scene);
  verb->add_flag("--json", options->json, "For a machine: one JSON object, with the measured numbers");
  verb->add_flag("--strict", options->strict, "Exit code 1 where there is a warning or an error");
  verb->add_option("--threads", options->threads, "Default: all the machine has")->type_name("N");
  verb->add_flag("-q,--quiet", options->quiet, "No progress on standard error");
  verb->footer(
      "Examples:\n  candela check helmet.glb\n  candela check assets/ --strict\n  candela check helmet.glb --json\n\n"
      "docs/check.md explains every finding. Ctrl-C keeps the verdicts so far (exit code 130).");
  return [options] { run_check(*options); };
}

}  // namespace candela::cli
