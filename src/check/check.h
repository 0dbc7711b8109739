#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/diagnostics.h"
#include "image/job.h"
#include "scene/file_survey.h"
#include "scene/scene.h"

namespace candela::check {

enum class Severity {
  note,     ///< worth knowing; the asset may mean it
  warning,  ///< no real surface or lamp is like that, or viewers will disagree about it
  error     ///< something the asset needs is not there
};
const char* severity_name(Severity severity);

/// One thing that a check found. docs/check.md explains every code.
struct Finding {
  Severity severity = Severity::note;
  std::string code;     ///< "metal-too-dark"
  int material = -1;    ///< of the scene
  int texture = -1;     ///< of the scene
  std::string subject;  ///< what it is about where that is neither material nor texture; may be empty
  /// Fraction of what `share_of` names that it concerns.
  std::optional<double> share = std::nullopt;
  std::string share_of = "surface";
  std::string message;  ///< what was measured, against what
  std::string fix;      ///< what mends it, where that is mechanical
  std::vector<std::pair<std::string, double>> measured = {};
};

/// Above and below what something is told; each is a row of limit_rows(). What bounds an asset's size is unlimited.
struct Limits {
  double brightest_albedo = 0.9;         ///< white paint has 0.85
  double darkest_albedo = 0.02;          ///< charcoal
  double darkest_metal = 0.4;            ///< four fifths of tungsten
  double least_roughness = 0.02;         ///< facets of a ten-thousandth
  double triangles = kInfinity;          ///< of all meshes
  double materials = kInfinity;          ///< that the file has
  double texture_size = kInfinity;       ///< texels, of the longer side
  double texture_megabytes = kInfinity;  ///< of all images, decoded, in 10⁶ bytes
};
struct LimitRow {
  const char* name;  ///< the finding's code
  double Limits::*limit;
  double low, high;  ///< what it may be
};
/// What Limits has, by the findings' codes.
std::span<const LimitRow> limit_rows();

/// All codes of findings, sorted.
std::span<const std::string> finding_codes();

/// What is known of an asset. Whatever a file alone can tell is empty for scenes made in code.
struct CheckInput {
  const Scene& scene;
  const FileSurvey* survey = nullptr;
  std::vector<std::string> extensions_used = {};
  std::vector<std::string> extensions_ignored = {};  ///< not supported
  std::vector<std::string> extensions_missing = {};  ///< required, but not supported
  std::span<const Diagnostic> warnings = {};         ///< of the loader
  std::span<const Diagnostic> notes = {};            ///< of the loader
  Limits limits = {};
};

/// Judges surfaces, textures, bodies, lights and the file. The same scene gives the same findings in the same order,
/// errors first. Points on surfaces are spread by area over all instances, with a low-discrepancy sequence; the area of
/// an instance counts by the volume scale of its transform (exact for similarities). Throws Interrupted after a stop.
std::vector<Finding> check_asset(const CheckInput& input, const Job& job = {});

/// The part of it that needs no scene: images that cannot be read.
std::vector<Finding> check_images(const FileSurvey& survey);

/// "material 'Body'", "material 3" without a name; the same for textures, which fall back on the file's image names.
std::string material_label(const Scene& scene, int material);
std::string texture_label(const Scene& scene, int texture, const FileSurvey* survey);

}  // namespace candela::check
