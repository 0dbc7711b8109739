#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <utility>

#include "base/error.h"
#include "candela/gap_parts.h"
#include "shade/color.glsl.h"

namespace candela {

namespace {

/// Below, relative to the light, it is right enough: prefiltered levels alone are off by as much, and what is small can
/// look like anything.
constexpr double kLeastError = 0.12;
/// Of the squared error, what an explanation has to account for.
constexpr double kLeastExplained = 0.65;

/// Means of blocks of `step` × `step` pixels.
Image coarse(const Image& image, int step) {
  Image result(image.width / step, image.height / step, 3);
  const float share = 1.0f / static_cast<float>(step * step);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      result.set_rgb(x / step, y / step, result.rgb(x / step, y / step) + share * image.rgb(x, y));
    }
  }
  return result;
}

/// Where one of the pixels has another kind, the block has.
std::vector<GapPixel> coarse(const std::vector<GapPixel>& pixels, const Image& image, int step) {
  const int width = image.width / step;
  std::vector<GapPixel> result(pixels.size() / static_cast<std::size_t>(step * step));
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const GapPixel& pixel = pixels[static_cast<std::size_t>(y * image.width + x)];
      GapPixel& block = result[static_cast<std::size_t>(y / step * width + x / step)];
      block.weight += pixel.weight;
      if (!pixel.is_plain()) block.kind = pixel.kind;
    }
  }
  return result;
}

/// The largest blocks that a picture of this size has: enough to tell a mistake, and as many times faster.
int step_of(const Image& image) {
  for (const int step : {4, 3, 2}) {
    if (image.width % step == 0 && image.height % step == 0) return step;
  }
  return 1;
}

/// Σ weight · |a − b|² over the pixels whose causes are told apart.
double squared_distance(const std::vector<GapPixel>& pixels, const Image& a, const Image& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (!pixels[i].is_plain()) continue;
    const vec3 d = pixel_of(a, i) - pixel_of(b, i);
    sum += pixels[i].weight * dot(d, d);
  }
  return sum;
}

double squared(const std::vector<GapPixel>& pixels, const Image& a) {
  return squared_distance(pixels, a, Image(a.width, a.height, a.channels));
}

// ----- factors

std::string factor_text(std::string_view what, double factor) {
  const double pi = static_cast<double>(kPi);
  const auto is_near = [&](double value) { return std::abs(factor / value - 1.0) < 0.04; };
  std::string text = fmt::format("{} is {:.3g} times what it should be", what, factor);
  if (is_near(pi)) text += ": as if a division by π were missing";
  if (is_near(1.0 / pi)) text += ": as if it were divided by π once too often";
  return text;
}

/// Part of what is drawn, and by what factor it is too bright.
struct Factor {
  std::string_view name, what;
  Image drawn;
  double value = 1.0;
};

/// Solves the normal equations of few unknowns; by elimination with pivots. Unknowns without a say are 0.
std::vector<double> solved(std::vector<std::vector<double>> a) {
  const std::size_t n = a.size();
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t r = k + 1; r < n; ++r) {
      if (std::abs(a[r][k]) > std::abs(a[pivot][k])) pivot = r;
    }
    std::swap(a[k], a[pivot]);
    if (!(std::abs(a[k][k]) > 1e-12)) {
      std::fill(a[k].begin(), a[k].end(), 0.0);
      a[k][k] = 1.0;
    }
    for (std::size_t r = 0; r < n; ++r) {
      if (r == k) continue;
      const double f = a[r][k] / a[k][k];
      for (std::size_t c = k; c <= n; ++c) a[r][c] -= f * a[k][c];
    }
  }
  std::vector<double> x(n);
  for (std::size_t k = 0; k < n; ++k) x[k] = a[k][n] / a[k][k];
  return x;
}

/// The error as a sum of parts of what is drawn: drawn = factor · right, so that the part's share of the error is 1 - 1
/// / factor. Returns what is explained of the squared error, and fills in the factors.
double fit_factors(const std::vector<GapPixel>& pixels, const Image& drawn, const Image& exact,
                   std::vector<Factor>& factors) {
  const std::size_t n = factors.size();
  std::vector<std::vector<double>> normal(n, std::vector<double>(n + 1, 0.0));
  double before = 0.0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (!pixels[i].is_plain()) continue;
    const vec3 error = pixel_of(drawn, i) - pixel_of(exact, i);
    before += pixels[i].weight * dot(error, error);
    for (std::size_t r = 0; r < n; ++r) {
      const vec3 part = pixel_of(factors[r].drawn, i);
      for (std::size_t c = 0; c < n; ++c) normal[r][c] += pixels[i].weight * dot(part, pixel_of(factors[c].drawn, i));
      normal[r][n] += pixels[i].weight * dot(part, error);
    }
  }
  const std::vector<double> shares = solved(normal);
  double after = 0.0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (!pixels[i].is_plain()) continue;
    vec3 error = pixel_of(drawn, i) - pixel_of(exact, i);
    for (std::size_t r = 0; r < n; ++r) error -= static_cast<float>(shares[r]) * pixel_of(factors[r].drawn, i);
    after += pixels[i].weight * dot(error, error);
  }
  for (std::size_t r = 0; r < n; ++r) {
    factors[r].value = std::abs(1.0 - shares[r]) > 1e-6 ? 1.0 / (1.0 - shares[r]) : 1.0;
  }
  return before > 0.0 ? 1.0 - after / before : 0.0;
}

/// A factor alone, where it is not near 1.
void suspect_factors(double explained, const std::vector<Factor>& factors, const std::string& of,
                     std::vector<GapSuspect>& suspects) {
  if (explained < kLeastExplained) return;
  for (const Factor& f : factors) {
    constexpr double kNearOne = 0.15;
    if (f.value > 0.0 && std::abs(std::log(f.value)) < kNearOne) continue;
    suspects.push_back({fmt::format("factor-{}", f.name), factor_text(f.what, f.value), of, explained});
  }
}

// ----- other scenes and environments

using Texel = std::array<float, 4>;
using TexelChange = Texel (*)(Texel texel);

float channel_at(const TextureImage& image, std::size_t i) {
  if (image.bits == 8) return static_cast<float>(image.pixels[i]) / 255.0f;
  std::uint16_t value = 0;
  std::memcpy(&value, image.pixels.data() + 2 * i, 2);
  return static_cast<float>(value) / 65535.0f;
}

void set_channel(TextureImage& image, std::size_t i, float value) {
  const float v = std::clamp(value, 0.0f, 1.0f);
  if (image.bits == 8) {
    image.pixels[i] = static_cast<std::uint8_t>(std::lround(v * 255.0f));
    return;
  }
  const auto wide = static_cast<std::uint16_t>(std::lround(v * 65535.0f));
  std::memcpy(image.pixels.data() + 2 * i, &wide, 2);
}

/// Textures of a slot with other texels, as their file has them; another slot that reads them stays as it is.
void change_texels(TextureSlot Material::*slot, TexelChange change, Scene& scene) {
  std::map<int, int> others;
  for (Material& material : scene.materials) {
    int& texture = (material.*slot).texture;
    if (texture < 0) continue;
    const auto [found, is_new] = others.emplace(texture, static_cast<int>(scene.textures.size()));
    if (is_new) {
      Texture other = scene.textures[static_cast<std::size_t>(texture)];
      TextureImage image = *scene.images[static_cast<std::size_t>(other.image)];
      const std::size_t count = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
      for (std::size_t i = 0; i < count; ++i) {
        Texel texel;
        for (std::size_t c = 0; c < 4; ++c) texel[c] = channel_at(image, 4 * i + c);
        texel = change(texel);
        for (std::size_t c = 0; c < 4; ++c) set_channel(image, 4 * i + c, texel[c]);
      }
      if (!scene.image_file_indices.empty()) scene.image_file_indices.push_back(-1);
      other.image = static_cast<int>(scene.images.size());
      other.file_index = -1;
      scene.images.push_back(std::make_shared<const TextureImage>(std::move(image)));
      scene.textures.push_back(std::move(other));
    }
    texture = found->second;
  }
}

void square_roughness(Scene& scene, Environment&) {
  for (Material& m : scene.materials) m.roughness *= m.roughness;
  change_texels(
      &Material::metallic_roughness_texture, [](Texel t) { return t[1] *= t[1], t; }, scene);
}

void root_roughness(Scene& scene, Environment&) {
  for (Material& m : scene.materials) m.roughness = std::sqrt(m.roughness);
  change_texels(
      &Material::metallic_roughness_texture, [](Texel t) { return t[1] = std::sqrt(t[1]), t; }, scene);
}

void swap_roughness(Scene& scene, Environment&) {
  for (Material& m : scene.materials) {
    if (m.metallic_roughness_texture) std::swap(m.metallic, m.roughness);
  }
  change_texels(
      &Material::metallic_roughness_texture, [](Texel t) { return std::swap(t[1], t[2]), t; }, scene);
}

void flip_green(Scene& scene, Environment&) {
  change_texels(
      &Material::normal_texture, [](Texel t) { return t[1] = 1.0f - t[1], t; }, scene);
}

void leave_encoded(Scene& scene, Environment&) {
  const auto encode = [](Texel t) {
    for (std::size_t c = 0; c < 3; ++c) t[c] = shade::srgb_encode_channel(t[c]);
    return t;
  };
  change_texels(&Material::base_color_texture, encode, scene);
}

void decode_twice(Scene& scene, Environment&) {
  const auto decode = [](Texel t) {
    for (std::size_t c = 0; c < 3; ++c) t[c] = shade::srgb_decode_channel(t[c]);
    return t;
  };
  change_texels(&Material::base_color_texture, decode, scene);
}

std::shared_ptr<const Image> mirrored_image(const std::shared_ptr<const Image>& image, bool is_upside_down) {
  if (image == nullptr) return nullptr;
  auto other = std::make_shared<Image>(image->width, image->height, image->channels);
  for (int y = 0; y < image->height; ++y) {
    for (int x = 0; x < image->width; ++x) {
      const auto from = is_upside_down ? image->at(x, image->height - 1 - y) : image->at(image->width - 1 - x, y);
      std::copy(from.begin(), from.end(), other->at(x, y).begin());
    }
  }
  return other;
}

/// Before its rotation: what is at (x, y, z) comes to (x, y, -z), or to (x, -y, z).
void mirror(Environment& environment, bool is_upside_down) {
  environment.map = mirrored_image(environment.map, is_upside_down);
  environment.backdrop = mirrored_image(environment.backdrop, is_upside_down);
  for (SunDisc& sun : environment.suns) (is_upside_down ? sun.direction.y : sun.direction.z) *= -1.0f;
}

void mirror_z(Scene&, Environment& e) { mirror(e, false); }
void mirror_x(Scene&, Environment& e) { mirror(e, false), e.rotation += kPi; }
void turn_over(Scene&, Environment& e) { mirror(e, true); }
template <int kQuarters>
void turn_by(Scene&, Environment& e) {
  e.rotation += kQuarters * 0.5f * kPi;
}

struct Mistake {
  std::string_view name, what;
  void (*make)(Scene& scene, Environment& environment);
  bool is_of_environment;
};
constexpr auto kMistakes = std::to_array<Mistake>({
    {"environment-mirrored", "the environment looks mirrored", mirror_z, true},
    {"environment-mirrored", "the environment looks mirrored", mirror_x, true},
    {"environment-upside-down", "the environment looks upside down", turn_over, true},
    {"environment-turned", "the environment looks turned by 90°, counter-clockwise from above", turn_by<1>, true},
    {"environment-turned", "the environment looks turned by 180°", turn_by<2>, true},
    {"environment-turned", "the environment looks turned by 90°, clockwise from above", turn_by<3>, true},
    {"roughness-squared", "roughness looks squared once too often", square_roughness, false},
    {"roughness-not-squared", "roughness looks as if it were not squared: α = roughness", root_roughness, false},
    {"roughness-swapped", "roughness and metallic look swapped", swap_roughness, false},
    {"normals-flipped", "the green channel of normal maps looks inverted", flip_green, false},
    {"color-not-decoded", "the base colour looks read as linear, which is sRGB", leave_encoded, false},
    {"color-decoded-twice", "the base colour looks decoded from sRGB twice", decode_twice, false},
});

/// Of the scene with the mistake; none where it changes nothing.
std::unique_ptr<const path::Tracer> tracer_of(const Mistake& mistake, const GapScene& of) {
  Environment environment = of.environment;
  if (mistake.is_of_environment) {
    Scene ignored;
    mistake.make(ignored, environment);
    return std::make_unique<const path::Tracer>(of.tracer, of.scene, path::FarLight(environment));
  }
  auto scene = std::make_shared<Scene>(*of.scene);
  mistake.make(*scene, environment);
  if (scene->materials == of.scene->materials) return nullptr;
  return std::make_unique<const path::Tracer>(std::move(scene), environment, of.shot.shading);
}

}  // namespace

namespace {

Image sum_of(const Image& a, const Image& b) {
  Image sum(a.width, a.height, 3);
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) sum.set_rgb(x, y, a.rgb(x, y) + (b.empty() ? vec3(0.0f) : b.rgb(x, y)));
  }
  return sum;
}

bool is_wrong(const std::vector<GapPixel>& pixels, const Image& drawn, const Image& exact) {
  return squared_distance(pixels, drawn, exact) > kLeastError * kLeastError * squared(pixels, exact);
}

/// By what factors the lobes of light from far away are too bright.
void suspect_lobes(const std::vector<GapPixel>& pixels, const Image& drawn, const Image& exact,
                   const raster::Settings& settings, const DrawFrames& draw, std::vector<GapSuspect>& suspects) {
  constexpr auto kLobes = std::to_array<std::pair<raster::Quantity, std::string_view>>(
      {{raster::Quantity::diffuse, "diffuse light from far away"},
       {raster::Quantity::specular, "light from far away that facets reflect"},
       {raster::Quantity::coat, "light from far away that coats reflect"},
       {raster::Quantity::sheen, "light from far away that sheen reflects"}});
  std::vector<Factor> factors;
  for (const auto& [quantity, what] : kLobes) {
    raster::Settings part = settings;
    part.quantity = quantity;
    Factor factor{raster::quantity_name(quantity), what, draw(part)};
    if (squared(pixels, factor.drawn) > 0.0) factors.push_back(std::move(factor));
  }
  suspect_factors(fit_factors(pixels, drawn, exact, factors), factors, "light from far away", suspects);
}

/// Whether the light that comes straight from all sources is that of another scene or environment.
void suspect_mistakes(const GapScene& of, const std::vector<GapPixel>& pixels, const Image& drawn, const Image& exact,
                      const Job& job, std::vector<GapSuspect>& suspects) {
  const int step = step_of(drawn);
  const Image drawn_blocks = coarse(drawn, step);
  const std::vector<GapPixel> blocks = coarse(pixels, drawn, step);
  const double error = squared_distance(blocks, drawn_blocks, coarse(exact, step));
  path::Settings few = traced_settings(of.shot);
  few.width = drawn_blocks.width, few.height = drawn_blocks.height;
  few.samples = 64;
  for (const Mistake& mistake : kMistakes) {
    if (job.is_stopped()) throw Interrupted("the comparison is not complete");
    if (mistake.is_of_environment && of.environment.map == nullptr && of.environment.suns.empty()) continue;
    const std::unique_ptr<const path::Tracer> tracer = tracer_of(mistake, of);
    if (tracer == nullptr) continue;
    const path::DirectLight other = path::trace_direct_light(*tracer, of.view, few, {.stop = job.stop});
    const Image light = sum_of(sum_of(other.far.unhindered, other.lamps.unhindered), other.areas.unhindered);
    const double explained = 1.0 - squared_distance(blocks, drawn_blocks, light) / error;
    if (explained < kLeastExplained) continue;
    suspects.push_back({std::string(mistake.name), std::string(mistake.what), "direct light", explained});
  }
}

}  // namespace

std::vector<GapSuspect> find_suspects(const GapScene& of, const std::vector<GapPixel>& pixels, const DrawnParts& drawn,
                                      const path::DirectLight& direct, const raster::Settings& settings,
                                      const DrawFrames& draw, const Job& job) {
  std::vector<GapSuspect> suspects;
  const Image exact_lamps = sum_of(direct.lamps.unhindered, direct.areas.unhindered);
  if (!drawn.unshadowed.empty() && is_wrong(pixels, drawn.unshadowed, exact_lamps)) {
    std::vector<Factor> factors = {{"lamps", "the light of lamps", drawn.unshadowed}};
    suspect_factors(fit_factors(pixels, drawn.unshadowed, exact_lamps, factors), factors, "lamps", suspects);
  }
  const Image& open = drawn.without_occlusion();
  if (is_wrong(pixels, open, direct.far.unhindered)) {
    suspect_lobes(pixels, open, direct.far.unhindered, settings, draw, suspects);
  }
  const Image all = sum_of(open, drawn.unshadowed), exact = sum_of(direct.far.unhindered, exact_lamps);
  if (is_wrong(pixels, all, exact)) suspect_mistakes(of, pixels, all, exact, job, suspects);

  std::stable_sort(suspects.begin(), suspects.end(),
                   [](const GapSuspect& a, const GapSuspect& b) { return a.explained > b.explained; });
  if (!suspects.empty()) {
    const double left = 2.0 * (1.0 - suspects.front().explained) + 0.02;
    std::erase_if(suspects, [&](const GapSuspect& s) { return 1.0 - s.explained > left; });
  }
  return suspects;
}

}  // namespace candela
