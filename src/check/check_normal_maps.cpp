#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>

#include "base/parallel.h"
#include "check/check_parts.h"
#include "shade/color.glsl.h"

// Whether normal maps hold directions of a height field, in the encoding and with the axes that glTF wants: linear,
// +x right, +y up in the image (glTF 2.0 §3.9.3).
namespace candela::check {

namespace {

// Points on the surfaces that show a map; fewer where there are very many maps.
constexpr std::size_t kMostPoints = 16384;
constexpr std::size_t kLeastPoints = 1024;
constexpr std::size_t kPointsInAll = std::size_t{1} << 24;
constexpr float kLengthTolerance = 0.1f;  // JPEG at moderate quality errs by half of that
constexpr double kWorthTelling = 0.05;

/// An image that serves as normal map, of base or coat, and the slots that show it.
struct MapUse {
  struct Wearer {
    int material;
    const TextureSlot* slot;
  };
  std::vector<Wearer> wearers;
};

std::vector<MapUse> map_uses(const Scene& scene) {
  std::map<int, MapUse> of_image;
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    const Material& m = scene.materials[i];
    if (m.unlit) continue;
    for (const TextureSlot* slot : {&m.normal_texture, &m.clearcoat_normal_texture}) {
      if (!*slot) continue;
      const int image = scene.textures[static_cast<std::size_t>(slot->texture)].image;
      of_image[image].wearers.push_back({static_cast<int>(i), slot});
    }
  }
  std::vector<MapUse> result;
  result.reserve(of_image.size());
  for (auto& [image, use] : of_image) result.push_back(std::move(use));
  return result;
}

/// Slopes ∂h/∂x to the right and ∂h/∂y up that a texel's normal stands for.
vec2 slope(vec3 code) {
  // Steeper than this, rounding decides.
  constexpr float kLeastZ = 0.1f;
  const vec3 n = 2.0f * code - 1.0f;
  return -vec2(n) / std::max(n.z, kLeastZ);
}

/// Correlation of ∂p/∂y with ∂q/∂x, p and q the slopes: 1 for any height field, because mixed derivatives are equal; -1
/// where q has the wrong sign. Scale of the map, of its uvs and of noise do not matter.
class CurlMeter {
 public:
  void add(const TexelGrid& grid, ivec2 at) {
    // Derivatives of a Gaussian: noise of single texels says nothing. Rows go down, y goes up.
    constexpr std::array<float, 5> kSmooth = {1.0f / 16, 4.0f / 16, 6.0f / 16, 4.0f / 16, 1.0f / 16};
    constexpr std::array<float, 5> kDerivative = {-1.0f / 8, -2.0f / 8, 0.0f, 2.0f / 8, 1.0f / 8};
    vec2 ddx(0.0f), ddy(0.0f);
    for (int y = -2; y <= 2; ++y) {
      for (int x = -2; x <= 2; ++x) {
        const auto i = static_cast<std::size_t>(x + 2), j = static_cast<std::size_t>(y + 2);
        const vec2 s = slope(grid.rgb(at + ivec2(x, y)));
        ddx += kDerivative[i] * kSmooth[j] * s;
        ddy -= kSmooth[i] * kDerivative[j] * s;
      }
    }
    const double a = ddy.x, b = ddx.y;
    as_is_ += (a - b) * (a - b);
    flipped_ += (a + b) * (a + b);
    sum_aa_ += a * a;
    sum_bb_ += b * b;
    sum_ab_ += a * b;
    // Half a code is what rounding alone may give.
    constexpr double kNoise = 0.5 / 255.0;
    if (std::abs(a) < kNoise || std::abs(b) < kNoise) return;
    ++votes_;
    if ((a > 0.0) != (b > 0.0)) ++against_;
  }

  double correlation() const { return sum_ab_ / std::sqrt(std::max(sum_aa_ * sum_bb_, 1e-300)); }
  /// Root of the mean squared curl relative to that of the derivatives themselves, with the map's sign and the other.
  double residual() const { return std::sqrt(as_is_ / std::max(sum_aa_ + sum_bb_, 1e-300)); }
  double residual_flipped() const { return std::sqrt(flipped_ / std::max(sum_aa_ + sum_bb_, 1e-300)); }
  double against() const { return votes_ > 0 ? static_cast<double>(against_) / static_cast<double>(votes_) : 0.0; }
  std::uint32_t votes() const { return votes_; }

 private:
  double as_is_ = 0.0, flipped_ = 0.0, sum_aa_ = 0.0, sum_bb_ = 0.0, sum_ab_ = 0.0;
  std::uint32_t votes_ = 0, against_ = 0;
};

struct MapMeasure {
  std::uint32_t points = 0;
  std::uint32_t off_unit = 0;
  std::uint32_t inward = 0;
  std::vector<float> lengths;
  dvec2 mean{0.0};          ///< x and y of the vectors, codes read as linear data
  dvec2 mean_as_srgb{0.0};  ///< codes decoded from sRGB first
  CurlMeter curl;

  void add(const TexelGrid& grid, ivec2 at) {
    const vec3 code = grid.rgb(at);
    const vec3 n = 2.0f * code - 1.0f;
    const float length = glm::length(n);
    ++points;
    lengths.push_back(length);
    if (std::fabs(length - 1.0f) > kLengthTolerance) ++off_unit;
    constexpr float kInward = -0.02f;  // rounding of a vector that lies in the surface
    if (n.z < kInward) ++inward;
    mean += dvec2(n.x, n.y);
    const vec3 decoded = 2.0f * shade::srgb_decode(code) - 1.0f;
    mean_as_srgb += dvec2(decoded.x, decoded.y);
    curl.add(grid, at);
  }
  void finish() {
    mean /= std::max(points, 1U);
    mean_as_srgb /= std::max(points, 1U);
    std::nth_element(lengths.begin(), lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2), lengths.end());
  }
  double share(std::uint32_t count) const { return static_cast<double>(count) / std::max(points, 1U); }
  double median_length() const { return lengths.empty() ? 0.0 : static_cast<double>(lengths[lengths.size() / 2]); }
};

MapMeasure measure(const Scene& scene, const MapUse& use, const std::vector<MaterialSurface>& surfaces,
                   std::size_t points) {
  std::vector<MapUse::Wearer> shown;
  for (const MapUse::Wearer& wearer : use.wearers) {
    if (!surfaces[static_cast<std::size_t>(wearer.material)].empty()) shown.push_back(wearer);
  }
  MapMeasure result;
  if (shown.empty()) return result;
  constexpr std::size_t kLeastOfOne = 64;
  const auto each = static_cast<std::uint32_t>(std::max(points / shown.size(), kLeastOfOne));
  for (const auto& [material, slot] : shown) {
    const TexelGrid grid(scene, slot->texture);
    for (std::uint32_t i = 0; i < each; ++i) {
      const SurfaceSample point = surfaces[static_cast<std::size_t>(material)].sample(i);
      result.add(grid, grid.texel_at(*slot, point.uv(slot->uv_set)));
    }
  }
  result.finish();
  return result;
}

/// The first thing that is wrong with a map: what follows from it is not told again.
void judge(const MapUse& use, const MapMeasure& m, std::vector<Finding>& findings) {
  // The slopes of a height field average out unless all of it leans one way.
  constexpr double kLeaning = 0.2;
  constexpr double kUpright = 0.06;
  // Both measures have to agree, for decals and cracks are no height fields and noise is of no sign. Maps that are
  // right have correlations above 0 and at most half of the points against it.
  constexpr double kClear = -0.3;
  constexpr double kMajority = 0.75;
  constexpr std::uint32_t kLeastVotes = 256;
  // Shorter or longer than this in the middle: not JPEG, but what the map holds.
  constexpr double kShort = 0.9;
  constexpr double kLong = 1.1;
  Finding f;
  f.severity = Severity::warning;
  f.material = use.wearers.front().material;
  f.texture = use.wearers.front().slot->texture;
  f.share_of = "texels";
  f.measured = {{"mean_x", m.mean.x},
                {"mean_y", m.mean.y},
                {"median_length", m.median_length()},
                {"off_unit_share", m.share(m.off_unit)},
                {"curl_correlation", m.curl.correlation()},
                {"curl_residual", m.curl.residual()},
                {"curl_residual_flipped", m.curl.residual_flipped()},
                {"curl_votes_against", m.curl.against()},
                {"curl_votes", m.curl.votes()}};
  const bool leans = std::min(m.mean.x, m.mean.y) > kLeaning;
  if (leans && std::max(std::abs(m.mean_as_srgb.x), std::abs(m.mean_as_srgb.y)) < kUpright) {
    f.code = "normal-map-srgb";
    f.message = fmt::format(
        "directions lean by ({:.2f}, {:.2f}) on average; decoded from sRGB by ({:.2f}, {:.2f}): its codes are sRGB "
        "(flat is 188), glTF reads linear data (flat is 128)",
        m.mean.x, m.mean.y, m.mean_as_srgb.x, m.mean_as_srgb.y);
    f.fix = "decode the image from sRGB and store it linear";
  } else if (m.share(m.inward) > kWorthTelling) {
    f.code = "normal-map-inward";
    f.share = m.share(m.inward);
    f.message = "directions look into the surface (blue below 128)";
    f.fix = "where blue is empty: compute it as the square root of 1 - x² - y²";
  } else if (m.share(m.off_unit) > kWorthTelling) {
    f.code = "normal-map-not-unit";
    // Renderers normalize; a few texels that are off do no harm.
    if (m.median_length() > kShort && m.median_length() < kLong) f.severity = Severity::note;
    f.share = m.share(m.off_unit);
    f.message = fmt::format("vectors are off unit length by more than {} (median length {:.2f})", kLengthTolerance,
                            m.median_length());
    f.fix = "normalize each texel";
  } else if (m.curl.votes() >= kLeastVotes && m.curl.correlation() < kClear && m.curl.against() > kMajority) {
    f.code = "normal-map-flipped-y";
    f.share = m.curl.against();
    f.message = fmt::format(
        "curl of the slopes is {:.2f} of their derivatives, with y turned round {:.2f}: green points down, as DirectX "
        "has it",
        m.curl.residual(), m.curl.residual_flipped());
    f.fix = "invert the green channel";
  } else {
    return;
  }
  findings.push_back(std::move(f));
}

}  // namespace

void check_normal_maps(const Scene& scene, const std::vector<MaterialSurface>& surfaces,
                       std::vector<Finding>& findings) {
  const std::vector<MapUse> uses = map_uses(scene);
  std::vector<MapMeasure> measures(uses.size());
  const std::size_t points =
      std::clamp(kPointsInAll / std::max<std::size_t>(uses.size(), 1), kLeastPoints, kMostPoints);
  parallel_for(0, uses.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) measures[i] = measure(scene, uses[i], surfaces, points);
  });
  for (std::size_t i = 0; i < uses.size(); ++i) {
    if (measures[i].points > 0) judge(uses[i], measures[i], findings);
  }
}

}  // namespace candela::check
