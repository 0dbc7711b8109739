#include "cli/bake_output.h"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <nlohmann/json.hpp>
#include <system_error>

#include "base/error.h"
#include "base/file.h"
#include "image/film.h"

namespace candela::cli {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr std::array<const char*, 6> kFaceNames = {"px", "nx", "py", "ny", "pz", "nz"};

void write_image(const fs::path& path, const Image& image) {
  Film film;
  film.beauty = Image(image.width, image.height, 4);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      film.beauty.set_rgb(x, y, image.rgb(x, y));
      film.beauty.at(x, y)[3] = 1.0f;
    }
  }
  write_exr(path, film);
}

void write_faces(const fs::path& folder, const std::string& stem, const CubeFaces& faces) {
  for (std::size_t i = 0; i < faces.size(); ++i) {
    write_image(folder / fmt::format("{}_{}.exr", stem, kFaceNames[i]), faces[i]);
  }
}

void write_levels(const fs::path& folder, const std::string& stem, const Cubemap& cube) {
  for (std::size_t i = 0; i < cube.levels.size(); ++i) {
    write_faces(folder, fmt::format("{}_{}", stem, i), cube.levels[i]);
  }
}

Json vector_json(dvec3 v) { return {v.x, v.y, v.z}; }

std::string sh_json(const ibl::Bake& bake) {
  Json coefficients = Json::array();
  for (const dvec3& v : bake.sh.coefficients) coefficients.push_back(vector_json(v));
  return Json{{"what", "irradiance as real spherical harmonics, linear Rec.709, not divided by pi"},
              {"basis", "orthonormal, without the Condon-Shortley sign; (l, m) at l (l + 1) + m; polar axis z"},
              {"order", bake.sh.order},
              {"window_width", bake.sh_window_width},
              {"coefficients", coefficients}}
             .dump(2) +
         "\n";
}

Json sun_json(const ibl::Sun& sun) {
  const double luminance = 0.2126 * sun.illuminance.x + 0.7152 * sun.illuminance.y + 0.0722 * sun.illuminance.z;
  return {{"direction", vector_json(sun.direction)},
          {"angular_diameter_deg", 2.0 * sun.angular_radius * 180.0 / static_cast<double>(kPi)},
          {"illuminance", luminance},
          {"color", vector_json(sun.illuminance / luminance)}};
}

std::string suns_json(const ibl::SunExtraction& extraction) {
  Json suns = Json::array();
  for (const ibl::Sun& sun : extraction.suns) suns.push_back(sun_json(sun));
  return Json{{"what",
               "direction is towards the sun; illuminance is that of a surface facing it, in lux where radiance is in "
               "cd/m2; illuminance x color is linear Rec.709"},
              {"suns", suns}}
             .dump(2) +
         "\n";
}

/// The one place where files are made.
void write_files(const fs::path& folder, const BakeResult& result) {
  if (result.bake) {
    write_levels(folder, "specular", result.bake->specular);
    write_levels(folder, "sheen", result.bake->sheen);
    write_faces(folder, "irradiance", result.bake->irradiance);
    write_file(folder / "sh.json", sh_json(*result.bake));
  }
  if (result.suns) {
    write_file(folder / "suns.json", suns_json(*result.suns));
    write_image(folder / "without_suns.exr", result.suns->rest.map);
  }
  if (result.tables) {
    write_image(folder / "dfg.exr", result.tables->dfg);
    write_image(folder / "dfg_k_ibl.exr", result.tables->dfg_k_ibl);
  }
  write_file(folder / "bake.json", bake_json(result));
}

/// A folder that goes away with what is still in it.
class Workshop {
 public:
  explicit Workshop(const fs::path& beside)
      : path_(beside.parent_path() / fmt::format(".{}.{}", beside.filename().string(), ::getpid())) {
    std::error_code code;
    fs::create_directory(path_, code);
    if (code) throw Error("cannot make a folder: " + code.message(), beside.string());
  }
  ~Workshop() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Workshop(const Workshop&) = delete;
  Workshop& operator=(const Workshop&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

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

void write_bake(const fs::path& folder, const BakeResult& result) {
  const fs::path whole = folder.has_filename() ? folder : folder.parent_path();
  const Workshop workshop(fs::absolute(whole));
  write_files(workshop.path(), result);
  std::error_code code;
  fs::create_directory(whole, code);
  if (code) throw Error("cannot make the folder: " + code.message(), whole.string());
  for (const fs::directory_entry& file : fs::directory_iterator(workshop.path())) {
    fs::rename(file.path(), whole / file.path().filename(), code);
    if (code) throw Error("cannot write: " + code.message(), (whole / file.path().filename()).string());
  }
}

std::string bake_json(const BakeResult& result) {
  Json json = {{"environment", result.name}};
  if (result.bake) {
    const ibl::Bake& bake = *result.bake;
    json["size"] = result.settings.size;
    json["energy"] = {{"in", vector_json(bake.flux_in)}, {"out", vector_json(bake.flux_out)}};
    json["specular"] = levels_json(bake.levels, result.settings.size);
    if (!bake.sheen.empty()) json["sheen"] = levels_json(bake.sheen_levels, result.settings.size);
    json["irradiance"] = levels_json({bake.irradiance_level}, result.settings.irradiance_size)[0];
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
  if (result.suns) {
    json["suns"] = Json::array();
    for (const ibl::Sun& sun : result.suns->suns) json["suns"].push_back(sun_json(sun));
  }
  if (result.tables) json["tables"] = {{"size", result.tables->dfg.width}, {"seconds", result.tables_s}};
  json["warnings"] = Json::array();
  for (const Diagnostic& warning : result.warnings) json["warnings"].push_back(warning.text());
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
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
        text += level_text(fmt::format("{} {}", name, i), result.settings.size >> i, method_name(levels[i].method),
                           levels[i]);
      }
    };
    lines("specular", bake.levels);
    lines("sheen", bake.sheen_levels);
    text += level_text("irradiance", result.settings.irradiance_size, "", bake.irradiance_level);
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

}  // namespace candela::cli
