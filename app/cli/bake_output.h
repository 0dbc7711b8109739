#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "candela/bake.h"
#include "cli/inputs.h"
#include "image/cube_metrics.h"

namespace candela::cli {

/// A file of a bake, as bake.json lists it: what the next bake into the folder may take away.
struct BakeFile {
  std::string name;
  std::uint64_t bytes = 0;
  std::uint64_t fingerprint = 0;  ///< of its content
};

/// Writes all files of a bake into `folder`, which is made where it is absent. They are made in a folder beside it
/// first and moved once all of them are whole; where that fails, what was there before is put back. What bake.json
/// lists of an earlier bake, and nobody has changed since, goes; what this bake reads stays. What a format cannot hold
/// becomes a warning. Throws Error where a file of `inputs` or `report` (empty: none) would be overwritten, Interrupted
/// as StopScope says. Returns the files that are there, but for bake.json.
std::vector<BakeFile> write_bake(const std::filesystem::path& folder, const Inputs& inputs,
                                 const std::filesystem::path& report, BakeResult& result);

/// For a person, for a machine, and as one page of HTML with pictures in it.
std::string bake_text(const BakeResult& result);
std::string bake_json(const BakeResult& result, const std::vector<BakeFile>& files);
std::string bake_html(const BakeResult& result);

/// How the engine loads it, and whether it could do without.
std::string profile_text(const ibl::Profile& profile);

std::string diff_text(const std::vector<CubeLevelDifference>& levels);
std::string diff_json(const std::vector<CubeLevelDifference>& levels);

}  // namespace candela::cli
