#include "candela/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

#include "base/parallel.h"
#include "base/text.h"
#include "io/foreign_scene.h"
#include "io/gltf_survey.h"
#include "io/scene_files.h"

namespace candela {

namespace fs = std::filesystem;
using check::Finding;
using check::Severity;

std::size_t Verdict::count(Severity severity) const {
  return static_cast<std::size_t>(std::count_if(
      findings.begin(), findings.end(), [severity](const NamedFinding& f) { return f.finding.severity == severity; }));
}

namespace {

std::size_t triangles_of(const Scene& scene) {
  std::size_t count = 0;
  for (const Mesh& mesh : scene.meshes) {
    for (const Primitive& primitive : mesh.primitives) count += primitive.triangles.size();
  }
  return count;
}

std::vector<NamedFinding> named(const Scene& scene, const FileSurvey* survey, std::vector<Finding> findings) {
  std::vector<NamedFinding> result;
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

Verdict verdict_of(const std::string& name, const check::CheckInput& input, const Job& job) {
  return {name, std::nullopt, named(input.scene, input.survey, check::check_asset(input, job)),
          input.scene.materials.size(), triangles_of(input.scene)};
}

/// What keeps a file from being judged: its images, each that fails, or else what the loader says.
std::vector<NamedFinding> causes(const std::string& name, const LoadOptions& options, const Error& error) {
  std::vector<NamedFinding> result;
  try {
    const FileSurvey survey = io::survey_gltf(name, {.read_geometry = false,
                                                     .decode_images = true,
                                                     .root = options.root,
                                                     .scene = options.scene,
                                                     .measures = options.measures});
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
void add_variant(const std::string& name, LoadOptions options, const std::string& variant, const check::Limits& limits,
                 Verdict& verdict) {
  Diagnostics diagnostics;
  options.variant = variant;
  const Scene scene = io::load_gltf(name, diagnostics, options);
  const auto key = [](const NamedFinding& t) { return t.finding.code + '\n' + t.material + '\n' + t.finding.message; };
  std::set<std::string> known;
  for (const NamedFinding& t : verdict.findings) known.insert(key(t));
  for (NamedFinding& own : named(scene, nullptr, check::check_asset({.scene = scene, .limits = limits}))) {
    if (known.contains(key(own))) continue;
    own.finding.subject += (own.finding.subject.empty() ? "" : ", ") + fmt::format("variant '{}'", variant);
    verdict.findings.push_back(std::move(own));
  }
}

JudgedScene judge_file(const std::string& name, const LoadOptions& options, const Job& job,
                       const check::Limits& limits) {
  JudgedScene judged;
  Diagnostics diagnostics;
  const io::FileInfo& info = judged.info;
  judged.scene = io::load_gltf(name, diagnostics, options, &judged.info);
  // Of an image that did not decode the survey says so, too.
  const bool has_lost_images =
      std::any_of(diagnostics.warnings().begin(), diagnostics.warnings().end(),
                  [](const Diagnostic& w) { return w.where.find("#/images/") != std::string::npos; });
  const FileSurvey survey = io::survey_gltf(
      name,
      {.decode_images = has_lost_images, .root = options.root, .scene = options.scene, .measures = options.measures});
  Verdict& verdict = judged.verdict;
  verdict = verdict_of(name,
                       {.scene = judged.scene,
                        .survey = &survey,
                        .extensions_used = info.extensions_used,
                        .extensions_ignored = info.extensions_ignored,
                        .extensions_missing = info.extensions_missing,
                        .warnings = diagnostics.warnings(),
                        .notes = diagnostics.notes(),
                        .limits = limits},
                       job);
  for (const std::string& variant : info.variants) add_variant(name, options, variant, limits, verdict);
  std::stable_sort(verdict.findings.begin(), verdict.findings.end(), [](const NamedFinding& a, const NamedFinding& b) {
    return a.finding.severity > b.finding.severity;
  });
  return judged;
}

bool is_scene_file(const fs::path& path) {
  const std::string extension = lower_extension(path);
  return extension == ".gltf" || extension == ".glb" || io::has_foreign_extension(path) ||
         (extension == ".zip" && io::is_scene_archive(path));
}

}  // namespace

JudgedScene judge_scene(const std::string& name, const LoadOptions& options, const Job& job,
                        const check::Limits& limits) {
  const StopScope scope(job.stop);
  if (!name.starts_with("demo:")) return judge_file(name, options, job, limits);
  JudgedScene judged;
  judged.scene = load(name, nullptr, options);
  judged.verdict = verdict_of(name, {.scene = judged.scene, .limits = limits}, job);
  return judged;
}

Verdict judge(const std::string& name, const LoadOptions& options, const Job& job, const check::Limits& limits) {
  const StopScope scope(job.stop);
  try {
    return judge_scene(name, options, job, limits).verdict;
  } catch (const Error& error) {
    if (name.starts_with("demo:")) throw;
    return {name, error.what(), causes(name, options, error)};
  }
}

Verdict judge(const std::string& name, const check::CheckInput& input, const Job& job) {
  const StopScope scope(job.stop);
  return verdict_of(name, input, job);
}

bool KnownFinding::operator<(const KnownFinding& other) const {
  const auto members = [](const KnownFinding& f) { return std::tie(f.file, f.code, f.material, f.texture, f.subject); };
  return members(*this) < members(other);
}

KnownFinding identity_of(const std::string& file, const NamedFinding& finding) {
  return {file, finding.finding.code, finding.material, finding.texture, finding.finding.subject};
}

std::size_t leave_out(const std::function<bool(const NamedFinding&)>& is_left_out, Verdict& verdict) {
  return std::erase_if(verdict.findings, is_left_out);
}

std::vector<std::string> find_scenes_below(const fs::path& folder) {
  std::vector<std::string> result;
  std::error_code code;
  fs::recursive_directory_iterator at(folder, fs::directory_options::skip_permission_denied, code);
  for (; !code && at != fs::recursive_directory_iterator(); at.increment(code)) {
    std::error_code ignored;
    const fs::path& path = at->path();
    if (is_scene_file(path) && at->is_regular_file(ignored)) result.push_back(path.string());
  }
  if (code) throw Error("cannot list the folder: " + code.message(), folder.string());
  std::sort(result.begin(), result.end());
  return result;
}

std::vector<std::string> scenes_below(const fs::path& folder) {
  std::vector<std::string> result = find_scenes_below(folder);
  if (result.empty()) throw Error("there is no scene in this folder", folder.string());
  return result;
}

}  // namespace candela
