#include "image/primaries.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/parallel.h"
#include "math/spectrum.h"

namespace candela {

namespace {

using glm::dmat3;

/// Of chromaticities as files have them: three or four decimals.
constexpr double kRounding = 1e-3;

bool is_near(dvec2 a, dvec2 b) { return std::max(std::abs(a.x - b.x), std::abs(a.y - b.y)) < kRounding; }

/// Primaries may be imaginary colours, but not anywhere.
bool is_usable(dvec2 xy) {
  constexpr double kFarthest = 4.0;
  return std::abs(xy.x) < kFarthest && std::abs(xy.y) < kFarthest;  // and no NaN
}

/// A white or a neutral, which has luminance.
bool is_colour(dvec2 xy) { return is_usable(xy) && xy.x > 0.0 && xy.y > kRounding && xy.x + xy.y < 1.0; }

dvec3 xyz_of(dvec2 xy) { return {xy.x, xy.y, 1.0 - xy.x - xy.y}; }
dvec3 white_of(dvec2 xy) { return xyz_of(xy) / xy.y; }

/// XYZ in the light of `from` to what looks alike in the light of `to`.
dmat3 adaptation(dvec2 from, dvec2 to) {
  const dmat3 cones = glm::transpose(
      dmat3(0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367, 0.0389, -0.0685, 1.0296));  // rows of Bradford's matrix
  const dvec3 scale = (cones * white_of(to)) / (cones * white_of(from));
  return glm::inverse(cones) * dmat3(scale.x, 0, 0, 0, scale.y, 0, 0, 0, scale.z) * cones;
}

/// Towards the grey of the same luminance, as far as needed.
vec3 within_rec709(vec3 c) {
  const float grey = luminance(c);
  if (!(grey > 0.0f)) return vec3(0.0f);
  const float least = std::min({c.x, c.y, c.z});
  return glm::max(glm::mix(vec3(grey), c, grey / (grey - least)), vec3(0.0f));
}

}  // namespace

bool is_same(const Primaries& a, const Primaries& b) {
  return is_near(a.red, b.red) && is_near(a.green, b.green) && is_near(a.blue, b.blue) && is_near(a.white, b.white);
}

std::optional<dmat3> xyz_from_rgb(const Primaries& p) {
  constexpr double kLeastArea = 1e-3;  // twice the triangle's; Rec.709 has 0.22
  if (!is_usable(p.red) || !is_usable(p.green) || !is_usable(p.blue) || !is_colour(p.white)) return std::nullopt;
  const dmat3 directions(xyz_of(p.red), xyz_of(p.green), xyz_of(p.blue));
  if (std::abs(glm::determinant(directions)) < kLeastArea) return std::nullopt;
  const dvec3 scale = glm::inverse(directions) * white_of(p.white);
  if (!(std::min({scale.x, scale.y, scale.z}) > kRounding)) return std::nullopt;
  return dmat3(directions[0] * scale.x, directions[1] * scale.y, directions[2] * scale.z);
}

std::optional<mat3> rec709_from_rgb(const Primaries& primaries, std::optional<dvec2> neutral) {
  const std::optional<dmat3> xyz = xyz_from_rgb(primaries);
  if (!xyz || (neutral && !is_colour(*neutral))) return std::nullopt;
  const dvec2 from = neutral ? *neutral : is_same(primaries, kXyz) ? kRec709.white : primaries.white;
  const dmat3 adapted = adaptation(from, kRec709.white) * *xyz;
  return mat3(dmat3(rec709_from_xyz(adapted[0]), rec709_from_xyz(adapted[1]), rec709_from_xyz(adapted[2])));
}

std::size_t convert_to_rec709(Image& image, const mat3& rec709_from_file) {
  std::atomic<std::size_t> moved{0};
  parallel_for(0, static_cast<std::size_t>(image.height), 16, [&](std::size_t begin, std::size_t end) {
    constexpr float kRoundingOf709 = 1e-5f;  // of a colour on the edge of Rec.709
    std::size_t count = 0;
    for (std::size_t y = begin; y < end; ++y) {
      for (int x = 0; x < image.width; ++x) {
        const vec3 before = image.rgb(x, static_cast<int>(y));
        if (!is_finite(before)) continue;
        vec3 after = rec709_from_file * before;
        const float least = std::min({after.x, after.y, after.z});
        if (least < 0.0f && std::min({before.x, before.y, before.z}) >= 0.0f) {
          count += least < -kRoundingOf709 * max_component(after) ? 1 : 0;
          after = within_rec709(after);
        }
        image.set_rgb(x, static_cast<int>(y), after);
      }
    }
    moved += count;
  });
  return moved;
}

std::string primaries_text(const Primaries& p) {
  return fmt::format("R {:.4g} {:.4g}, G {:.4g} {:.4g}, B {:.4g} {:.4g}, white {:.4g} {:.4g}", p.red.x, p.red.y,
                     p.green.x, p.green.y, p.blue.x, p.blue.y, p.white.x, p.white.y);
}

}  // namespace candela
