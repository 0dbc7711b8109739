#include "path/displacement.h"

#include <algorithm>
#include <cmath>

namespace candela::path {

namespace {

constexpr std::size_t kMostTriangles = 2'000'000;
constexpr int kMostDivisions = 256;

/// Values at a triangle's corners, and anywhere between them.
template <class V>
struct Corners {
  V a, b, c;
  V at(float u, float v) const { return a * (1.0f - u - v) + b * u + c * v; }
};

template <class V>
Corners<V> corners(const std::vector<V>& values, const uvec3& t) {
  return values.empty() ? Corners<V>{V(0), V(0), V(0)} : Corners<V>{values[t.x], values[t.y], values[t.z]};
}

/// The same for every triangle, so that neighbours meet.
int divisions(const Primitive& primitive, const TextureSlot& slot, ivec2 texels) {
  const auto& uvs = primitive.uvs[static_cast<std::size_t>(slot.uv_set)];
  float longest = 1.0f;
  for (const uvec3& t : primitive.triangles) {
    for (int i = 0; i < 3; ++i) {
      const vec2 side = (slot.apply(uvs[t[i]]) - slot.apply(uvs[t[(i + 1) % 3]])) * vec2(texels);
      longest = std::max(longest, glm::length(side));
    }
  }
  const auto affordable = static_cast<int>(
      std::sqrt(static_cast<double>(kMostTriangles) / static_cast<double>(primitive.triangles.size())));
  return std::clamp(static_cast<int>(std::ceil(longest)), 1, std::clamp(affordable, 1, kMostDivisions));
}

class Relief {
 public:
  Relief(const Primitive& primitive, const Material& material, const TextureReader& height)
      : primitive_(primitive), material_(material), height_(height) {}

  Primitive build(int n) {
    n_ = n;
    result_.material = primitive_.material;
    for (const uvec3& t : primitive_.triangles) add_triangle(t);
    return std::move(result_);
  }

 private:
  float shift(const Corners<vec2>& uvs, float u, float v) const {
    return (height_.sample(uvs.at(u, v)).x - material_.height_level) * material_.height_scale;
  }

  void add_triangle(const uvec3& t) {
    const auto positions = corners(primitive_.positions, t);
    const auto normals = corners(primitive_.normals, t);
    const auto tangents = corners(primitive_.tangents, t);
    const auto colors = corners(primitive_.colors, t);
    const Corners<vec2> relief_uvs =
        corners(primitive_.uvs[static_cast<std::size_t>(material_.height_texture.uv_set)], t);
    const auto first = static_cast<std::uint32_t>(result_.positions.size());
    const float step = 1.0f / static_cast<float>(n_);
    for (int j = 0; j <= n_; ++j) {
      for (int i = 0; i + j <= n_; ++i) {
        const float u = static_cast<float>(i) * step, v = static_cast<float>(j) * step;
        const vec3 sum = normals.at(u, v);
        const float length = glm::length(sum);
        const vec3 n = length > 0.0f ? sum / length : normals.a;
        result_.positions.push_back(positions.at(u, v) + n * shift(relief_uvs, u, v));
        result_.normals.push_back(material_.normal_texture ? n : tilted(n, positions, relief_uvs, u, v, step));
        if (!primitive_.tangents.empty()) result_.tangents.push_back(tangents.at(u, v));
        if (!primitive_.colors.empty()) result_.colors.push_back(colors.at(u, v));
        for (const auto& [set, uvs] : primitive_.uvs) {
          if (!uvs.empty()) result_.uvs[set].push_back(corners(uvs, t).at(u, v));
        }
      }
    }
    // Row j holds n - j + 1 points.
    const auto index = [&](int i, int j) {
      return first + static_cast<std::uint32_t>(j * (n_ + 1) - j * (j - 1) / 2 + i);
    };
    for (int j = 0; j < n_; ++j) {
      for (int i = 0; i + j < n_; ++i) {
        result_.triangles.emplace_back(index(i, j), index(i + 1, j), index(i, j + 1));
        if (i + j + 1 < n_) result_.triangles.emplace_back(index(i + 1, j), index(i + 1, j + 1), index(i, j + 1));
      }
    }
  }

  /// The normal of the relief: what a height that changes along the surface makes of `n`. Blinn 1978, "Simulation of
  /// Wrinkled Surfaces".
  vec3 tilted(vec3 n, const Corners<vec3>& positions, const Corners<vec2>& uvs, float u, float v, float step) const {
    const vec3 along_u = positions.b - positions.a, along_v = positions.c - positions.a;
    const float du = (shift(uvs, u + step, v) - shift(uvs, u - step, v)) / (2.0f * step);
    const float dv = (shift(uvs, u, v + step) - shift(uvs, u, v - step)) / (2.0f * step);
    const vec3 across_u = glm::cross(along_v, n), across_v = glm::cross(n, along_u);
    const float area = glm::dot(along_u, across_u);
    if (std::abs(area) < 1e-30f) return n;
    return glm::normalize(n - (du * across_u + dv * across_v) / area);
  }

  const Primitive& primitive_;
  const Material& material_;
  const TextureReader& height_;
  int n_ = 1;
  Primitive result_;
};

}  // namespace

Primitive displaced(const Primitive& primitive, const Material& material, const TextureReader& height) {
  return Relief(primitive, material, height).build(divisions(primitive, material.height_texture, height.size()));
}

int divisions_of(std::size_t before, std::size_t after) {
  return static_cast<int>(std::lround(std::sqrt(static_cast<double>(after) / static_cast<double>(before))));
}

UndividedPlace undivided(const UndividedPlace& divided, int divisions) {
  if (divisions <= 1) return divided;
  const auto n = static_cast<std::uint32_t>(divisions);
  std::uint32_t k = divided.triangle % (n * n), row = 0;
  // As add_triangle() lays them out: a row of upright triangles, with one upside down between every two.
  for (std::uint32_t in_row = 2 * n - 1; k >= in_row; in_row -= 2, ++row) k -= in_row;
  const vec2 corner(k / 2, row), b = divided.barycentric;
  const vec2 along = k % 2 == 0 ? b : vec2(1.0f - b.y, b.x + b.y);
  return {divided.triangle / (n * n), (corner + along) / static_cast<float>(n)};
}

}  // namespace candela::path
