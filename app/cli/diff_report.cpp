#include "cli/diff_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "cli/json_text.h"
#include "cli/values.h"

namespace candela::cli {

using Json = nlohmann::ordered_json;

std::string Compared::title() const {
  std::string text = name;
  for (const std::string* part : {&label.variant, &label.animation, &label.view}) {
    if (!part->empty()) text += " " + *part;
  }
  if (!label.camera.empty()) text += " camera " + label.camera;
  return text;
}

std::string absence_text(const Compared& c) {
  if (!c.fault.empty()) return c.fault;
  return c.has_first ? "only in the first" : "only in the second";
}

namespace {

std::string layer_text(const LayerDifference& layer, double pixels) {
  std::string text =
      layer.changed == 0
          ? "the same"
          : fmt::format("{:.3g} % of the pixels changed, by {:.3g} in the mean of all and {:.3g} at most",
                        100.0 * static_cast<double>(layer.changed) / pixels, layer.mean, layer.max);
  if (layer.broken > 0) text += fmt::format("; not finite in {}", counted(layer.broken, "pixel"));
  return text;
}

Json difference_json(const Compared& c, const std::optional<float>& max_flip) {
  Json json = {{"name", c.name}};
  if (!c.label.view.empty()) json["view"] = c.label.view;
  if (!c.label.camera.empty()) json["camera"] = c.label.camera;
  json.update({{"in_first", c.has_first}, {"in_second", c.has_second}});
  if (!c.fault.empty()) json["error"] = c.fault;
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

}  // namespace

std::string difference_text(const Compared& c) { return one_line(c.title()) + ": " + finding_text(c); }

std::string finding_text(const Compared& c) {
  if (!c.difference) return one_line(absence_text(c)) + "\n";
  const PictureDifference& d = *c.difference;
  const double pixels = static_cast<double>(d.size.x) * static_cast<double>(d.size.y);
  std::string text = fmt::format("FLIP {:.4f} in the mean, {:.4f} at most; {}\n", d.flip, d.flip_max,
                                 layer_text(d.layers.front(), pixels));
  for (std::size_t i = 1; i < d.layers.size(); ++i) {
    text += fmt::format("  {}: {}\n", one_line(d.layers[i].layer), layer_text(d.layers[i], pixels));
  }
  for (const std::string& layer : d.unmatched) text += fmt::format("  {}: in one alone\n", one_line(layer));
  return text;
}

std::string report_json(const std::vector<Compared>& all, const std::optional<float>& max_flip) {
  Json pairs = Json::array();
  for (const Compared& c : all) pairs.push_back(difference_json(c, max_flip));
  return json_text({{"pairs", pairs}});
}

}  // namespace candela::cli
