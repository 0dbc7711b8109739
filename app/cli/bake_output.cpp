#include "cli/bake_output.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/text.h"
#include "cli/json_text.h"
#include "ibl/profile_code.h"
#include "image/cube_layout.h"

namespace candela::cli {

using Json = nlohmann::ordered_json;

namespace {

Json vector_json(dvec3 v) { return {v.x, v.y, v.z}; }

Json error_json(const ibl::ErrorBound& error) { return {{"max", error.max}, {"rms", error.rms}}; }

std::string_view method_name(ibl::Method method) {
  switch (method) {
    case ibl::Method::zonal:
      return "zonal";
    case ibl::Method::hierarchical:
      return "hierarchical";
    case ibl::Method::fis:
      return "fis";
    case ibl::Method::montecarlo:
      return "montecarlo";
    case ibl::Method::automatic:
      break;
  }
  return "mirror";
}

Json levels_json(const std::vector<ibl::Level>& levels, int size) {
  Json rows = Json::array();
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const ibl::Level& level = levels[i];
    Json row = {
        {"level", i}, {"size", size >> i}, {"roughness", level.roughness}, {"method", method_name(level.method)}};
    if (level.proof.at_texels.directions > 0) {
      row["error_at_texels"] = error_json(level.proof.at_texels);
      row["error_between"] = error_json(level.proof.between);
      row["refinements"] = level.refinements;
    }
    rows.push_back(row);
  }
  return rows;
}

std::string level_text(const std::string& name, int size, std::string_view method, const ibl::Level& level) {
  std::string text = fmt::format("{:<18} {:>5} {:>10.4g} {:<13}", name, size, level.roughness, method);
  const auto percent = [](double v) { return fmt::format("{:.2g} %", 100.0 * v); };
  if (level.proof.at_texels.directions > 0) {
    text += fmt::format("{:>12} {:>11} {:>12} {:>11}", percent(level.proof.at_texels.max),
                        percent(level.proof.at_texels.rms), percent(level.proof.between.max),
                        percent(level.proof.between.rms));
  }
  text.erase(text.find_last_not_of(' ') + 1);
  return text + "\n";
}

}  // namespace

std::string bake_json(const BakeResult& result, const std::vector<BakeFile>& files) {
  Json json = {{"environment", result.name}};
  if (result.order.profile != nullptr) json["profile"] = result.order.profile->name;
  if (result.bake) {
    const ibl::Bake& bake = *result.bake;
    json["size"] = result.order.settings.size;
    json["energy"] = {{"in", vector_json(bake.flux_in)}, {"out", vector_json(bake.flux_out)}};
    json["specular"] = levels_json(bake.levels, result.order.settings.size);
    if (!bake.sheen.empty()) json["sheen"] = levels_json(bake.sheen_levels, result.order.settings.size);
    json["irradiance"] = levels_json({bake.irradiance_level}, result.order.settings.irradiance_size)[0];
    json["irradiance"].erase("level");
    json["irradiance"].erase("method");
    json["irradiance"].erase("roughness");
    json["sh"] = {{"order", bake.sh.order}, {"window_width", bake.sh_window_width}};
    if (bake.sh_error.directions > 0) {
      json["sh"]["error"] = error_json(bake.sh_error);
      json["proof"] = {{"directions", bake.sh_error.directions},
                       {"confidence", bake.sh_error.confidence},
                       {"share_exceeding_max", bake.sh_error.exceeding},
                       {"relative_to", "the exact value at the same direction, lengths of RGB vectors"}};
    }
    json["bake_s"] = result.bake_s;
  }
  if (result.suns) json["suns"] = Json::parse(suns_json(*result.suns))["suns"];
  if (result.tables) json["tables"] = {{"size", result.tables->dfg.width}, {"seconds", result.tables_s}};
  if (!files.empty()) json["files"] = Json::array();
  for (const BakeFile& file : files) {
    json["files"].push_back(
        {{"name", file.name}, {"bytes", file.bytes}, {"fingerprint", fmt::format("{:016x}", file.fingerprint)}});
  }
  json["warnings"] = Json::array();
  for (const Diagnostic& warning : result.warnings) json["warnings"].push_back(warning.text());
  return json_text(json);
}

std::string bake_text(const BakeResult& result) {
  std::string text;
  if (result.bake) {
    const ibl::Bake& bake = *result.bake;
    const dvec3 change = bake.flux_out - bake.flux_in;
    text +=
        fmt::format("energy in  {:.7g} {:.7g} {:.7g}\nenergy out {:.7g} {:.7g} {:.7g}  ({:.1e} of it lost or won)\n",
                    bake.flux_in.x, bake.flux_in.y, bake.flux_in.z, bake.flux_out.x, bake.flux_out.y, bake.flux_out.z,
                    glm::length(change) / glm::length(bake.flux_in));
    const int n = bake.sh_error.directions;
    text += fmt::format("\n{:<18} {:>5} {:>10} {:<13}", "", "size", "roughness", "method");
    text += n > 0 ? "   at texels: max     rms    between: max     rms\n" : "\n";
    const auto lines = [&](const char* name, const std::vector<ibl::Level>& levels) {
      for (std::size_t i = 0; i < levels.size(); ++i) {
        text += level_text(fmt::format("{} {}", name, i), result.order.settings.size >> i,
                           method_name(levels[i].method), levels[i]);
      }
    };
    lines("specular", bake.levels);
    lines("sheen", bake.sheen_levels);
    text += level_text("irradiance", result.order.settings.irradiance_size, "", bake.irradiance_level);
    if (n > 0) {
      text += fmt::format("irradiance as harmonics of order {}: max {:.2g} %, rms {:.2g} %\n", bake.sh.order,
                          100.0 * bake.sh_error.max, 100.0 * bake.sh_error.rms);
      text += fmt::format(
          "\nErrors are relative to the exact integral at the same direction, {} directions each: with {:.0f} %\n"
          "confidence at most {:.1f} % of all directions err by more than the maximum. 'between' is what a bilinear\n"
          "lookup of the texels adds.\n",
          n, 100.0 * bake.sh_error.confidence, 100.0 * bake.sh_error.exceeding);
    }
  }
  if (result.suns) {
    for (const ibl::Sun& sun : result.suns->suns) {
      text += fmt::format("sun towards {:.4f} {:.4f} {:.4f}, {:.2f} degrees wide, illuminance {:.5g} {:.5g} {:.5g}\n",
                          sun.direction.x, sun.direction.y, sun.direction.z,
                          2.0 * sun.angular_radius * 180.0 / static_cast<double>(kPi), sun.illuminance.x,
                          sun.illuminance.y, sun.illuminance.z);
    }
    if (result.suns->suns.empty()) text += "no sun: nothing small is bright enough\n";
  }
  if (result.tables) {
    text += fmt::format("tables of {0}x{0} in {1:.2f} s\n", result.tables->dfg.width, result.tables_s);
  }
  return text;
}

std::string profile_text(const ibl::Profile& profile) {
  std::string text = fmt::format("\n{} loads it so:\n\n{}", profile.engine, ibl::loading_code(profile));
  const std::string_view panorama = ibl::panorama_code(profile);
  if (panorama.empty()) return text;
  return text + fmt::format("\n{} also reads a panorama itself, and filters it:\n\n{}", profile.engine, panorama);
}

std::string diff_text(const std::vector<CubeLevelDifference>& levels) {
  std::string text = fmt::format("{:>5} {:>6} {:>11} {:>11} {:>11} {:>13}  {}\n", "level", "size", "max", "rms", "mean",
                                 "max absolute", "where");
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const CubeLevelDifference& d = levels[i];
    const auto percent = [](double v) { return fmt::format("{:.3g} %", 100.0 * v); };
    text += fmt::format("{:>5} {:>6} {:>11} {:>11} {:>11} {:>13.4g}  {} {},{}\n", i, d.size, percent(d.max_relative),
                        percent(d.rms_relative), percent(d.mean_relative), d.max_absolute,
                        kFaceNames[static_cast<std::size_t>(d.face)], d.x, d.y);
    if (d.non_finite > 0) text += fmt::format("      {} not finite, left out\n", counted(d.non_finite, "texel"));
  }
  return text;
}

std::string diff_json(const std::vector<CubeLevelDifference>& levels) {
  Json rows = Json::array();
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const CubeLevelDifference& d = levels[i];
    rows.push_back({{"level", i},
                    {"size", d.size},
                    {"max", d.max_relative},
                    {"rms", d.rms_relative},
                    {"mean", d.mean_relative},
                    {"max_absolute", d.max_absolute},
                    {"face", kFaceNames[static_cast<std::size_t>(d.face)]},
                    {"texel", {d.x, d.y}},
                    {"not_finite", d.non_finite}});
  }
  return json_text({{"levels", rows}});
}

}  // namespace candela::cli
