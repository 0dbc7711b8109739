#include "ibl/sun.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace candela::ibl {
namespace {

constexpr double kPiD = std::numbers::pi;

/// The map's texels as a graph that wraps in azimuth.
class Patches {
 public:
  explicit Patches(const Image& map) : map_(map), taken_(static_cast<std::size_t>(map.width * map.height), false) {}

  /// The brightest texel that belongs to no patch yet, or -1.
  int brightest() const {
    int best = -1;
    double most = 0.0;
    for (int i = 0; i < map_.width * map_.height; ++i) {
      const double v = value(i);
      if (!taken_[static_cast<std::size_t>(i)] && v > most) most = v, best = i;
    }
    return best;
  }
  double value(int i) const { return luminance(dvec3(map_.rgb(i % map_.width, i / map_.width))); }

  /// All free texels of at least `limit` that hang together with `seed`, and the mean radiance of the ring around them.
  std::vector<int> grow(int seed, double limit, dvec3& ring) {
    std::vector<int> patch = {seed};
    std::vector<int> rim;
    taken_[static_cast<std::size_t>(seed)] = true;
    for (std::size_t at = 0; at < patch.size(); ++at) {
      for (const int next : neighbours(patch[at])) {
        if (taken_[static_cast<std::size_t>(next)]) continue;
        if (value(next) < limit) {
          rim.push_back(next);
          continue;
        }
        taken_[static_cast<std::size_t>(next)] = true;
        patch.push_back(next);
      }
    }
    ring = dvec3(0.0);
    std::sort(rim.begin(), rim.end());
    rim.erase(std::unique(rim.begin(), rim.end()), rim.end());
    for (const int i : rim) ring += dvec3(map_.rgb(i % map_.width, i / map_.width)) / static_cast<double>(rim.size());
    std::sort(patch.begin(), patch.end());
    return patch;
  }

 private:
  std::vector<int> neighbours(int i) const {
    const int x = i % map_.width, y = i / map_.width;
    std::vector<int> all;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (y + dy < 0 || y + dy >= map_.height || (dx == 0 && dy == 0)) continue;
        all.push_back((y + dy) * map_.width + (x + dx + map_.width) % map_.width);
      }
    }
    return all;
  }

  const Image& map_;
  std::vector<bool> taken_;
};

/// Direction, size and illuminance of what a patch has beyond `ring`.
Sun measure(const Source& source, const std::vector<int>& patch, dvec3 ring) {
  const int width = source.map.width, height = source.map.height;
  dvec3 centre(0.0);
  std::vector<dvec3> flux;
  for (const int i : patch) {
    const dvec3 beyond = glm::max(dvec3(source.map.rgb(i % width, i / width)) - ring, dvec3(0.0));
    flux.push_back(beyond * texel_solid_angle(i / width, width, height));
    centre += texel_direction(source, i % width, i / width) * luminance(flux.back());
  }
  Sun sun;
  sun.direction = glm::normalize(centre);
  double spread = 0.0, weight = 0.0;
  for (std::size_t k = 0; k < patch.size(); ++k) {
    const int x = patch[k] % width, y = patch[k] / width;
    const dvec3 d = texel_direction(source, x, y);
    const dvec3 chord = d - sun.direction;
    const double step = kPiD / height, across = step * std::sin(kPiD * (y + 0.5) / height);
    spread += luminance(flux[k]) * (glm::dot(chord, chord) + (step * step + across * across) / 12.0);
    weight += luminance(flux[k]);
    sun.illuminance += flux[k] * std::max(glm::dot(d, sun.direction), 0.0);
  }
  // The mean squared distance from the middle of a disc is half its radius squared.
  sun.angular_radius = weight > 0.0 ? std::sqrt(2.0 * spread / weight) : 0.0;
  return sun;
}

Sun sun_of(const SunDisc& disc) {
  const double s = std::sin(static_cast<double>(disc.angular_radius));
  return {glm::normalize(dvec3(disc.direction)), static_cast<double>(disc.angular_radius),
          dvec3(disc.radiance) * (kPiD * s * s)};
}

}  // namespace

SunExtraction extract_suns(const Source& source, const SunSettings& settings) {
  constexpr double kShareOfPeak = 0.05;  // texels fainter than this belong to the glow around a sun
  constexpr int kMostPatches = 256;      // that are looked at before giving up
  SunExtraction result{{}, source};
  result.rest.suns.clear();
  const double total = luminance(total_flux(source));
  const double mean = total / (4.0 * kPiD);
  for (const SunDisc& disc : source.suns) result.suns.push_back(sun_of(disc));

  Patches patches(source.map);
  for (int k = 0; k < kMostPatches && static_cast<int>(result.suns.size()) < settings.most; ++k) {
    const int seed = patches.brightest();
    if (seed < 0 || patches.value(seed) < settings.contrast * mean) break;
    dvec3 ring(0.0);
    const double limit = std::max(settings.contrast * mean, kShareOfPeak * patches.value(seed));
    const std::vector<int> patch = patches.grow(seed, limit, ring);
    const Sun sun = measure(source, patch, ring);
    if (luminance(sun.illuminance) < settings.least_share * total || sun.angular_radius > settings.widest) continue;
    result.suns.push_back(sun);
    for (const int i : patch) {
      const int x = i % source.map.width, y = i / source.map.width;
      result.rest.map.set_rgb(x, y, glm::min(source.map.rgb(x, y), vec3(ring)));
    }
  }
  std::stable_sort(result.suns.begin(), result.suns.end(),
                   [](const Sun& a, const Sun& b) { return luminance(a.illuminance) > luminance(b.illuminance); });
  return result;
}

}  // namespace candela::ibl
