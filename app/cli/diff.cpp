#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/file.h"
#include "candela/difference.h"
#include "cli/html.h"
#include "cli/inputs.h"
#include "cli/interrupt.h"
#include "cli/json_text.h"
#include "cli/option.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/values.h"
#include "cli/verbs.h"
#include "figures/markup.h"

namespace candela::cli {

namespace {

namespace fs = std::filesystem;
using figures::escaped;
using Json = nlohmann::ordered_json;

struct DiffOptions {
  std::string first, second;
  std::string output;
  DifferenceSettings settings;
  std::optional<float> max_flip;
  bool json = false;
  bool quiet = false;
};

/// A pair of pictures and what came of it; no difference where one of them is absent.
struct Compared {
  std::string name;
  bool has_first = true, has_second = true;
  std::optional<PictureDifference> difference;

  bool is_beyond(const std::optional<float>& max_flip) const {
    return max_flip && (!difference || difference->flip > static_cast<double>(*max_flip));
  }
};

std::string absent_text(const Compared& c) { return c.has_first ? "only in the first" : "only in the second"; }

std::string layer_text(const LayerDifference& layer, double pixels) {
  std::string text =
      layer.changed == 0
          ? "the same"
          : fmt::format("{:.3g} % of the pixels changed, by {:.3g} in the mean of all and {:.3g} at most",
                        100.0 * static_cast<double>(layer.changed) / pixels, layer.mean, layer.max);
  if (layer.broken > 0) text += fmt::format("; not finite in {} pixels", layer.broken);
  return text;
}

std::string difference_text(const Compared& c) {
  if (!c.difference) return fmt::format("{}: {}\n", one_line(c.name), absent_text(c));
  const PictureDifference& d = *c.difference;
  const double pixels = static_cast<double>(d.size.x) * static_cast<double>(d.size.y);
  std::string text = fmt::format("{}: FLIP {:.4f} in the mean, {:.4f} at most; {}\n", one_line(c.name), d.flip,
                                 d.flip_max, layer_text(d.layers.front(), pixels));
  for (std::size_t i = 1; i < d.layers.size(); ++i) {
    text += fmt::format("  {}: {}\n", one_line(d.layers[i].layer), layer_text(d.layers[i], pixels));
  }
  for (const std::string& layer : d.unmatched) text += fmt::format("  {}: in one alone\n", one_line(layer));
  return text;
}

Json difference_json(const Compared& c, const std::optional<float>& max_flip) {
  Json json = {{"name", c.name}, {"in_first", c.has_first}, {"in_second", c.has_second}};
  if (c.difference) {
    const PictureDifference& d = *c.difference;
    Json layers = Json::array();
    for (const LayerDifference& layer : d.layers) {
      layers.push_back({{"layer", layer.layer.empty() ? Json(nullptr) : Json(layer.layer)},
                        {"mean", layer.mean},
                        {"max", layer.max},
                        {"changed_pixels", layer.changed},
                        {"not_finite_pixels", layer.broken}});
    }
    json.update({{"width", d.size.x},
                 {"height", d.size.y},
                 {"values", d.is_display ? "display" : "linear"},
                 {"flip", d.flip},
                 {"flip_max", d.flip_max},
                 {"layers", layers},
                 {"layers_in_one_alone", d.unmatched}});
  }
  if (max_flip) json["beyond"] = c.is_beyond(max_flip);
  return json;
}

/// How bad: a picture that is missing is worse than any that is there.
double badness(const Compared& c) { return c.difference ? c.difference->flip : 2.0; }

/// First, second and error beside each other, the worst pair at the top.
std::string page_html(std::vector<Compared> all, const DiffOptions& o) {
  std::stable_sort(all.begin(), all.end(),
                   [](const Compared& a, const Compared& b) { return badness(a) > badness(b); });
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Difference</title>\n<style>\n"
      "body {{ font: 15px/1.5 system-ui, sans-serif; margin: 1em; }}\nimg {{ width: 100%; }}\n"
      ".row {{ display: grid; grid-template-columns: repeat(auto-fit, minmax(15em, 1fr)); gap: 0.5em; }}\n"
      "figure {{ margin: 0; }}\n.beyond h2 {{ color: #b00020; }}\n"
      "</style></head><body>\n<h1>{} and {}</h1>\n",
      escaped(o.first), escaped(o.second));
  for (const Compared& c : all) {
    html += fmt::format("<section{}><h2>{}</h2>\n<pre>{}</pre>\n", c.is_beyond(o.max_flip) ? " class=\"beyond\"" : "",
                        escaped(c.name), escaped(difference_text(c)));
    if (c.difference) {
      const auto figure = [](const DisplayImage& image, const char* what) {
        return fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", image_element(image, what), what);
      };
      html += "<div class=\"row\">" + figure(c.difference->first, "first") + figure(c.difference->second, "second") +
              figure(error_map(c.difference->error), "error (FLIP: black 0, pale yellow 1)") + "</div>";
    }
    html += "</section>\n";
  }
  return html + "</body></html>\n";
}

std::vector<PicturePair> pairs_of(const DiffOptions& o) {
  std::error_code ignored;
  const bool is_folder = fs::is_directory(o.first, ignored);
  if (is_folder != fs::is_directory(o.second, ignored)) {
    throw Error(is_folder ? "is no folder, but the first is" : "is a folder, but the first is none", o.second);
  }
  if (is_folder) return picture_pairs(o.first, o.second);
  return {{o.second, o.first, o.second}};
}

/// Refuses what cannot be written, and what would overwrite a picture that is read.
void check_output(const DiffOptions& o) {
  if (o.output.empty()) return;
  const bool is_map = has_extension(o.output, ".png");
  if (!is_map && !has_extension(o.output, ".html")) {
    throw UsageError("--output: a map is a .png, a page an .html: " + o.output);
  }
  Inputs inputs;
  for (const std::string& name : {o.first, o.second}) {
    std::error_code ignored;
    if (!fs::is_directory(name, ignored)) {
      inputs.add(parse_image_name(name).path, "a picture to compare");
    } else if (is_map) {
      throw Error("a pair of pictures has a map; folders have a page, an .html", o.output);
    } else {
      inputs.add_folder(name, "a folder to compare");
    }
  }
  inputs.refuse(o.output);
  check_writable(o.output);
}

void write_output(const DiffOptions& o, const std::vector<Compared>& all) {
  const FolderFor folder(o.output);
  if (has_extension(o.output, ".html")) return write_file(o.output, page_html(all, o));
  write_png(o.output, error_map(all.front().difference->error));
}

void require_small(const DiffOptions& o, const std::vector<Compared>& all) {
  std::size_t beyond = 0;
  const Compared* worst = nullptr;
  for (const Compared& c : all) {
    if (!c.is_beyond(o.max_flip)) continue;
    ++beyond;
    if (worst == nullptr || badness(c) > badness(*worst)) worst = &c;
  }
  if (worst == nullptr) return;
  std::string what = absent_text(*worst);
  if (worst->difference) what = fmt::format("FLIP {:.4f} is above {} (--max-flip)", badness(*worst), *o.max_flip);
  throw Error(what + (beyond > 1 ? fmt::format(", and {} more", beyond - 1) : ""), worst->name);
}

std::string report_json(const std::vector<Compared>& all, const std::optional<float>& max_flip) {
  Json pairs = Json::array();
  for (const Compared& c : all) pairs.push_back(difference_json(c, max_flip));
  return json_text({{"pairs", pairs}});
}

Compared compare(const PicturePair& pair, const DiffOptions& o) {
  Compared compared{pair.name, !pair.first.empty(), !pair.second.empty(), std::nullopt};
  if (!compared.has_first || !compared.has_second) return compared;
  compared.difference =
      compare_pictures(parse_image_name(pair.first.string()), parse_image_name(pair.second.string()), o.settings);
  if (o.output.empty()) {  // many pictures need not be kept
    compared.difference->error = {};
    compared.difference->first = compared.difference->second = {};
  }
  return compared;
}

void run_diff(const DiffOptions& o) {
  check_output(o);
  const std::vector<PicturePair> pairs = pairs_of(o);
  std::vector<Compared> all;
  all.reserve(pairs.size());
  ProgressLine progress(o.quiet);
  const Interrupt interrupt;
  for (const PicturePair& pair : pairs) {
    if (Interrupt::requested()) throw Interrupted(fmt::format("{} of {} pairs are compared", all.size(), pairs.size()));
    progress.phase(fmt::format("{} of {}: {}", all.size() + 1, pairs.size(), pair.name));
    all.push_back(compare(pair, o));
    progress.clear();  // both may be the same terminal
    if (!o.json) print(difference_text(all.back()));
  }
  if (o.json) print(report_json(all, o.max_flip));
  if (!o.output.empty()) write_output(o, all);
  require_small(o, all);
}

}  // namespace

Verb add_diff(Command& command) {
  const auto options = std::make_shared<DiffOptions>();
  DiffOptions& o = *options;
  command
      .text("FIRST", o.first, "The reference: a picture (.png .jpg .webp .avif .hdr .exr, FILE.exr:LAYER) or a folder")
      .required();
  command.text("SECOND", o.second, "What is judged; of two folders, the pictures of equal names").required();
  command.text("-o,--output", o.output, "Also write the error of each pixel as a .png, or a page of all pairs as .html")
      .type("FILE");
  add_value(command, "--max-flip", "X", o.max_flip, number_within(0.0f, 1.0f),
            "Exit code 1 where the mean FLIP is above that, or one folder lacks a picture of the other");
  add_value(command, "--tolerance", "X", o.settings.tolerance, number_within(0.0f, kInfinity),
            "A pixel has changed where a channel differs by more: of 0 to 1 in a display picture, else linear [0]");
  add_value(command, "--exposure", "auto|EV|f/N,1/T,ISO", o.settings.exposure, parse_exposure,
            "How .hdr and .exr are seen [auto: metered from FIRST, for both]");
  add_value(command, "--tonemap", "CURVE", o.settings.tone_curve, parse_tone_curve, "Likewise [pbr-neutral]");
  command.flag("--json", o.json, "For a machine: one JSON object");
  command.flag("-q,--quiet", o.quiet, "No progress on standard error");
  command.footer(
      "Examples:\n  candela diff before.png after.png\n  candela diff golden/ out/ --max-flip 0.01 -o page.html\n"
      "  candela diff truth.exr:albedo frame.exr:albedo -o error.png\n\n"
      "FLIP is how different two pictures look when one flips between them, 0 to 1 (Andersson et al. 2020).");
  return [options] { run_diff(*options); };
}

}  // namespace candela::cli
