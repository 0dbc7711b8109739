#include "cli/gap_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/html.h"
#include "cli/json_text.h"
#include "cli/pair_page.h"
#include "cli/values.h"
#include "figures/markup.h"

namespace candela::cli {

using Json = nlohmann::ordered_json;
using figures::escaped;

namespace {

constexpr const char* kBackground = "(background)";

/// What people want to see of a long list.
constexpr std::size_t kMaterialsShown = 12;

std::string percent_text(double share) { return fmt::format("{:.0f} %", 100.0 * share); }

std::string bias_text(vec3 bias) {
  return fmt::format("{:+.1f} {:+.1f} {:+.1f} %", 100.0f * bias.x, 100.0f * bias.y, 100.0f * bias.z);
}

std::string name_of(const MaterialGap& m) { return m.name.empty() ? kBackground : one_line(m.name); }

std::string largest_text(const MaterialGap& m, const ViewGap& gap) {
  if (gap.match) return "";
  return m.largest ? fmt::format("{} {}", gap_cause_info(*m.largest).title, percent_text(m.largest_share))
                   : "the noise";
}

std::string summary_of(const ViewGap& gap) {
  return fmt::format("FLIP {:.4f} (the truth's noise: {:.4f}); relative L2 {:.4f}; colour {}", gap.difference.flip,
                     gap.flip_noise, gap.numbers.relative_l2, bias_text(gap.numbers.bias));
}

/// How another program's picture was laid over the truth, and what nobody can know of it.
std::string match_text(const GapMatch& m) {
  std::string text = m.shift == ivec2(0) ? "laid over the truth as it is"
                                         : fmt::format("moved by {}, {} pixels", -m.shift.x, -m.shift.y);
  text += m.is_display ? fmt::format(
                             ", the truth shown with an exposure of {:+.2f} EV; numbers are of what is shown. Not "
                             "known: its tone curve (--tonemap is taken for it)",
                             std::log2(m.exposure))
                       : fmt::format(", multiplied by {:.4g}. Not known:", m.exposure);
  return text + (m.is_display ? ", the light it was made under, and why it differs"
                              : " the light it was made under, and why it differs");
}

std::string suspect_text(const GapSuspect& s) {
  return fmt::format("{}; that would explain {} of the error of {}", s.what, percent_text(s.explained), s.of);
}

Json vec_json(vec3 v) { return Json::array({v.x, v.y, v.z}); }

Json numbers_json(const GapNumbers& n) {
  return {{"pixels", n.pixels}, {"flip", n.flip}, {"relative_l2", n.relative_l2}, {"bias", vec_json(n.bias)}};
}

Json view_json(const ViewGap& gap, const std::optional<float>& max_flip) {
  Json json = Json::object();
  for (const auto& [key, text] : {std::pair{"variant", &gap.label.variant},
                                  {"animation", &gap.label.animation},
                                  {"view", &gap.label.view},
                                  {"camera", &gap.label.camera}}) {
    if (!text->empty()) json[key] = *text;
  }
  json.update({{"width", gap.difference.size.x}, {"height", gap.difference.size.y}});
  json.update(numbers_json(gap.numbers));
  json["flip_noise"] = gap.flip_noise;
  json["exposure"] = *gap.develop.exposure;
  if (gap.match) {
    json["match"] = {{"shift", {gap.match->shift.x, gap.match->shift.y}},
                     {"exposure", gap.match->exposure},
                     {"values", gap.match->is_display ? "display" : "linear"}};
  }
  Json causes = Json::array(), materials = Json::array(), suspects = Json::array();
  for (const CauseGap& c : gap.causes) {
    causes.push_back({{"cause", gap_cause_info(c.cause).name},
                      {"share", c.share},
                      {"flip_without", c.flip_without},
                      {"bias", vec_json(c.bias)}});
  }
  for (const MaterialGap& m : gap.materials) {
    Json one = {{"material", m.name.empty() ? Json(nullptr) : Json(m.name)}};
    one.update(numbers_json(m.numbers));
    one["largest_cause"] = m.largest ? Json(gap_cause_info(*m.largest).name) : Json(nullptr);
    if (m.largest) one["largest_share"] = m.largest_share;
    materials.push_back(std::move(one));
  }
  for (const GapSuspect& s : gap.suspects) {
    suspects.push_back({{"suspect", s.name}, {"what", s.what}, {"explained", s.explained}, {"of", s.of}});
  }
  json.update({{"causes", causes}, {"materials", materials}, {"suspects", suspects}});
  if (max_flip) json["beyond"] = gap.difference.flip > static_cast<double>(*max_flip);
  return json;
}

/// What an approximation adds: red where the frame is too bright by it, blue where too dark; full at the luminance of
/// the truth, or at middle grey where it is darker.
DisplayImage signed_map(const CauseGap& cause, const ViewGap& gap) {
  constexpr vec3 kBright(250, 120, 60), kDark(60, 130, 250);
  const float grey = 0.18f / *gap.develop.exposure;
  DisplayImage map{cause.error.width, cause.error.height, {}};
  map.rgba.reserve(cause.error.pixels.size() / 3 * 4);
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      const float full = std::max(luminance(gap.truth.beauty.rgb(x, y)), grey);
      const float t = std::clamp(luminance(cause.error.rgb(x, y)) / full, -1.0f, 1.0f);
      const vec3 color = std::sqrt(std::abs(t)) * (t > 0.0f ? kBright : kDark);
      for (int c = 0; c < 3; ++c) map.rgba.push_back(static_cast<std::uint8_t>(std::lround(color[c])));
      map.rgba.push_back(255);
    }
  }
  return map;
}

std::string row(const std::vector<std::string>& cells, const char* tag = "td") {
  std::string html = "<tr>";
  for (const std::string& cell : cells) html += fmt::format("<{0}>{1}</{0}>", tag, escaped(cell));
  return html + "</tr>\n";
}

std::string causes_html(const ViewGap& gap) {
  if (gap.match) return fmt::format("<p>The picture was {}.</p>\n", escaped(match_text(*gap.match)));
  if (gap.causes.empty()) return "<p>The frame differs from the truth by no more than the truth's own noise.</p>\n";
  std::string html = "<h3>Why</h3>\n<div class=\"wide\"><table>\n" +
                     row({"", "share of the squared error", "FLIP without it", "colour", "drawn", "exact"}, "th");
  for (const CauseGap& c : gap.causes) {
    const GapCauseInfo& info = gap_cause_info(c.cause);
    html += row({std::string(info.title), percent_text(c.share), fmt::format("{:.4f}", c.flip_without),
                 bias_text(c.bias), std::string(info.drawn), std::string(info.exact)});
  }
  html +=
      "</table></div>\n<p>Shares add up to 100 %. One below 0 hides what another does: the frame would be worse "
      "without "
      "it.</p>\n<details><summary>Where: red is too bright by it, blue too dark</summary><div class=\"maps\">\n";
  for (const CauseGap& c : gap.causes) {
    const std::string title(gap_cause_info(c.cause).title);
    html += fmt::format("<figure>{}<figcaption>{}, {}</figcaption></figure>\n",
                        image_element(signed_map(c, gap), "where: " + title), escaped(title), percent_text(c.share));
  }
  return html + "</div></details>\n";
}

std::string materials_html(const ViewGap& gap) {
  std::string html = "<h3>Materials</h3>\n<div class=\"wide\"><table>\n" +
                     row({"", "pixels", "FLIP", "relative L2", "colour", gap.match ? "" : "mostly"}, "th");
  for (const MaterialGap& m : gap.materials) {
    html += row({name_of(m), std::to_string(m.numbers.pixels), fmt::format("{:.4f}", m.numbers.flip),
                 fmt::format("{:.4f}", m.numbers.relative_l2), bias_text(m.numbers.bias), largest_text(m, gap)});
  }
  return html + "</table></div>\n";
}

constexpr const char* kStyle = R"css(<style>
table { border-collapse: collapse; }
th, td { text-align: left; padding: .15em .9em .15em 0; vertical-align: top; }
.wide { overflow-x: auto; }
.maps { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(15em, 100%), 1fr)); gap: .5em; }
.suspect { border-left: .3em solid #d0202f; padding-left: .6em; font-weight: bold; }
</style>
)css";

}  // namespace

std::string title_of(const ViewGap& gap) {
  std::string text;
  for (const std::string* part : {&gap.label.variant, &gap.label.animation, &gap.label.view}) {
    if (!part->empty()) text += (text.empty() ? "" : " ") + *part;
  }
  if (!gap.label.camera.empty()) text += (text.empty() ? "camera " : " camera ") + gap.label.camera;
  return text.empty() ? "the view" : text;
}

std::string gap_text(const ViewGap& gap) {
  std::string text = fmt::format("{}: {}\n", one_line(title_of(gap)), summary_of(gap));
  for (const GapSuspect& s : gap.suspects) text += "  ! " + suspect_text(s) + "\n";
  if (gap.match) text += fmt::format("  {}\n", match_text(*gap.match));
  if (gap.causes.empty() && !gap.match) return text + "  no difference beyond the noise\n";
  if (!gap.causes.empty()) text += fmt::format("  {:<40} {:>7} {:>13}  {}\n", "why", "share", "FLIP without", "colour");
  for (const CauseGap& c : gap.causes) {
    text += fmt::format("  {:<40} {:>7} {:>13.4f}  {}\n", gap_cause_info(c.cause).title, percent_text(c.share),
                        c.flip_without, bias_text(c.bias));
  }
  text += fmt::format("  {:<28} {:>8} {:>7} {:>7}  {:<22} {}\n", "material", "pixels", "FLIP", "L2", "colour",
                      gap.match ? "" : "mostly");
  for (std::size_t i = 0; i < std::min(gap.materials.size(), kMaterialsShown); ++i) {
    const MaterialGap& m = gap.materials[i];
    text += fmt::format("  {:<28} {:>8} {:>7.4f} {:>7.4f}  {:<22} {}\n", name_of(m), m.numbers.pixels, m.numbers.flip,
                        m.numbers.relative_l2, bias_text(m.numbers.bias), largest_text(m, gap));
  }
  if (gap.materials.size() > kMaterialsShown) {
    text += fmt::format("  and {} more materials\n", gap.materials.size() - kMaterialsShown);
  }
  return text;
}

std::string gap_json(const std::string& scene, const GapSettings& settings, const std::vector<ViewGap>& gaps,
                     const std::optional<float>& max_flip) {
  Json views = Json::array();
  for (const ViewGap& gap : gaps) views.push_back(view_json(gap, max_flip));
  return json_text({{"scene", scene}, {"samples", settings.samples}, {"frames", settings.frames}, {"views", views}});
}

std::string gap_section(const ViewGap& gap, const std::optional<float>& max_flip) {
  const bool is_beyond = max_flip && gap.difference.flip > static_cast<double>(*max_flip);
  std::string html = fmt::format("<section{}><h2>{}</h2>\n<p>{}</p>\n", is_beyond ? " class=\"beyond\"" : "",
                                 escaped(title_of(gap)), escaped(summary_of(gap)));
  html += pair_pictures(gap.difference, "path traced", gap.match ? "the other program's" : "real time");
  for (const GapSuspect& s : gap.suspects) {
    html += fmt::format("<p class=\"suspect\">{}</p>\n", escaped(suspect_text(s)));
  }
  return html + causes_html(gap) + materials_html(gap) + "</section>\n";
}

std::string gap_page(const std::string& scene, const std::string& against, const GapSettings& settings,
                     const std::vector<std::string>& sections) {
  std::string body = kStyle;
  body += against.empty() ? fmt::format(
                                "<p>Path traced with {} samples per pixel, and one frame in real time. Causes are "
                                "told by the mean of {} frames and by what the path tracer finds without each "
                                "of them.</p>\n",
                                settings.samples, settings.frames)
                          : fmt::format("<p>Path traced with {} samples per pixel, and {}.</p>\n", settings.samples,
                                        escaped(against));
  for (const std::string& section : sections) body += section;
  const std::string what = against.empty() ? "the real-time frame of " + scene : against;
  return pair_page("Gap of " + scene, "How far " + what + " is from the truth", body);
}

}  // namespace candela::cli
