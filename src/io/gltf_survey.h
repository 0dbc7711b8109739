#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "foreign/measures.h"
#include "scene/file_survey.h"

namespace candela::io {

struct SurveyOptions {
  bool read_geometry = true;        ///< false: FileSurvey::primitives stays empty
  bool decode_images = false;       ///< false: an image whose header is whole passes for readable
  std::filesystem::path root = {};  ///< as LoadOptions::root
  std::string scene = {};           ///< as LoadOptions::scene
  foreign::Measures measures = {};  ///< as LoadOptions::measures
};

/// Looks through what the scene of a .gltf or .glb uses, and remembers oddities where load_gltf puts them right
/// or stops. An image that cannot be read is no Error here; whatever else is wrong throws Error as in load_gltf.
FileSurvey survey_gltf(const std::filesystem::path& path, const SurveyOptions& options);

/// The same from memory; an empty `base_folder` refuses external files.
FileSurvey survey_gltf(std::span<const std::byte> bytes, const std::filesystem::path& base_folder,
                       const SurveyOptions& options);

}  // namespace candela::io
