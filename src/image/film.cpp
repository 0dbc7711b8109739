#include "image/film.h"

#include <algorithm>
#include <utility>

#include "base/error.h"
#include "base/named_row.h"

namespace candela {

Layer parse_layer(std::string_view name) {
  if (name == "node") return Layer::object_id;
  if (name == "ray-depth") return Layer::distance;  // what "depth" was until 0.2
  return row_named(kLayers, name, "unknown layer").layer;
}

bool has_centre_layer(const std::set<Layer>& layers) {
  return std::any_of(layers.begin(), layers.end(), [](Layer layer) { return !layer_info(layer).has_mean; });
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

namespace {

void add_mattes(const Film& film, float share, Film& sum) {
  for (const auto& [kind, mattes] : film.mattes) {
    MatteSums sums(mattes.width, mattes.height);
    Mattes& before = sum.mattes[kind];
    if (!before.ranks.empty()) sums.add(before, 1.0f);
    sums.add(mattes, share);
    before = sums.mattes([](std::size_t) { return 1.0f; });
    before.names = mattes.names;
  }
}

}  // namespace

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
    for (std::size_t i = 3; i < film.features->seen.pixels.size(); i += 4) {
      // Its variance, of which the share is squared.
      sum.features->seen.pixels[i] += (share * share - share) * film.features->seen.pixels[i];
    }
    add_scaled(film.features->albedo_variance, share * share, sum.features->albedo_variance);
    add_scaled(film.features->normal_variance, share * share, sum.features->normal_variance);
    add_scaled(film.features->variance, share * share, sum.features->variance);
    add_scaled(film.features->through_variance, share * share, sum.features->through_variance);
  }
  if (sum.beauty.pixels.empty()) {
    sum.beauty = Image(film.width(), film.height(), film.beauty.channels);
    for (const auto& [layer, image] : film.layers) {
      sum.layers[layer] = layer_info(layer).has_mean ? Image(image.width, image.height, image.channels) : image;
    }
    sum.through = Image(film.through.width, film.through.height, film.through.channels);
    sum.metadata = film.metadata;
    sum.masks = film.masks;
    sum.surfaces = film.surfaces;
  }
  add_mattes(film, share, sum);
  add(film.beauty, sum.beauty);
  add(film.through, sum.through);
  for (const auto& [layer, image] : film.layers) {
    if (layer_info(layer).has_mean) add(image, sum.layers.at(layer));
  }
}

std::size_t count_mean_layers(const std::set<Layer>& layers) {
  return static_cast<std::size_t>(
      std::count_if(layers.begin(), layers.end(), [](Layer layer) { return layer_info(layer).has_mean; }));
}

std::uint64_t film_bytes_per_pixel(const std::set<Layer>& layers, bool has_features) {
  std::uint64_t floats = has_features ? 4 + 18 : 4;  // of the picture
  for (const Layer layer : layers) floats += static_cast<std::uint64_t>(layer_channels(layer));
  return floats * sizeof(float);
}

}  // namespace candela
