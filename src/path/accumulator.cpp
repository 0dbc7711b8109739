#include "path/accumulator.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"

namespace candela::path {

namespace {

/// Sobol' points do better than independent samples, by how much the difference of two halves says; of one pixel it
/// says little, of the pixels around it enough.
void scale_variance(const Image& halves, Image& variance) {
  constexpr int kRadius = 3;
  const Image before = variance;
  parallel_for(0, static_cast<std::size_t>(variance.height), 4, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < variance.width; ++x) {
        double found = 0.0, told = 0.0;
        for (int j = std::max(y - kRadius, 0); j <= std::min(y + kRadius, variance.height - 1); ++j) {
          for (int i = std::max(x - kRadius, 0); i <= std::min(x + kRadius, variance.width - 1); ++i) {
            if (halves.at(i, j)[0] <= 0.0f) continue;
            const vec3 v = before.rgb(i, j);
            found += static_cast<double>(halves.at(i, j)[0]);
            told += static_cast<double>(v.x + v.y + v.z);
          }
        }
        if (told > 0.0) variance.set_rgb(x, y, before.rgb(x, y) * static_cast<float>(std::min(found / told, 1.0)));
      }
    }
  });
}

}  // namespace

Accumulator::Accumulator(const Settings& settings, bool has_through)
    : width_(settings.width), height_(settings.height) {
  const std::size_t n = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  pixels_.resize(n);
  for (const Layer layer : settings.layers) {
    if (layer_info(layer).has_mean) mean_layers_.push_back(layer);
  }
  layers_.resize(n * mean_layers_.size(), vec3(0.0f));
  if (has_through) through_.resize(n);
  if (settings.has_features) features_.resize(n);
}

std::uint64_t Accumulator::bytes_per_pixel(const Settings& settings) {
  const bool may_have_through = settings.background == Background::transparent && !settings.environment_in_glass;
  return sizeof(Pixel) + (settings.has_features ? sizeof(Features) : 0) +
         (may_have_through ? sizeof(Through) + 4 * sizeof(float) : 0) +
         sizeof(vec3) * count_mean_layers(settings.layers);
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
  for (std::size_t k = 0; k < mean_layers_.size(); ++k) {
    layers_[i * mean_layers_.size() + k] += sample.first[static_cast<std::size_t>(mean_layers_[k])];
  }
  if (!features_.empty()) {
    Features& f = features_[i];
    f.albedo += sample.feature_albedo;
    f.normal += sample.feature_normal;
    f.albedo2 += glm::dot(sample.feature_albedo, sample.feature_albedo);
    f.normal2 += glm::dot(sample.feature_normal, sample.feature_normal);
    f.seen += sample.seen;
    const vec3 other = sample.radiance - sample.seen;
    f.other2 += other * other;
    if (((p.count - 1) & kHalf) == 0) {
      f.other_half += other;
      ++f.count_half;
    }
  }
  if (!through_.empty()) {
    Through& t = through_[i];
    const dvec3 through(sample.through);
    t.sum += through;
    t.luminance2 += luminance(through) * luminance(through);
  }
  return true;
}

float Accumulator::relative_error(int x, int y, Reference reference) const {
  const Pixel& p = pixel(x, y);
  if (p.count < 2) return kInfinity;
  const double n = p.count;
  const auto variance_of_mean = [n](double mean, double sum2) {
    return std::max(sum2 / n - mean * mean, 0.0) / (n - 1.0);
  };
  double mean = (0.2126 * p.r + 0.7152 * p.g + 0.0722 * p.b) / n;
  double variance = variance_of_mean(mean, p.luminance2);
  if (!through_.empty()) {
    // Mostly a sample has either light or background; which, is part of the noise.
    const Through& t = through_[index(x, y)];
    const double mean_through = luminance(t.sum) / n;
    const auto background = static_cast<double>(reference.background);
    variance += background * background * variance_of_mean(mean_through, t.luminance2);
    mean += background * mean_through;
  }
  const double scale = std::max(mean, 0.05 * static_cast<double>(reference.luminance));
  return scale > 0.0 ? static_cast<float>(std::sqrt(variance) / scale) : 0.0f;
}

Accumulator::Reference Accumulator::reference() const {
  double sum = 0.0, kept = 0.0;
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    const Pixel& p = pixels_[i];
    if (p.count == 0) continue;
    sum += (0.2126 * p.r + 0.7152 * p.g + 0.0722 * p.b) / p.count;
    if (!through_.empty()) kept += 1.0 - luminance(through_[i].sum) / p.count;
  }
  return {static_cast<float>(sum / static_cast<double>(pixels_.size())),
          kept > 0.0 ? static_cast<float>(sum / kept) : 0.0f};
}

void Accumulator::resolve_features(DenoisingFeatures& features) const {
  features.albedo = features.normal = features.seen = features.variance = Image(width_, height_, 3);
  features.albedo_variance = features.normal_variance = Image(width_, height_, 1);
  Image halves(width_, height_, 1);  // squared error of the mean by the difference of two halves
  for (std::size_t i = 0; i < features_.size(); ++i) {
    const Features& f = features_[i];
    const Pixel& p = pixels_[i];
    const float n = static_cast<float>(std::max(p.count, 1U));
    const float divisor = n > 1.0f ? n - 1.0f : 1.0f;
    const auto variance_of_mean = [&](float mean2, float sum2) { return std::max(sum2 / n - mean2, 0.0f) / divisor; };
    const vec3 albedo = f.albedo / n, normal = f.normal / n, seen = f.seen / n;
    const vec3 other = vec3(dvec3(p.r, p.g, p.b)) / n - seen;
    for (int c = 0; c < 3; ++c) {
      const auto k = 3 * i + static_cast<std::size_t>(c);
      features.albedo.pixels[k] = albedo[c];
      features.normal.pixels[k] = normal[c];
      features.seen.pixels[k] = seen[c];
      // One sample has no variance that one could see: it is as large as what it measures.
      features.variance.pixels[k] =
          p.count > 1 ? variance_of_mean(other[c] * other[c], f.other2[c]) : other[c] * other[c];
    }
    features.albedo_variance.pixels[i] = variance_of_mean(glm::dot(albedo, albedo), f.albedo2) / 3.0f;
    features.normal_variance.pixels[i] = variance_of_mean(glm::dot(normal, normal), f.normal2) / 3.0f;
    const auto first = static_cast<float>(f.count_half), second = static_cast<float>(p.count - f.count_half);
    if (second < 1.0f) continue;
    // Of two means that are apart by d the weighted mean errs by d² ab/(a + b)².
    const vec3 apart = f.other_half / first - (other * n - f.other_half) / second;
    halves.pixels[i] = glm::dot(apart, apart) * first * second / (n * n);
  }
  scale_variance(halves, features.variance);
}

void Accumulator::resolve(Film& film) const {
  if (!features_.empty()) resolve_features(film.features.emplace());
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
  if (!through_.empty()) {
    Image through(width_, height_, 4);
    for (std::size_t i = 0; i < through_.size(); ++i) {
      if (pixels_[i].count == 0) continue;
      float* out = through.pixels.data() + 4 * i;
      for (int c = 0; c < 3; ++c) out[c] = static_cast<float>(through_[i].sum[c] / pixels_[i].count);
      out[3] = film.beauty.pixels[4 * i + 3];
    }
    set_through(std::move(through), film);
  }
  for (std::size_t k = 0; k < mean_layers_.size(); ++k) {
    const Layer layer = mean_layers_[k];
    const int channels = layer_channels(layer);
    Image image(width_, height_, channels);
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
      vec3 v = layers_[i * mean_layers_.size() + k] / static_cast<float>(std::max(pixels_[i].count, 1U));
      const float length = glm::length(v);
      if (layer == Layer::normal && length > 0.0f) v /= length;
      for (int c = 0; c < channels; ++c) {
        image.pixels[i * static_cast<std::size_t>(channels) + static_cast<std::size_t>(c)] = v[c];
      }
    }
    film.layers[layer] = std::move(image);
  }
}

}  // namespace candela::path
