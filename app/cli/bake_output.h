#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "ibl/bake.h"
#include "ibl/sun.h"
#include "ibl/tables.h"

namespace candela::cli {

/// Everything `candela bake` made, and what it says about it.
struct BakeResult {
  std::string name;  ///< of the environment
  ibl::BakeSettings settings;
  std::optional<ibl::Bake> bake;  ///< absent for --tables alone
  std::optional<ibl::SunExtraction> suns;
  std::optional<ibl::Tables> tables;
  std::vector<Diagnostic> warnings;
  double bake_s = 0.0;
  double tables_s = 0.0;
};

/// Writes all files of a bake into `folder`, which is made where it is absent. They are made in a folder beside it
/// first and moved once all of them are whole. Throws Error.
void write_bake(const std::filesystem::path& folder, const BakeResult& result);

/// For a person, for a machine, and as one page of HTML with pictures in it.
std::string bake_text(const BakeResult& result);
std::string bake_json(const BakeResult& result);
std::string bake_html(const BakeResult& result);

}  // namespace candela::cli
