#include "path/accumulator.h"

#include <algorithm>
#include <cmath>

namespace candela::path {

Accumulator::Accumulator(const Settings& settings) : width_(settings.width), height_(settings.height) {
  const std::size_t n = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  pixels_.resize(n);
  if (settings.layers.contains(Layer::albedo)) albedo_.resize(n, vec3(0.0f));
  if (settings.layers.contains(Layer::normal)) normal_.resize(n, vec3(0.0f));
}

std::uint64_t Accumulator::bytes_per_pixel(const Settings& settings) {
  return sizeof(Pixel) + sizeof(vec3) * (settings.layers.count(Layer::albedo) + settings.layers.count(Layer::normal));
}

bool Accumulator::add(int x, int y, const PathSample& sample) {
  if (!is_finite(sample.radiance)) return false;
  const std::size_t i = index(x, y);
  Pixel& p = pixels_[i];
  p.r += static_cast<double>(sample.radiance.x);
  p.g += static_cast<double>(sample.radiance.y);
  p.b += static_cast<double>(sample.radiance.z);
  const auto l = static_cast<double>(luminance(sample.radiance));
  p.luminance2 += l * l;
  p.alpha += sample.alpha;
  ++p.count;
  if (!albedo_.empty()) albedo_[i] += sample.albedo;
  if (!normal_.empty()) normal_[i] += sample.normal;
  return true;
}

float Accumulator::relative_error(int x, int y, float reference) const {
  const Pixel& p = pixel(x, y);
  if (p.count < 2) return kInfinity;
  const double n = p.count;
  const double mean = (0.2126 * p.r + 0.7152 * p.g + 0.0722 * p.b) / n;
  const double variance = std::max(p.luminance2 / n - mean * mean, 0.0) / (n - 1.0);
  const double scale = std::max(mean, 0.05 * static_cast<double>(reference));
  return scale > 0.0 ? static_cast<float>(std::sqrt(variance) / scale) : 0.0f;
}

float Accumulator::mean_luminance() const {
  double sum = 0.0;
  for (const Pixel& p : pixels_) {
    if (p.count > 0) sum += (0.2126 * p.r + 0.7152 * p.g + 0.0722 * p.b) / p.count;
  }
  return static_cast<float>(sum / static_cast<double>(pixels_.size()));
}

void Accumulator::resolve(Film& film) const {
  film.beauty = Image(width_, height_, 4);
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    const Pixel& p = pixels_[i];
    if (p.count == 0) continue;
    const double scale = 1.0 / p.count;
    float* out = film.beauty.pixels.data() + 4 * i;
    out[0] = static_cast<float>(p.r * scale);
    out[1] = static_cast<float>(p.g * scale);
    out[2] = static_cast<float>(p.b * scale);
    out[3] = static_cast<float>(static_cast<double>(p.alpha) * scale);
  }
  const auto resolve_layer = [&](Layer layer, const std::vector<vec3>& sums, bool unit) {
    if (sums.empty()) return;
    Image image(width_, height_, 3);
    for (std::size_t i = 0; i < sums.size(); ++i) {
      vec3 v = sums[i] / static_cast<float>(std::max(pixels_[i].count, 1U));
      const float length = glm::length(v);
      if (unit && length > 0.0f) v /= length;
      image.pixels[3 * i] = v.x;
      image.pixels[3 * i + 1] = v.y;
      image.pixels[3 * i + 2] = v.z;
    }
    film.layers[layer] = std::move(image);
  };
  resolve_layer(Layer::albedo, albedo_, false);
  resolve_layer(Layer::normal, normal_, true);
}

}  // namespace candela::path
