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

/// What is known of an asset. Whatever a file alone can tell is empty for scenes made in code.
struct CheckInput {
  const Scene& scene;
  const FileSurvey* survey = nullptr;
  std::vector<std::string> extensions_used = {};
  std::vector<std::string> extensions_ignored = {};  ///< not supported
  std::vector<std::string> extensions_missing = {};  ///< required, but not supported
  std::span<const Diagnostic> warnings = {};         ///< of the loader
  std::span<const Diagnostic> notes = {};            ///< of the loader
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
