#include "image/flip.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "image/metrics.h"

namespace candela {

namespace {

// ----- colour spaces; XYZ is over the white of Rec.709

const glm::dmat3& xyz_from_rgb() {
  static const glm::dmat3 kMatrix = [] {
    // Columns: red, green and blue; IEC 61966-2-1.
    glm::dmat3 m(dvec3(0.4124564, 0.2126729, 0.0193339), dvec3(0.3575761, 0.7151522, 0.1191920),
                 dvec3(0.1804375, 0.0721750, 0.9503041));
    const dvec3 white = m * dvec3(1.0);
    for (int c = 0; c < 3; ++c) m[c] /= white;
    return m;
  }();
  return kMatrix;
}

/// The linear opponent space: achromatic, red to green, blue to yellow.
dvec3 opponent_from_rgb(dvec3 rgb) {
  const dvec3 xyz = xyz_from_rgb() * rgb;
  return {116.0 * xyz.y - 16.0, 500.0 * (xyz.x - xyz.y), 200.0 * (xyz.y - xyz.z)};
}

dvec3 rgb_from_opponent(dvec3 o) {
  const double y = (o.x + 16.0) / 116.0;
  return glm::inverse(xyz_from_rgb()) * dvec3(y + o.y / 500.0, y, y - o.z / 200.0);
}

/// CIELAB whose chroma fades with lightness, as Hunt found of colours.
dvec3 hunt_lab(dvec3 rgb) {
  const dvec3 xyz = xyz_from_rgb() * rgb;
  const auto f = [](double t) { return t > 216.0 / 24389.0 ? std::cbrt(t) : (24389.0 / 27.0 * t + 16.0) / 116.0; };
  const double lightness = 116.0 * f(xyz.y) - 16.0;
  return {lightness, 0.01 * lightness * 500.0 * (f(xyz.x) - f(xyz.y)),
          0.01 * lightness * 200.0 * (f(xyz.y) - f(xyz.z))};
}

/// Abasi, Tehran & Fairchild 2020: lightness and chroma apart.
double hyab(dvec3 a, dvec3 b) {
  const dvec3 d = a - b;
  return std::abs(d.x) + std::hypot(d.y, d.z);
}

// ----- filters

using Plane = std::vector<double>;

/// Sum over (2 r + 1)² weights around each pixel, edges repeated. `weights(x, y)` of the offset.
template <class W>
Plane filtered(const Plane& plane, int width, int height, int radius, const W& weights) {
  const int side = 2 * radius + 1;
  std::vector<double> kernel;
  for (int y = -radius; y <= radius; ++y) {
    for (int x = -radius; x <= radius; ++x) kernel.push_back(weights(x, y));
  }
  Plane result(plane.size());
  parallel_for(0, static_cast<std::size_t>(height), 4, [&](std::size_t begin, std::size_t end) {
    for (auto y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < width; ++x) {
        double sum = 0.0;
        for (int j = 0; j < side; ++j) {
          const int sy = std::clamp(y + j - radius, 0, height - 1);
          for (int i = 0; i < side; ++i) {
            const int sx = std::clamp(x + i - radius, 0, width - 1);
            sum += kernel[static_cast<std::size_t>(j * side + i)] * plane[static_cast<std::size_t>(sy * width + sx)];
          }
        }
        result[static_cast<std::size_t>(y * width + x)] = sum;
      }
    }
  });
  return result;
}

/// The eye's sensitivity to contrast as a point spread: one or two Gaussians of a channel.
struct Sensitivity {
  double a1, b1, a2, b2;

  double at(double degrees2) const {
    const double p2 = glm::pi<double>() * glm::pi<double>();
    return a1 * std::sqrt(glm::pi<double>() / b1) * std::exp(-p2 * degrees2 / b1) +
           a2 * std::sqrt(glm::pi<double>() / b2) * std::exp(-p2 * degrees2 / b2);
  }
};
constexpr std::array<Sensitivity, 3> kSensitivities = {
    {{1.0, 0.0047, 0.0, 1e-5}, {1.0, 0.0053, 0.0, 1e-5}, {34.1, 0.04, 13.5, 0.025}}};

Plane seen(const Plane& plane, int width, int height, const Sensitivity& s, double pixels_per_degree) {
  const auto radius = static_cast<int>(
      std::ceil(3.0 * std::sqrt(0.04 / (2.0 * glm::pi<double>() * glm::pi<double>())) * pixels_per_degree));
  double sum = 0.0;
  const auto weight = [&](int x, int y) { return s.at((x * x + y * y) / (pixels_per_degree * pixels_per_degree)); };
  for (int y = -radius; y <= radius; ++y) {
    for (int x = -radius; x <= radius; ++x) sum += weight(x, y);
  }
  return filtered(plane, width, height, radius, [&](int x, int y) { return weight(x, y) / sum; });
}

/// How strong edges (first derivative of a Gaussian) or points (second) are at each pixel.
Plane features(const Plane& plane, int width, int height, bool is_edge, double pixels_per_degree) {
  const double deviation = 0.5 * 0.082 * pixels_per_degree;
  const auto radius = static_cast<int>(std::ceil(3.0 * deviation));
  const auto raw = [&](int x, int y) {
    const double g = std::exp(-(x * x + y * y) / (2.0 * deviation * deviation));
    return is_edge ? -x * g : (x * x / (deviation * deviation) - 1.0) * g;
  };
  double positive = 0.0, negative = 0.0;
  for (int y = -radius; y <= radius; ++y) {
    for (int x = -radius; x <= radius; ++x) (raw(x, y) > 0.0 ? positive : negative) += std::abs(raw(x, y));
  }
  const auto weight = [&](int x, int y) { return raw(x, y) / (raw(x, y) > 0.0 ? positive : negative); };
  const Plane across = filtered(plane, width, height, radius, weight);
  const Plane along = filtered(plane, width, height, radius, [&](int x, int y) { return weight(y, x); });
  Plane strength(plane.size());
  for (std::size_t i = 0; i < plane.size(); ++i) strength[i] = std::hypot(across[i], along[i]);
  return strength;
}

/// A picture as the eye takes it: colours as seen from afar, edges and points of its lightness.
struct Perceived {
  std::vector<dvec3> colors;
  Plane edges, points;
};

Perceived perceive(const Image& image, double pixels_per_degree) {
  std::array<Plane, 3> planes;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const dvec3 o = opponent_from_rgb(glm::clamp(dvec3(image.rgb(x, y)), dvec3(0.0), dvec3(1.0)));
      for (int c = 0; c < 3; ++c) planes[static_cast<std::size_t>(c)].push_back(o[c]);
    }
  }
  Perceived result;
  Plane lightness = planes[0];
  for (double& v : lightness) v = (v + 16.0) / 116.0;
  result.edges = features(lightness, image.width, image.height, true, pixels_per_degree);
  result.points = features(lightness, image.width, image.height, false, pixels_per_degree);
  for (std::size_t c = 0; c < 3; ++c) {
    planes[c] = seen(planes[c], image.width, image.height, kSensitivities[c], pixels_per_degree);
  }
  for (std::size_t i = 0; i < planes[0].size(); ++i) {
    const dvec3 rgb = rgb_from_opponent({planes[0][i], planes[1][i], planes[2][i]});
    result.colors.push_back(hunt_lab(glm::clamp(rgb, dvec3(0.0), dvec3(1.0))));
  }
  return result;
}

/// The difference of two colours as a share of the largest there is; small ones take most of the scale.
double color_difference(dvec3 a, dvec3 b) {
  constexpr double kExponent = 0.7, kKnee = 0.4, kAtKnee = 0.95;
  static const double kLargest = std::pow(hyab(hunt_lab(dvec3(0, 1, 0)), hunt_lab(dvec3(0, 0, 1))), kExponent);
  const double d = std::pow(hyab(a, b), kExponent), knee = kKnee * kLargest;
  return d < knee ? d * kAtKnee / knee : kAtKnee + (d - knee) / (kLargest - knee) * (1.0 - kAtKnee);
}

}  // namespace

Image flip(const Image& reference, const Image& test, double pixels_per_degree) {
  mse(reference, test);  // throws where they cannot be compared
  const Perceived a = perceive(reference, pixels_per_degree), b = perceive(test, pixels_per_degree);
  Image result(reference.width, reference.height, 1);
  for (std::size_t i = 0; i < result.pixels.size(); ++i) {
    const double edge = std::abs(a.edges[i] - b.edges[i]), point = std::abs(a.points[i] - b.points[i]);
    const double feature = std::sqrt(std::max(edge, point) / std::sqrt(2.0));
    const double color = std::clamp(color_difference(a.colors[i], b.colors[i]), 0.0, 1.0);
    result.pixels[i] = static_cast<float>(std::pow(color, 1.0 - std::min(feature, 1.0)));
  }
  return result;
}

double flip_mean(const Image& reference, const Image& test) {
  const Image error = flip(reference, test);
  double sum = 0.0;
  for (const float v : error.pixels) sum += static_cast<double>(v);
  return sum / static_cast<double>(error.pixels.size());
}

}  // namespace candela
