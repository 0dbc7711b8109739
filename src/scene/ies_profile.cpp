#include "scene/ies_profile.h"

#include <algorithm>
#include <cmath>

#include "shade/lights.glsl.h"

namespace candela {

namespace {

/// Between which two entries of an ascending list a value lies, and how far it has come from one to the next.
struct Interval {
  std::size_t first = 0, second = 0;
  float t = 0.0f;
};

/// `x` lies within the list.
Interval find_interval(const std::vector<float>& list, float x) {
  const auto above = std::upper_bound(list.begin(), list.end(), x);
  if (above == list.begin()) return {};
  const auto first = static_cast<std::size_t>(above - list.begin()) - 1;
  if (above == list.end()) return {first, first, 0.0f};
  return {first, first + 1, (x - list[first]) / (list[first + 1] - list[first])};
}

bool is_ascending_within(const std::vector<float>& list, float low, float high) {
  return !list.empty() && list.front() >= low && list.back() <= high &&
         std::adjacent_find(list.begin(), list.end(), [](float a, float b) { return !(a < b); }) == list.end();
}

}  // namespace

bool is_valid(const IesProfile& p) {
  const mat3 square = glm::transpose(p.web_from_light) * p.web_from_light;
  bool is_rotation = glm::determinant(p.web_from_light) > 0.0f;
  for (int i = 0; i < 3; ++i) is_rotation &= glm::length(square[i] - mat3(1.0f)[i]) < 1e-5f;
  if (!is_rotation) return false;
  const bool is_round = p.horizontal_deg.size() == 1 && p.horizontal_deg[0] == 0.0f;
  const bool is_full = p.horizontal_deg.size() > 1 && is_ascending_within(p.horizontal_deg, 0.0f, 360.0f) &&
                       p.horizontal_deg.front() == 0.0f && p.horizontal_deg.back() == 360.0f;
  return is_ascending_within(p.vertical_deg, 0.0f, 180.0f) && (is_round || is_full) &&
         p.candela.size() == p.vertical_deg.size() * p.horizontal_deg.size() &&
         std::all_of(p.candela.begin(), p.candela.end(), [](float c) { return c >= 0.0f && std::isfinite(c); });
}

float ies_intensity(const IesProfile& p, vec3 local_direction) {
  const vec3 d = p.web_from_light * local_direction;
  const vec2 angles = shade::light_profile_angles(d);
  const float vertical = degrees(angles.y);
  // A few ulp past an edge of the table are the edge: 180° comes out of atan2 rounded either way.
  constexpr float kRounding = 1e-4f;
  const float lowest = p.vertical_deg.front(), highest = p.vertical_deg.back();
  if (vertical < lowest - kRounding || vertical > highest + kRounding) return 0.0f;
  const Interval v = find_interval(p.vertical_deg, std::clamp(vertical, lowest, highest));
  const auto row = [&](std::size_t h) {
    const float* values = p.candela.data() + h * p.vertical_deg.size();
    return values[v.first] + (values[v.second] - values[v.first]) * v.t;
  };
  if (p.horizontal_deg.size() == 1) return row(0);
  float horizontal = degrees(angles.x);
  if (horizontal < 0.0f) horizontal += 360.0f;
  const Interval h = find_interval(p.horizontal_deg, std::min(horizontal, 360.0f));
  const float first = row(h.first);
  return first + (row(h.second) - first) * h.t;
}

double ies_flux(const IesProfile& p) {
  const std::size_t count = p.vertical_deg.size();
  const auto radians_of = [](float deg) { return static_cast<double>(deg) * (static_cast<double>(M_PI) / 180.0); };
  // ∫ sin θ of a row that is linear in θ between its entries; with Δ = b - a the slope's part is
  // ∫ (θ - a) sin θ dθ = sin b - sin a - Δ cos b.
  const auto row_integral = [&](std::size_t h) {
    const float* values = p.candela.data() + h * count;
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < count; ++i) {
      const double a = radians_of(p.vertical_deg[i]), b = radians_of(p.vertical_deg[i + 1]);
      const double low = static_cast<double>(values[i]), high = static_cast<double>(values[i + 1]);
      sum += low * (std::cos(a) - std::cos(b)) +
             (high - low) / (b - a) * (std::sin(b) - std::sin(a) - (b - a) * std::cos(b));
    }
    return sum;
  };
  if (p.horizontal_deg.size() == 1) return 2.0 * M_PI * row_integral(0);
  double flux = 0.0, before = row_integral(0);
  for (std::size_t h = 1; h < p.horizontal_deg.size(); ++h) {
    const double here = row_integral(h);
    flux += 0.5 * (before + here) * radians_of(p.horizontal_deg[h] - p.horizontal_deg[h - 1]);
    before = here;
  }
  return flux;
}

}  // namespace candela
