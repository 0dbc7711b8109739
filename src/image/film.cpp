#include "image/film.h"

#include <array>
#include <utility>

#include "base/error.h"

namespace candela {

namespace {

constexpr std::array<std::pair<Layer, std::string_view>, 5> kLayerNames{{{Layer::albedo, "albedo"},
                                                                         {Layer::normal, "normal"},
                                                                         {Layer::depth, "depth"},
                                                                         {Layer::position, "position"},
                                                                         {Layer::object_id, "id"}}};

}  // namespace

std::string_view layer_name(Layer layer) {
  for (const auto& [value, name] : kLayerNames)
    if (value == layer) return name;
  return {};
}

Layer parse_layer(std::string_view name) {
  std::string known;
  for (const auto& [value, text] : kLayerNames) {
    if (text == name) return value;
    known += known.empty() ? "" : ", ";
    known += text;
  }
  throw Error("unknown layer \"" + std::string(name) + "\" (known: " + known + ")");
}

float alpha_before(vec3 through) {
  const vec3 kept = 1.0f - through;
  // As luminance(), but exact where the three are equal: 1 is opaque, and nothing at all is 0.
  return glm::clamp(kept.y + 0.2126f * (kept.x - kept.y) + 0.0722f * (kept.z - kept.y), 0.0f, 1.0f);
}

void set_through(Image through, Film& film) {
  film.through = std::move(through);
  for (std::size_t i = 0; i < film.through.pixels.size(); i += 4) {
    const float* t = film.through.pixels.data() + i;
    film.beauty.pixels[i + 3] = alpha_before({t[0], t[1], t[2]});
  }
}

void accumulate(const Film& film, float share, Film& sum) {
  const auto add_scaled = [](const Image& from, float scale, Image& to) {
    if (to.pixels.empty()) to = Image(from.width, from.height, from.channels);
    for (std::size_t i = 0; i < from.pixels.size(); ++i) to.pixels[i] += scale * from.pixels[i];
  };
  const auto add = [&](const Image& from, Image& to) { add_scaled(from, share, to); };
  if (film.features) {
    if (!sum.features) sum.features.emplace();
    add(film.features->albedo, sum.features->albedo);
    add(film.features->normal, sum.features->normal);
    add(film.features->seen, sum.features->seen);
    add_scaled(film.features->albedo_variance, share * share, sum.features->albedo_variance);
    add_scaled(film.features->normal_variance, share * share, sum.features->normal_variance);
    add_scaled(film.features->variance, share * share, sum.features->variance);
  }
  if (sum.beauty.pixels.empty()) {
    sum.beauty = Image(film.width(), film.height(), film.beauty.channels);
    for (const auto& [layer, image] : film.layers) {
      const bool has_mean = layer == Layer::albedo || layer == Layer::normal;
      sum.layers[layer] = has_mean ? Image(image.width, image.height, image.channels) : image;
    }
    sum.through = Image(film.through.width, film.through.height, film.through.channels);
    sum.metadata = film.metadata;
  }
  add(film.beauty, sum.beauty);
  add(film.through, sum.through);
  for (const Layer layer : {Layer::albedo, Layer::normal}) {
    const auto found = film.layers.find(layer);
    if (found != film.layers.end()) add(found->second, sum.layers.at(layer));
  }
}

std::uint64_t film_bytes_per_pixel(const std::set<Layer>& layers, bool has_features) {
  std::uint64_t floats = has_features ? 4 + 14 : 4;  // of the picture
  for (const Layer layer : layers) floats += layer == Layer::depth || layer == Layer::object_id ? 1 : 3;
  return floats * sizeof(float);
}

}  // namespace candela
