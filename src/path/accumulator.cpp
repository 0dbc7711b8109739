#include "path/accumulator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "base/error.h"
#include "base/large_pages.h"
#include "base/parallel.h"

namespace candela::path {

namespace {

/// Of few samples a pixel's own variance says little, of one that has met no light yet nothing: there it is at least
/// the mean of the pixels around.
void raise_variance(const std::vector<std::uint8_t>& has_few, Image& variance) {
  constexpr int kRadius = 2;
  const Image before = variance;
  parallel_for(0, static_cast<std::size_t>(variance.height), 4, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < variance.width; ++x) {
        if (has_few[static_cast<std::size_t>(y) * static_cast<std::size_t>(variance.width) +
                    static_cast<std::size_t>(x)] == 0) {
          continue;
        }
        vec3 sum(0.0f);
        float count = 0.0f;
        for (int j = std::max(y - kRadius, 0); j <= std::min(y + kRadius, variance.height - 1); ++j) {
          for (int i = std::max(x - kRadius, 0); i <= std::min(x + kRadius, variance.width - 1); ++i) {
            sum += before.rgb(i, j);
            ++count;
          }
        }
        variance.set_rgb(x, y, glm::max(before.rgb(x, y), sum / count));
      }
    }
  });
}

/// Sobol' points do better than independent samples, by how much the difference of two halves says; of one pixel it
/// says little, of the pixels around it enough. Negative: of a pixel that has no second half.
void scale_variance(const Image& halves, Image& variance) {
  constexpr int kRadius = 3;
  const Image before = variance;
  parallel_for(0, static_cast<std::size_t>(variance.height), 4, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < variance.width; ++x) {
        double found = 0.0, told = 0.0;
        for (int j = std::max(y - kRadius, 0); j <= std::min(y + kRadius, variance.height - 1); ++j) {
          for (int i = std::max(x - kRadius, 0); i <= std::min(x + kRadius, variance.width - 1); ++i) {
            if (halves.at(i, j)[0] < 0.0f) continue;
            found += static_cast<double>(halves.at(i, j)[0]);
            for (const float v : before.at(i, j)) told += static_cast<double>(v);
          }
        }
        if (!(told > 0.0)) continue;
        for (float& v : variance.at(x, y)) v *= static_cast<float>(std::min(found / told, 1.0));
      }
    }
  });
}

}  // namespace

Accumulator::Accumulator(const Settings& settings, bool has_through)
    : width_(settings.width), height_(settings.height) {
  const std::size_t n = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  resize_large(pixels_, n);
  for (const Layer layer : settings.layers) {
    if (layer_info(layer).has_mean) mean_layers_.push_back(layer);
  }
  resize_large(layers_, n * mean_layers_.size());
  for (const MatteKind kind : settings.mattes) mattes_.emplace(kind, MatteSums(width_, height_));
  if (has_through) resize_large(through_, n);
  if (settings.has_features) resize_large(features_, n);
  if (settings.noise) luminance2_.resize(n), half_luminance_.resize(n);
}

std::uint64_t Accumulator::bytes_per_pixel(const Settings& settings) {
  const bool may_have_through = settings.background == Background::transparent;
  // Judging noise takes what is metered, with copies to sort, and the errors.
  constexpr std::size_t kJudging = sizeof(float) * (1 + 8 + 3 + 1) + sizeof(double);
  constexpr std::size_t kMattes = sizeof(std::vector<Matte>) + 4 * sizeof(Matte);  // few pixels have more
  return sizeof(Pixel) + (settings.has_features ? sizeof(Features) : 0) + (settings.noise ? kJudging : 0) +
         (may_have_through ? sizeof(Through) + 4 * sizeof(float) : 0) +
         3 * sizeof(ExactSmallSum) * count_mean_layers(settings.layers) + kMattes * settings.mattes.size();
}

bool Accumulator::add(int x, int y, std::uint32_t number, const PathSample& sample) {
  if (!is_finite(sample.radiance)) return false;
  const std::size_t i = index(x, y);
  Pixel& p = pixels_[i];
  p.r.add(sample.radiance.x);
  p.g.add(sample.radiance.y);
  p.b.add(sample.radiance.z);
  p.alpha += sample.alpha;
  ++p.count;
  for (std::size_t k = 0; k < mean_layers_.size(); ++k) {
    // One normal serves both spaces.
    const Layer from = mean_layers_[k] == Layer::camera_normal ? Layer::normal : mean_layers_[k];
    for (int c = 0; c < 3; ++c)
      layers_[i * mean_layers_.size() + k][static_cast<std::size_t>(c)].add(sample.of(from)[c]);
  }
  const bool is_first_half = (number & kHalf) == 0;
  if (!luminance2_.empty()) {
    const float l = luminance(sample.radiance);
    luminance2_[i] += static_cast<double>(l) * static_cast<double>(l);
    if (is_first_half) half_luminance_[i] += l;
  }
  if (!features_.empty()) {
    Features& f = features_[i];
    const dvec3 albedo(sample.feature_albedo), normal(sample.feature_normal);
    f.albedo += albedo;
    f.normal += normal;
    f.albedo2 += glm::dot(albedo, albedo);
    f.normal2 += glm::dot(normal, normal);
    f.seen += dvec3(sample.seen);
    const auto seen = static_cast<double>(luminance(sample.seen));
    f.seen2 += seen * seen;
    const dvec3 other(sample.radiance - sample.seen);
    f.other2 += other * other;
    if (is_first_half) {
      f.other_half += other;
      f.seen_half += seen;
      ++f.count_half;
    }
  }
  if (!through_.empty()) {
    Through& t = through_[i];
    const dvec3 through(sample.through);
    t.sum += through;
    t.luminance2 += luminance(through) * luminance(through);
    if (is_first_half) t.half += luminance(through);
  }
  return true;
}

void Accumulator::add(const Features& from, Features& to) {
  to.albedo += from.albedo, to.normal += from.normal, to.seen += from.seen;
  to.albedo2 += from.albedo2, to.normal2 += from.normal2;
  to.seen2 += from.seen2, to.seen_half += from.seen_half;
  to.other2 += from.other2, to.other_half += from.other_half;
  to.count_half += from.count_half;
}

void Accumulator::add(const Accumulator& other) {
  constexpr std::size_t kGrain = 1 << 16;
  const auto add_all = [](auto& to, const auto& from, auto&& add_one) {
    parallel_for(0, to.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) add_one(to[i], from[i]);
    });
  };
  const auto add_number = [](auto& to, auto from) { to += from; };
  add_all(pixels_, other.pixels_, [](Pixel& p, const Pixel& q) {
    p.r.add(q.r), p.g.add(q.g), p.b.add(q.b);
    p.alpha += q.alpha;
    p.count += q.count;
  });
  add_all(luminance2_, other.luminance2_, add_number);
  add_all(half_luminance_, other.half_luminance_, add_number);
  add_all(features_, other.features_, [](Features& to, const Features& from) { add(from, to); });
  add_all(layers_, other.layers_, [](auto& to, const auto& from) {
    for (std::size_t c = 0; c < to.size(); ++c) to[c].add(from[c]);
  });
  add_all(through_, other.through_, [](Through& to, const Through& from) {
    to.sum += from.sum;
    to.luminance2 += from.luminance2;
    to.half += from.half;
  });
  for (auto& [kind, sums] : mattes_) sums.add(other.mattes_.at(kind));
}

void Accumulator::write(std::vector<std::byte>& bytes) const {
  for_sums(*this, [&](const auto& sums) {
    const auto raw = std::as_bytes(std::span(sums));
    bytes.insert(bytes.end(), raw.begin(), raw.end());
  });
  for (const auto& [kind, sums] : mattes_) sums.write(bytes);
}

void Accumulator::read(std::span<const std::byte>& bytes) {
  for_sums(*this, [&](auto& sums) {
    const auto raw = std::as_writable_bytes(std::span(sums));
    if (bytes.size() < raw.size()) throw Error("the sums end before their pixels do");
    std::copy_n(bytes.begin(), raw.size(), raw.begin());
    bytes = bytes.subspan(raw.size());
  });
  const auto is_possible = [](const Pixel& p) { return p.alpha >= 0.0f && p.alpha <= static_cast<float>(p.count); };
  if (!std::all_of(pixels_.begin(), pixels_.end(), is_possible)) throw Error("a pixel is impossible");
  for (auto& [kind, sums] : mattes_) sums.read(bytes);
}

Accumulator::Light Accumulator::light(std::size_t i, float background) const {
  const Pixel& p = pixels_[i];
  if (p.count < 2) return {vec3(0.0f), kInfinity};
  const double n = p.count;
  const auto variance_of_mean = [n](double mean, double sum2) {
    return std::max(sum2 / n - mean * mean, 0.0) / (n - 1.0);
  };
  dvec3 mean = p.sum() / n;
  double variance = variance_of_mean(luminance(mean), luminance2_[i]);
  if (!through_.empty()) {
    // Mostly a sample has either light or background; which, is part of the noise.
    const Through& t = through_[i];
    const auto level = static_cast<double>(background);
    variance += level * level * variance_of_mean(luminance(t.sum) / n, t.luminance2);
    mean += level * t.sum / n;
  }
  const double of_mean = luminance(mean);
  return {vec3(mean), of_mean > 0.0 ? static_cast<float>(std::sqrt(variance) / of_mean) : 0.0f};
}

float Accumulator::mean_of_what_is_there() const {
  if (through_.empty()) return 0.0f;
  double sum = 0.0, kept = 0.0;
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    const Pixel& p = pixels_[i];
    if (p.count == 0) continue;
    sum += luminance(p.sum()) / p.count;
    kept += 1.0 - luminance(through_[i].sum) / p.count;
  }
  return kept > 0.0 ? static_cast<float>(sum / kept) : 0.0f;
}

float Accumulator::exposure(const DevelopSettings& develop) const {
  if (develop.exposure) return *develop.exposure;
  Film film;
  resolve_beauty(film);
  return metered_exposure(film);
}

/// How far apart the means of a pixel's two halves are, over how far they would be if samples were independent:
/// squared, of the mean. 1 in expectation for those, less for Sobol' points. Negative where nobody knows.
float Accumulator::gain_of_points(std::size_t i) const {
  const Pixel& p = pixels_[i];
  const std::uint32_t first = p.count / (2 * kHalf) * kHalf + std::min(p.count % (2 * kHalf), kHalf);
  if (first == p.count || first == 0) return -1.0f;
  const double n = p.count, a = first, b = n - a;
  const double mean = luminance(p.sum()) / n;
  const double told = std::max(luminance2_[i] / n - mean * mean, 0.0) / (n - 1.0);
  if (!(told > 1e-12 * mean * mean)) return -1.0f;
  const auto half = static_cast<double>(half_luminance_[i]);
  const double apart = half / a - (mean * n - half) / b;
  return static_cast<float>(apart * apart * a * b / (n * n) / told);
}

/// The mean of that over a block: of one pixel it says little.
float Accumulator::gain_of_block(ivec2 corner, ivec2 end) const {
  float sum = 0.0f, count = 0.0f;
  for (int y = corner.y; y < end.y; ++y) {
    for (int x = corner.x; x < end.x; ++x) {
      const float gain = gain_of_points(index(x, y));
      if (gain < 0.0f) continue;
      sum += gain;
      ++count;
    }
  }
  return count > 0.0f ? std::min(sum / count, 1.0f) : 1.0f;
}

std::vector<float> Accumulator::shown_errors(const DevelopSettings& develop) const {
  constexpr int kBlock = 8;  // pixels
  const Shown shown(develop.tone_curve, exposure(develop));
  const float background = mean_of_what_is_there();
  const int columns = (width_ + kBlock - 1) / kBlock, rows = (height_ + kBlock - 1) / kBlock;
  std::vector<float> errors(pixels_.size());
  parallel_for(0, static_cast<std::size_t>(columns * rows), 16, [&](std::size_t begin, std::size_t end) {
    for (int block = static_cast<int>(begin); block < static_cast<int>(end); ++block) {
      const ivec2 corner = ivec2(block % columns, block / columns) * kBlock;
      const ivec2 stop = glm::min(corner + kBlock, ivec2(width_, height_));
      const float scale = std::sqrt(gain_of_block(corner, stop));
      for (int y = corner.y; y < stop.y; ++y) {
        for (int x = corner.x; x < stop.x; ++x) {
          const Light l = light(index(x, y), background);
          errors[index(x, y)] = shown.error(l.mean, scale * l.relative_error);
        }
      }
    }
  });
  return errors;
}

void Accumulator::resolve_features(DenoisingFeatures& features) const {
  features.albedo = features.normal = features.variance = Image(width_, height_, 3);
  features.seen = Image(width_, height_, 4);
  features.albedo_variance = features.normal_variance = Image(width_, height_, 1);
  Image halves(width_, height_, 1), halves_seen(width_, height_, 1);  // squared error of the mean by two halves
  Image seen_variance(width_, height_, 1);
  for (std::size_t i = 0; i < features_.size(); ++i) {
    const Features& f = features_[i];
    const Pixel& p = pixels_[i];
    const double n = std::max(p.count, 1U), divisor = n > 1.0 ? n - 1.0 : 1.0;
    const auto variance_of_mean = [&](double mean2, double sum2) {
      return static_cast<float>(std::max(sum2 / n - mean2, 0.0) / divisor);
    };
    const dvec3 albedo = f.albedo / n, normal = f.normal / n, seen = f.seen / n;
    const dvec3 other = p.sum() / n - seen;
    for (int c = 0; c < 3; ++c) {
      const auto k = 3 * i + static_cast<std::size_t>(c);
      features.albedo.pixels[k] = static_cast<float>(albedo[c]);
      features.normal.pixels[k] = static_cast<float>(normal[c]);
      features.seen.pixels[4 * i + static_cast<std::size_t>(c)] = static_cast<float>(seen[c]);
      // One sample has no variance that one could see: it is as large as what it measures.
      features.variance.pixels[k] =
          p.count > 1 ? variance_of_mean(other[c] * other[c], f.other2[c]) : static_cast<float>(other[c] * other[c]);
    }
    features.albedo_variance.pixels[i] = variance_of_mean(glm::dot(albedo, albedo), f.albedo2) / 3.0f;
    features.normal_variance.pixels[i] = variance_of_mean(glm::dot(normal, normal), f.normal2) / 3.0f;
    const double level = luminance(seen);
    seen_variance.pixels[i] = variance_of_mean(level * level, f.seen2);
    const auto first = static_cast<double>(f.count_half), second = n - first;
    halves.pixels[i] = halves_seen.pixels[i] = -1.0f;
    if (first < 1.0 || second < 1.0) continue;
    // Of two means that are apart by d the weighted mean errs by d² ab/(a + b)².
    const dvec3 apart = f.other_half / first - (other * n - f.other_half) / second;
    halves.pixels[i] = static_cast<float>(glm::dot(apart, apart) * first * second / (n * n));
    const double seen_apart = f.seen_half / first - (level * n - f.seen_half) / second;
    halves_seen.pixels[i] = static_cast<float>(seen_apart * seen_apart * first * second / (n * n));
  }
  scale_variance(halves, features.variance);
  constexpr std::uint32_t kFew = 4;
  std::vector<std::uint8_t> has_few(pixels_.size());
  std::transform(pixels_.begin(), pixels_.end(), has_few.begin(),
                 [](const Pixel& p) { return p.count < kFew ? 1 : 0; });
  raise_variance(has_few, features.variance);
  scale_variance(halves_seen, seen_variance);
  for (std::size_t i = 0; i < features_.size(); ++i) features.seen.pixels[4 * i + 3] = seen_variance.pixels[i];
  resolve_through_variance(features);
}

/// As of the picture's light; one number for the three channels.
void Accumulator::resolve_through_variance(DenoisingFeatures& features) const {
  if (through_.empty()) return;
  features.through_variance = Image(width_, height_, 3);
  Image halves(width_, height_, 1);
  for (std::size_t i = 0; i < through_.size(); ++i) {
    const Through& t = through_[i];
    const double n = std::max(pixels_[i].count, 1U), first = static_cast<double>(features_[i].count_half),
                 second = n - first;
    const double mean = luminance(t.sum) / n;
    const double variance = n > 1.0 ? std::max(t.luminance2 / n - mean * mean, 0.0) / (n - 1.0) : mean * mean;
    for (std::size_t c = 0; c < 3; ++c) features.through_variance.pixels[3 * i + c] = static_cast<float>(variance);
    const double apart = second < 1.0 ? 0.0 : t.half / first - (mean * n - t.half) / second;
    halves.pixels[i] = second < 1.0 ? -1.0f : static_cast<float>(3.0 * apart * apart * first * second / (n * n));
  }
  scale_variance(halves, features.through_variance);
}

void Accumulator::resolve_beauty(Film& film) const {
  film.beauty = Image(width_, height_, 4);
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    const Pixel& p = pixels_[i];
    if (p.count == 0) continue;
    const double scale = 1.0 / p.count;
    float* out = film.beauty.pixels.data() + 4 * i;
    const dvec3 mean = p.sum() * scale;
    for (int c = 0; c < 3; ++c) out[c] = static_cast<float>(mean[c]);
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
}

void Accumulator::resolve(Film& film, bool wants_features) const {
  if (wants_features && !features_.empty()) resolve_features(film.features.emplace());
  resolve_beauty(film);
  for (std::size_t k = 0; k < mean_layers_.size(); ++k) {
    const Layer layer = mean_layers_[k];
    const int channels = layer_channels(layer);
    Image image(width_, height_, channels);
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
      const std::array<ExactSmallSum, 3>& sum = layers_[i * mean_layers_.size() + k];
      vec3 v(dvec3(sum[0].value(), sum[1].value(), sum[2].value()) /
             static_cast<double>(std::max(pixels_[i].count, 1U)));
      const float length = glm::length(v);
      const bool is_direction = layer == Layer::normal || layer == Layer::camera_normal;
      if (is_direction && length > 0.0f) v /= length;
      for (int c = 0; c < channels; ++c) {
        image.pixels[i * static_cast<std::size_t>(channels) + static_cast<std::size_t>(c)] = v[c];
      }
    }
    film.layers[layer] = std::move(image);
  }
  for (const auto& [kind, sums] : mattes_) {
    film.mattes[kind] =
        sums.mattes([&](std::size_t i) { return 1.0f / static_cast<float>(std::max(pixels_[i].count, 1U)); });
  }
}

}  // namespace candela::path
