#include <fmt/format.h>

#include "cli/bake_output.h"
#include "cli/html.h"
#include "figures/markup.h"

namespace candela::cli {

namespace {

using figures::escaped;

/// Six faces beside each other, in the order of the file.
Film strip(const CubeFaces& faces, float scale) {
  const int size = faces[0].width;
  Film film;
  film.beauty = Image(6 * size, size, 4);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < 6 * size; ++x) {
      film.beauty.set_rgb(x, y, scale * faces[static_cast<std::size_t>(x / size)].rgb(x % size, y));
      film.beauty.at(x, y)[3] = 1.0f;
    }
  }
  return film;
}

std::string picture(const Film& film, float exposure, const std::string& what) {
  return image_element(develop(film, {.exposure = exposure}), what);
}

std::string error_cells(const ibl::LevelProof& proof) {
  if (proof.at_texels.directions == 0) return "<td colspan=\"4\">not measured</td>";
  return fmt::format("<td>{:.2g} %</td><td>{:.2g} %</td><td>{:.2g} %</td><td>{:.2g} %</td>",
                     100.0 * proof.at_texels.max, 100.0 * proof.at_texels.rms, 100.0 * proof.between.max,
                     100.0 * proof.between.rms);
}

std::string table_row(const std::string& name, int size, const ibl::Level& level) {
  return fmt::format("<tr><td>{}</td><td>{}²</td><td>{:.4g}</td>{}</tr>\n", name, size, level.roughness,
                     error_cells(level.proof));
}

std::string error_table(const BakeResult& result) {
  const ibl::Bake& bake = *result.bake;
  std::string html =
      "<table><tr><th rowspan=\"2\"></th><th rowspan=\"2\">faces</th><th rowspan=\"2\">roughness</th>"
      "<th colspan=\"2\">error at texels</th><th colspan=\"2\">error between them</th></tr>"
      "<tr><th>max</th><th>rms</th><th>max</th><th>rms</th></tr>\n";
  for (std::size_t i = 0; i < bake.levels.size(); ++i) {
    if (bake.levels[i].roughness > 0.0) {
      html += table_row(fmt::format("specular {}", i), result.order.settings.size >> i, bake.levels[i]);
    }
  }
  for (std::size_t i = 0; i < bake.sheen_levels.size(); ++i) {
    if (bake.sheen_levels[i].roughness > 0.0) {
      html += table_row(fmt::format("sheen {}", i), result.order.settings.size >> i, bake.sheen_levels[i]);
    }
  }
  html += table_row("irradiance", result.order.settings.irradiance_size, bake.irradiance_level) + "</table>\n";
  if (bake.sh_error.directions == 0) return html;
  return html + fmt::format(
                    "<p>Irradiance as spherical harmonics of order {}: max {:.2g} %, rms {:.2g} %.</p>\n<p>Errors are "
                    "relative to the exact integral over every texel of the source at the same direction ({} random "
                    "directions each, lengths of RGB vectors). With {:.0f} % confidence at most {:.1f} % of all "
                    "directions err by more than the maximum. “Between” is a bilinear lookup across seams: what the "
                    "size of a texel adds.</p>\n",
                    bake.sh.order, 100.0 * bake.sh_error.max, 100.0 * bake.sh_error.rms, bake.sh_error.directions,
                    100.0 * bake.sh_error.confidence, 100.0 * bake.sh_error.exceeding);
}

std::string pictures(const BakeResult& result) {
  const ibl::Bake& bake = *result.bake;
  const float exposure = metered_exposure(strip(bake.specular.levels[0], 1.0f));
  std::string html;
  const auto cube = [&](const char* name, const Cubemap& levels, const std::vector<ibl::Level>& facts) {
    for (std::size_t i = 0; i < levels.levels.size(); ++i) {
      html += fmt::format("<h3>{} {}, roughness {:.4g}</h3>\n", name, i, facts[i].roughness);
      html += picture(strip(levels.levels[i], 1.0f), exposure, fmt::format("{} level {}", name, i));
    }
  };
  cube("specular", bake.specular, bake.levels);
  cube("sheen", bake.sheen, bake.sheen_levels);
  html += "<h3>irradiance / π</h3>\n" + picture(strip(bake.irradiance, 1.0f / kPi), exposure, "irradiance");
  return html;
}

}  // namespace

std::string bake_html(const BakeResult& result) {
  const ibl::Bake& bake = *result.bake;
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Bake of {0}</title>\n<style>\n"
      "body {{ font: 15px/1.5 system-ui, sans-serif; max-width: 70em; margin: 2em auto; padding: 0 1em; }}\n"
      "table {{ border-collapse: collapse; }} td, th {{ padding: 0.2em 1em; border-bottom: 1px solid #ccc; "
      "text-align: right; }} td:first-child {{ text-align: left; }}\n"
      "img {{ width: 100%; image-rendering: pixelated; display: block; }} h3 {{ margin: 1em 0 0.3em; }}\n"
      "</style></head><body>\n<h1>Bake of {0}</h1>\n",
      escaped(result.name));
  html += fmt::format(
      "<p>Energy in {:.7g} {:.7g} {:.7g}, out {:.7g} {:.7g} {:.7g}: changed by {:.1e} of itself. Baked and proved in "
      "{:.2f} s.</p>\n",
      bake.flux_in.x, bake.flux_in.y, bake.flux_in.z, bake.flux_out.x, bake.flux_out.y, bake.flux_out.z,
      glm::length(bake.flux_out - bake.flux_in) / glm::length(bake.flux_in), result.bake_s);
  for (const Diagnostic& warning : result.warnings) {
    html += fmt::format("<p><b>Warning:</b> {}</p>\n", escaped(warning.text()));
  }
  html += "<h2>Errors</h2>\n" + error_table(result) + "<h2>Faces +x −x +y −y +z −z</h2>\n" + pictures(result);
  return html + "</body></html>\n";
}

}  // namespace candela::cli
