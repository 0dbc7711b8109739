#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string_view>

#include "base/file.h"
#include "base/text.h"
#include "candela/bake.h"
#include "candela/bake_gltf.h"
#include "ibl/cube.h"
#include "ibl/profile_files.h"
#include "image/cube_file.h"
#include "image/table_file.h"

namespace candela {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

/// Colours of up to 256 times white, finer in the dark than without the square.
constexpr Rgbm kRgbm{.range = 16.0f, .is_squared = true};

/// A cube of the world as `stem` of the format: addressed by the direction itself in textures, as seen from inside in
/// pictures.
EncodingLoss write_cube(const fs::path& folder, const std::string& stem, const Cubemap& cube,
                        const BakeFormat& format) {
  EncodingLoss loss;
  if (format.kind == BakeFormat::Kind::texture) {
    return write_texture(folder / (stem + container_extension(format.texture.container)), cube, format.texture);
  }
  if (format.kind == BakeFormat::Kind::faces) {
    write_cube_faces(folder / (stem + format.extension), file_from_world(cube, kPictureAxes));
    return loss;
  }
  for (std::size_t level = 0; level < cube.levels.size(); ++level) {
    const std::string name = cube.levels.size() > 1 ? fmt::format("{}_m{}", stem, level) : stem;
    if (format.kind == BakeFormat::Kind::panorama) {
      write_linear_image(folder / (name + ".exr"), ibl::equirect_from_cube(cube.levels[level], 4 * cube.size(level)));
      continue;
    }
    const CubeFaces faces = file_from_world(cube.levels[level], kPictureAxes);
    for (std::size_t i = 0; i < faces.size(); ++i) {
      loss += write_rgbm_png(folder / fmt::format("{}_{}.png", name, kFaceNames[i]), faces[i], kRgbm);
    }
  }
  return loss;
}

Json vector_json(dvec3 v) { return {v.x, v.y, v.z}; }

Json sun_json(const ibl::Sun& sun) {
  const double illuminance = luminance(sun.illuminance);
  return {{"direction", vector_json(sun.direction)},
          {"angular_diameter_deg", 2.0 * sun.angular_radius * 180.0 / static_cast<double>(kPi)},
          {"illuminance", illuminance},
          {"color", vector_json(sun.illuminance / illuminance)}};
}

void write_harmonics(const fs::path& folder, const BakeResult& result) {
  const ShText text{.unit = "irradiance",
                    .basis = "real, orthonormal, without the Condon-Shortley sign, l (l + 1) + m",
                    .axes = axes_text(CubeAxes()),
                    .source = result.name};
  write_sh_json(folder / "sh.json", result.bake->sh.coefficients, text);
  write_sh_header(folder / "sh.h", result.bake->sh.coefficients, text, "sh");
}

void write_table(const fs::path& folder, const std::string& stem, const Image& table, const TableText& text) {
  write_linear_image(folder / (stem + ".exr"), table);
  write_texture(folder / (stem + ".ktx2"), table, {.format = TexelFormat::rgba32f});
  write_table_json(folder / (stem + ".json"), table, text);
  write_table_header(folder / (stem + ".h"), table, text, stem);
}

void write_tables(const fs::path& folder, const ibl::Tables& tables) {
  const std::string columns = "NoV, in the middle of texels";
  const std::string rows = "roughness, in the middle of texels";
  write_table(folder, "dfg", tables.dfg,
              {"split sum of GGX: F0 scale + F90 bias; directional albedo of the sheen lobe",
               columns,
               rows,
               {"scale", "bias", "sheen"}});
  write_table(folder, "dfg_k_ibl", tables.dfg_k_ibl,
              {"split sum of GGX with Schlick's masking, k = roughness^2 / 2", columns, rows, {"scale", "bias"}});
}

/// What an engine takes, in its own words.
EncodingLoss write_for_engine(const fs::path& folder, const BakeResult& result) {
  ibl::BakedLight light;
  light.source = result.name;
  if (result.bake) {
    light.specular = &result.bake->specular;
    light.diffuse = &result.bake->irradiance;
    light.sh = result.bake->sh_radiance.coefficients;
    if (result.panorama) light.panorama = &*result.panorama;
  }
  if (result.tables) light.table = &result.tables->dfg;
  return ibl::write_for(*result.order.profile, folder, light).loss;
}

EncodingLoss write_plain(const fs::path& folder, const BakeResult& result) {
  EncodingLoss loss;
  if (result.bake) {
    if (result.order.format.kind == BakeFormat::Kind::gltf) {
      loss += write_gltf_light(folder, result);
      if (result.tables) write_tables(folder, *result.tables);
      return loss;
    }
    loss += write_cube(folder, "specular", result.bake->specular, result.order.format);
    if (!result.bake->sheen.empty()) loss += write_cube(folder, "sheen", result.bake->sheen, result.order.format);
    loss += write_cube(folder, "irradiance", cube_of_one_level(result.bake->irradiance), result.order.format);
    write_harmonics(folder, result);
  }
  if (result.tables) write_tables(folder, *result.tables);
  return loss;
}

}  // namespace

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

void write_bake_files(const fs::path& folder, BakeResult& result) {
  const EncodingLoss loss =
      result.order.profile != nullptr ? write_for_engine(folder, result) : write_plain(folder, result);
  if (loss.clamped > 0) {
    result.warnings.push_back(
        {fmt::format("{} above what the format holds {} clamped, the brightest was {:.4g}",
                     counted(loss.clamped, "texel"), loss.clamped == 1 ? "was" : "were", loss.largest),
         ""});
  }
  if (result.suns) {
    write_file(folder / "suns.json", suns_json(*result.suns));
    write_linear_image(folder / "without_suns.exr", result.suns->rest.map);
  }
}

}  // namespace candela
