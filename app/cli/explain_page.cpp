#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "cli/explain_report.h"
#include "cli/explain_words.h"
#include "cli/html.h"
#include "figures/markup.h"
#include "figures/plot.h"

namespace candela::cli {

using figures::escaped;

namespace {

constexpr const char* kStyle = R"css(
:root { color-scheme: light dark; }
body { font: 15px/1.5 system-ui, sans-serif; margin: 1em auto; padding: 0 1em; max-width: 70em; }
h1 { font-size: 1.4em; line-height: 1.2; overflow-wrap: anywhere; }
h2 { font-size: 1.2em; margin: 1.6em 0 .3em; }
h3 { font-size: 1em; margin: 1em 0 .2em; }
table { border-collapse: collapse; margin-bottom: .6em; }
math { display: inline math; }
th, td { text-align: left; padding: .15em .9em .15em 0; vertical-align: top; }
td { font-variant-numeric: tabular-nums; }
.wide { overflow-x: auto; }
.picture { position: relative; max-width: 100%; }
.picture img { display: block; width: 100%; }
.picture svg { position: absolute; inset: 0; width: 100%; height: 100%; }
.lobes { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(22em, 100%), 1fr)); gap: 1em; }
figure { margin: 0; }
figure img { width: 100%; height: auto; }
ol { padding-left: 1.4em; }
li { overflow-wrap: anywhere; }
)css";

std::string table_row(const std::vector<std::string>& cells, const char* tag = "td") {
  std::string html = "<tr>";
  for (const std::string& cell : cells) html += fmt::format("<{0}>{1}</{0}>", tag, escaped(cell));
  return html + "</tr>\n";
}

std::string table(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows) {
  if (rows.empty()) return "";
  std::string html = "<div class=\"wide\"><table>\n" + (head.empty() ? "" : table_row(head, "th"));
  for (const std::vector<std::string>& row : rows) html += table_row(row);
  return html + "</table></div>\n";
}

/// The picture with a cross at each pixel.
std::string picture_html(const Explanation& e) {
  std::string marks;
  for (std::size_t i = 0; i < e.pixels.size(); ++i) {
    const vec2 at = vec2(e.pixels[i].pixel) + 0.5f;
    const float arm = 0.02f * static_cast<float>(e.size.x), gap = 0.3f * arm;
    std::string cross;
    for (const vec2 way : {vec2(1, 0), vec2(-1, 0), vec2(0, 1), vec2(0, -1)}) {
      const vec2 from = at + gap * way, to = at + arm * way;
      cross += fmt::format("M{:.4g} {:.4g}L{:.4g} {:.4g}", from.x, from.y, to.x, to.y);
    }
    for (const char* stroke : {"stroke=\"#000\" stroke-width=\"3\"", "stroke=\"#fff\" stroke-width=\"1.2\""}) {
      marks += fmt::format("<path d=\"{}\" {} fill=\"none\" vector-effect=\"non-scaling-stroke\"/>", cross, stroke);
    }
    marks += fmt::format(
        "<text x=\"{:.4g}\" y=\"{:.4g}\" font-size=\"{:.4g}\" fill=\"#fff\" stroke=\"#000\" stroke-width=\".15em\" "
        "paint-order=\"stroke\">{}</text>",
        at.x + gap, at.y - gap, 1.4f * arm, i + 1);
  }
  return fmt::format(
      "<div class=\"picture\" style=\"width: {0}px\">{2}<svg viewBox=\"0 0 {0} {1}\" aria-hidden=\"true\">{3}</svg>"
      "</div>\n",
      e.size.x, e.size.y, image_element(develop(e.picture, e.develop), "the picture, with a cross at each pixel"),
      marks);
}

/// The lobes above the surface, or below. Radii are square roots, so that what is faint shows beside a highlight.
std::string lobes_html(const path::PixelSurface& s, bool is_below) {
  figures::PolarPlot plot;
  plot.title = is_below ? "lobes of light that comes through" : "lobes in the plane of incidence";
  plot.label = "√(f cos θ)";
  double most = 0.0;
  int ink = 0;
  for (const LobeCut& cut : cut_lobes(s)) {
    if (cut.is_below != is_below) continue;
    figures::Lobe lobe;
    lobe.label = cut.lobe;
    lobe.ink = figures::categorical_ink(ink++);
    for (const dvec2 point : cut.points) lobe.points.emplace_back(point.x, std::sqrt(point.y));
    for (const dvec2 point : lobe.points) most = std::max(most, point.y);
    plot.lobes.push_back(std::move(lobe));
  }
  if (plot.lobes.empty()) return "";
  plot.radius = 1.05 * most;
  if (!is_below) {
    plot.incoming = -static_cast<double>(angle_deg(s.wo.z));
    plot.incoming_label = "eye";
  }
  const char* words = is_below ? "Light from below, by its angle to the normal's opposite."
                               : "Light from each direction in the plane of the normal and the eye: the square root of "
                                 "the luminance of f cos θ, by lobe.";
  return fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n",
                     svg_element(figures::polar_plot_svg(plot), plot.title), words);
}

/// What no drawing can show.
std::string mirrors_html(const path::PixelSurface& s) {
  std::vector<std::string> mirrors;
  if (s.surface.is_mirror) mirrors.emplace_back("the facets");
  if ((s.surface.lobes & shade::kLobeClearcoat) != 0 && s.surface.is_coat_mirror) mirrors.emplace_back("the coat");
  if ((s.surface.lobes & shade::kLobeTransmission) != 0 && s.surface.is_glass_delta) mirrors.emplace_back("the glass");
  if (mirrors.empty()) return "";
  std::string list;
  for (const std::string& mirror : mirrors) list += (list.empty() ? "" : ", ") + mirror;
  return "<p>Smooth, so that each direction goes to one other, which is not drawn: " + list + ".</p>\n";
}

std::string surface_html(const Explanation& e, const PixelExplanation& p) {
  if (!p.surface) return "<p>The middle of the pixel sees no surface.</p>\n";
  const path::PixelSurface& s = *p.surface;
  std::string html = fmt::format(
      "<p>{}</p>\n",
      escaped(fmt::format("{}; at {} m, {:.4g} m from the eye, {:.1f}° from the normal", surface_words(*e.scene, s),
                          vec_words(s.where.position), s.distance, angle_deg(s.wo.z))));
  std::vector<std::vector<std::string>> rows;
  for (const PropertyValue& value : p.properties) {
    rows.push_back({std::string(value.name), property_words(value, value.value), property_origin(value)});
  }
  html += "<h3>Material</h3>\n" + table({"", "here", "from"}, rows);
  if (s.is_unlit) return html;
  rows.clear();
  for (const auto& [name, share] : shares_of(s)) rows.push_back({std::string(name), vec_words(share)});
  html += "<h3>Lobes</h3>\n<p>" + escaped(facets_words(s)) + "</p>\n<p>" +
          figures::mathml("f = \\frac{D G F}{4 \\op{cos} θ_i \\op{cos} θ_o}") + " of the facets.</p>\n" +
          table({"lobe", "of light that is the same from everywhere"}, rows) + "<div class=\"lobes\">" +
          lobes_html(s, false) + lobes_html(s, true) + "</div>\n" + mirrors_html(s);
  if (s.lamps.empty()) return html;
  html += "<h3>Lights</h3>\n<p>" + figures::mathml("L = f \\op{cos} θ · E") +
          " of each that is a point, a direction or a sun.</p>\n";
  rows.clear();
  for (const path::LampTerms& lamp : s.lamps) {
    std::string parts;
    for (const auto& [name, value] : parts_of(lamp.parts)) {
      parts += fmt::format("{}{} {}", parts.empty() ? "" : "; ", name, vec_words(value));
    }
    rows.push_back({lamp_name(*e.scene, lamp), fmt::format("{:.1f}°", angle_deg(lamp.wi.z)), vec_words(lamp.irradiance),
                    vec_words(lamp.visible), fmt::format("{:.4g}", lamp.facets.d), fmt::format("{:.4g}", lamp.facets.g),
                    vec_words(lamp.facets.f), parts, vec_words(lamp.radiance)});
  }
  return html + table({"light", "from the normal", "E", "arrives", "D", "G", "F", "f cos θ", "L"}, rows);
}

std::string frame_html(const PixelExplanation& p) {
  if (!p.frame) return "";
  const FrameTerms& frame = *p.frame;
  std::string html = fmt::format("<h3>The real-time frame</h3>\n<p>{}</p>\n",
                                 escaped(vec_words(frame.radiance) + ratio_words(frame.radiance, p.truth)));
  std::vector<std::vector<std::string>> rows;
  for (const FrameTerm& term : frame.terms) rows.push_back({frame_term_name(term), vec_words(term.radiance)});
  html += table({"part", "radiance"}, rows);
  if (!frame.far) return html;
  rows.clear();
  for (const FarLookup& read : frame.far->lookups) {
    const bool is_irradiance = read.lobe == "diffuse" || read.lobe == "below";
    rows.push_back(
        {std::string(read.lobe),
         is_irradiance ? "irradiance / π" : fmt::format("{:.2f} of 0 to {}", read.level, frame.far->levels - 1),
         vec_words(read.radiance), vec_words(read.share), vec_words(read.light)});
  }
  return html + "<p>What it reads of light from far away, were nothing in the way:</p>\n" +
         table({"lobe", "level", "radiance", "share", "light"}, rows) +
         fmt::format("<p>Irradiance {}; by nine spherical harmonics {}.</p>\n",
                     escaped(vec_words(frame.far->irradiance)), escaped(vec_words(frame.far->harmonics_irradiance)));
}

std::string truth_html(const Explanation& e, const PixelExplanation& p) {
  const path::PixelEstimate& truth = p.truth;
  std::string html =
      fmt::format("<h3>The path tracer</h3>\n<p>{} ± {} with 95 % confidence, of {} paths over the whole pixel.</p>\n",
                  vec_words(truth.mean), vec_words(kConfidence95 * truth.error), truth.samples);
  std::vector<std::vector<std::string>> rows;
  for (const path::SourceLight& light : truth.sources) {
    rows.push_back({source_name(*e.scene, light.source), vec_words(light.straight), vec_words(light.indirect)});
  }
  html += table({"source", "straight, or after one turn", "after more"}, rows);
  rows.clear();
  for (std::size_t i = 0; i < truth.turns.size(); ++i) {
    if (truth.turns[i] != vec3(0.0f)) rows.push_back({std::to_string(i), vec_words(truth.turns[i])});
  }
  html += table({"turns", "radiance"}, rows);
  if (truth.brightest.empty()) return html;
  html += "<h3>The brightest paths</h3>\n<ol>\n";
  for (const path::LightPath& path : truth.brightest) {
    html += fmt::format("<li>{}: {}</li>\n", vec_words(path.radiance), escaped(path_words(*e.scene, path)));
  }
  return html + "</ol>\n";
}

}  // namespace

std::string explain_page(const std::string& scene, const Explanation& e) {
  const std::string title = escaped("Pixels of " + scene);
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n"
      "<style>{}</style></head><body>\n<h1>{}</h1>\n<p>Radiances are linear, in cd/m² by channel.</p>\n",
      title, kStyle, title);
  html += picture_html(e);
  for (std::size_t i = 0; i < e.pixels.size(); ++i) {
    const PixelExplanation& p = e.pixels[i];
    html += fmt::format("<section><h2>{}. Pixel {},{}</h2>\n", i + 1, p.pixel.x, p.pixel.y) + surface_html(e, p) +
            frame_html(p) + truth_html(e, p) + "</section>\n";
  }
  return html + "</body></html>\n";
}

}  // namespace candela::cli
