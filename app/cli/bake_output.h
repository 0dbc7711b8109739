#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "cli/inputs.h"
#include "ibl/bake.h"
#include "ibl/profile.h"
#include "ibl/sun.h"
#include "ibl/tables.h"
#include "image/cube_metrics.h"
#include "image/texture_file.h"

namespace candela::cli {

/// How a bake is written where no engine is asked for.
struct BakeFormat {
  enum class Kind { faces, panorama, rgbm, texture, gltf } kind = Kind::faces;
  std::string extension = ".exr";  ///< of faces
  TextureOptions texture;
};

/// A file of a bake, as bake.json lists it: what the next bake into the folder may take away.
struct BakeFile {
  std::string name;
  std::uint64_t bytes = 0;
  std::uint64_t fingerprint = 0;  ///< of its content
};

/// Everything `candela bake` made, and what it says about it.
struct BakeResult {
  std::string name;  ///< of the environment
  ibl::BakeSettings settings;
  BakeFormat format;
  const ibl::Profile* profile = nullptr;  ///< the engine that it is written for, or none
  std::optional<Image> panorama;          ///< what was baked, where it came as one that nothing has to be added to
  std::optional<ibl::Bake> bake;          ///< absent for --tables alone
  std::optional<ibl::SunExtraction> suns;
  std::optional<ibl::Tables> tables;
  std::vector<Diagnostic> warnings;
  std::vector<BakeFile> files;  ///< that are written, but for bake.json
  double bake_s = 0.0;
  double tables_s = 0.0;
};

/// Writes all files of a bake into `folder`, which is made where it is absent. They are made in a folder beside it
/// first and moved once all of them are whole; where that fails, what was there before is put back. What bake.json
/// lists of an earlier bake, and nobody has changed since, goes; what this bake reads stays. What a format cannot hold
/// becomes a warning. Throws Error where a file of `inputs` or `report` (empty: none) would be overwritten, Interrupted
/// as StopScope says.
void write_bake(const std::filesystem::path& folder, const Inputs& inputs, const std::filesystem::path& report,
                BakeResult& result);

/// The files themselves, but for bake.json.
void make_bake_files(const std::filesystem::path& folder, BakeResult& result);

/// `environment.gltf`, whose scene EXT_lights_image_based lights with the bake, and its faces in RGBD. Of three bands
/// of harmonics or more, the first three.
EncodingLoss write_gltf_light(const std::filesystem::path& folder, const BakeResult& result);

/// For a person, for a machine, and as one page of HTML with pictures in it.
std::string bake_text(const BakeResult& result);
std::string bake_json(const BakeResult& result);
std::string bake_html(const BakeResult& result);

/// How the engine loads it, and whether it could do without.
std::string profile_text(const ibl::Profile& profile);

std::string diff_text(const std::vector<CubeLevelDifference>& levels);
std::string diff_json(const std::vector<CubeLevelDifference>& levels);

}  // namespace candela::cli
