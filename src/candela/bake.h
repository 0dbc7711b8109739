#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "candela/light.h"
#include "ibl/profile.h"
#include "ibl/sun.h"
#include "ibl/tables.h"
#include "image/texture_file.h"

/// Recipes of image-based light: what to bake, the work, and its files.
namespace candela {

/// How a bake is written if it is for no engine of ibl/profile.h.
struct BakeFormat {
  enum class Kind { faces, panorama, rgbm, texture, gltf } kind = Kind::faces;
  std::string extension = ".exr";  ///< of faces
  TextureOptions texture;
};

/// What to bake. An Error about a member names the option of `candela bake` that sets it.
struct BakeOrder {
  LightChoice light = {};  ///< without an environment and a scene: the tables alone
  ibl::BakeSettings settings = {};
  BakeFormat format = {};
  const ibl::Profile* profile = nullptr;  ///< the engine that takes the files, in place of `format`
  bool extracts_suns = false;
  std::optional<int> table_size = {};  ///< of the split-sum tables

  bool has_light() const { return !light.environment.empty() || !light.scene.empty(); }
};

/// Size, levels and their roughness as the order's engine reads them. What is given here is kept.
void follow_profile(std::optional<int> size, std::optional<int> levels, BakeOrder& order);
/// The same for EXT_lights_image_based: roughness grows evenly with the levels, of which the last is about 16 x 16.
void follow_gltf(std::optional<int> levels, std::optional<ibl::Mapping> mapping, BakeOrder& order);

/// Throws Error for settings that no bake, or not the order's format, can have.
void check_order(const BakeOrder& order);

/// Everything that was made for an order.
struct BakeResult {
  std::string name;  ///< of the environment
  BakeOrder order;
  std::optional<Image> panorama;  ///< what was baked, if it came as one and is complete
  std::optional<ibl::Bake> bake;  ///< none of tables alone
  std::optional<ibl::SunExtraction> suns;
  std::optional<ibl::Tables> tables;
  std::vector<Diagnostic> warnings;
  double bake_s = 0.0;
  double tables_s = 0.0;
};

/// Makes everything that is asked for, from the light that load_light() gave; null for tables alone. Throws Error as
/// check_order() and bake_light(), Interrupted after a stop.
BakeResult bake(const BakeOrder& order, const LoadedLight* light, const Job& job = {});
/// The same with load_light().
BakeResult bake(const BakeOrder& order, const Job& job = {});

/// Writes all files of a bake into `folder`, which exists: those of the order's engine, or its format, the harmonics,
/// the tables, and `suns.json` with `without_suns.exr`. What a format cannot hold becomes a warning. Throws Error.
void write_bake_files(const std::filesystem::path& folder, BakeResult& result);

/// The text of `suns.json`.
std::string suns_json(const ibl::SunExtraction& extraction);

}  // namespace candela
