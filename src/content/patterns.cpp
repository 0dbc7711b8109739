#include "content/patterns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include "base/parallel.h"
#include "math/hash.h"

namespace candela::content {
namespace {

int wrap(int i, int period) {
  const int m = i % period;
  return m < 0 ? m + period : m;
}

std::uint32_t hash_cell(int x, int y, ivec2 period, std::uint32_t seed) {
  return hash(static_cast<std::uint32_t>(wrap(x, period.x)) +
              hash(static_cast<std::uint32_t>(wrap(y, period.y)) + hash(seed)));
}

float unit_float(std::uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; }

/// Unit gradients, evenly around the circle; many enough that no direction stands out.
constexpr std::size_t kGradients = 64;
const std::array<vec2, kGradients>& gradients() {
  static const std::array<vec2, kGradients> table = [] {
    std::array<vec2, kGradients> directions;
    for (std::size_t i = 0; i < kGradients; ++i) {
      const float angle = 2.0f * kPi * static_cast<float>(i) / static_cast<float>(kGradients);
      directions[i] = vec2(std::cos(angle), std::sin(angle));
    }
    return directions;
  }();
  return table;
}

float fade(float t) { return t * t * t * (t * (6.0f * t - 15.0f) + 10.0f); }

/// Calls visit(point, id) for the scattered points of the 3×3 cells around p.
template <class F>
void for_scattered_points(vec2 p, ivec2 period, std::uint32_t seed, const F& visit) {
  const vec2 base = glm::floor(p);
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const int x = static_cast<int>(base.x) + dx, y = static_cast<int>(base.y) + dy;
      const std::uint32_t id = hash_cell(x, y, period, seed);
      visit(vec2(static_cast<float>(x), static_cast<float>(y)) + vec2(0.1f) +
                0.8f * vec2(unit_float(hash(id)), unit_float(hash(id + 1))),
            id);
    }
  }
}

float encode_srgb(float linear) {
  const float x = std::clamp(linear, 0.0f, 1.0f);
  return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1.0f / 2.4f) - 0.055f;
}

std::uint8_t to_byte(float x) { return static_cast<std::uint8_t>(std::clamp(x, 0.0f, 1.0f) * 255.0f + 0.5f); }

template <class F>
TexturePointer make_texture(int size, int bits, const F& write_texel) {
  auto image = std::make_shared<TextureImage>();
  image->width = image->height = size;
  image->bits = bits;
  const std::size_t texel_bytes = static_cast<std::size_t>(bits) / 2;
  const auto count = static_cast<std::size_t>(size);
  image->pixels.resize(count * count * texel_bytes);
  parallel_for(0, count, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) {
      for (std::size_t x = 0; x < count; ++x) {
        const vec2 uv = (vec2(static_cast<float>(x), static_cast<float>(y)) + 0.5f) / static_cast<float>(size);
        write_texel(uv, image->pixels.data() + (y * count + x) * texel_bytes);
      }
    }
  });
  return image;
}

}  // namespace

float tiling_noise(vec2 p, ivec2 period, std::uint32_t seed) {
  const vec2 cell = glm::floor(p), f = p - cell;
  const int x = static_cast<int>(cell.x), y = static_cast<int>(cell.y);
  const auto& directions = gradients();
  const auto corner = [&](int dx, int dy) {
    const vec2 offset = f - vec2(static_cast<float>(dx), static_cast<float>(dy));
    return glm::dot(directions[hash_cell(x + dx, y + dy, period, seed) % kGradients], offset);
  };
  const float u = fade(f.x), v = fade(f.y);
  // Gradient noise of unit gradients stays within ±√½.
  return 1.41421356f * glm::mix(glm::mix(corner(0, 0), corner(1, 0), u), glm::mix(corner(0, 1), corner(1, 1), u), v);
}

float tiling_fractal(vec2 p, ivec2 period, int octaves, float gain, std::uint32_t seed) {
  float sum = 0.0f, weight = 1.0f, total = 0.0f;
  for (int i = 0; i < octaves; ++i) {
    sum += weight * tiling_noise(p, period, seed + static_cast<std::uint32_t>(i));
    total += weight;
    weight *= gain;
    p *= 2.0f;
    period *= 2;
  }
  return sum / total;
}

Cells tiling_cells(vec2 p, ivec2 period, std::uint32_t seed) {
  Cells cells{.nearest = kInfinity, .second = kInfinity};
  for_scattered_points(p, period, seed, [&](vec2 point, std::uint32_t id) {
    const float distance = glm::length(p - point);
    if (distance < cells.nearest) {
      cells.second = cells.nearest;
      cells.nearest = distance;
      cells.cell = id;
    } else {
      cells.second = std::min(cells.second, distance);
    }
  });
  return cells;
}

float tiling_dents(vec2 p, ivec2 period, float sharpness, std::uint32_t seed) {
  float sum = 0.0f;
  for_scattered_points(p, period, seed, [&](vec2 point, std::uint32_t) {
    sum += std::exp(-sharpness * glm::dot(p - point, p - point));
  });
  return -std::log(std::max(sum, 1e-30f)) / sharpness;
}

TexturePointer color_texture(int size, const std::function<vec3(vec2 uv)>& color) {
  return make_texture(size, 8, [&](vec2 uv, std::uint8_t* texel) {
    const vec3 c = color(uv);
    for (int k = 0; k < 3; ++k) texel[k] = to_byte(encode_srgb(c[k]));
    texel[3] = 255;
  });
}

TexturePointer cutout_texture(int size, const std::function<vec4(vec2 uv)>& color) {
  auto image = std::make_shared<TextureImage>(*make_texture(size, 8, [&](vec2 uv, std::uint8_t* texel) {
    const vec4 c = color(uv);
    for (int k = 0; k < 3; ++k) texel[k] = to_byte(encode_srgb(c[k]));
    texel[3] = to_byte(c.w);
  }));
  image->has_alpha = true;
  return image;
}

TexturePointer roughness_texture(int size, const std::function<vec2(vec2 uv)>& roughness_metallic) {
  return make_texture(size, 8, [&](vec2 uv, std::uint8_t* texel) {
    const vec2 value = roughness_metallic(uv);
    texel[0] = 255;
    texel[1] = to_byte(value.x);
    texel[2] = to_byte(value.y);
    texel[3] = 255;
  });
}

TexturePointer height_texture(int size, const std::function<float(vec2 uv)>& height) {
  return make_texture(size, 16, [&](vec2 uv, std::uint8_t* texel) {
    const auto value = static_cast<std::uint16_t>(std::clamp(height(uv), 0.0f, 1.0f) * 65535.0f + 0.5f);
    const std::uint16_t values[4] = {value, value, value, 65535};
    std::memcpy(texel, values, sizeof values);
  });
}

TexturePointer normal_texture(int size, const std::function<float(vec2 uv)>& height) {
  const auto count = static_cast<std::size_t>(size);
  std::vector<float> heights(count * count);
  parallel_for(0, count, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y)
      for (std::size_t x = 0; x < count; ++x)
        heights[y * count + x] =
            height((vec2(static_cast<float>(x), static_cast<float>(y)) + 0.5f) / static_cast<float>(size));
  });
  return make_texture(size, 16, [&](vec2 uv, std::uint8_t* texel) {
    const auto x = static_cast<std::size_t>(uv.x * static_cast<float>(size));
    const auto y = static_cast<std::size_t>(uv.y * static_cast<float>(size));
    const std::size_t left = (x + count - 1) % count, right = (x + 1) % count;
    const std::size_t above = (y + count - 1) % count, below = (y + 1) % count;
    const float scale = 0.5f * static_cast<float>(size);
    const float dx = scale * (heights[y * count + right] - heights[y * count + left]);
    const float dy = scale * (heights[below * count + x] - heights[above * count + x]);
    // +Y of a glTF normal texture is up, v runs down.
    const vec3 normal = glm::normalize(vec3(-dx, dy, 1.0f));
    std::uint16_t values[4];
    for (int k = 0; k < 3; ++k) values[k] = static_cast<std::uint16_t>((0.5f + 0.5f * normal[k]) * 65535.0f + 0.5f);
    values[3] = 65535;
    std::memcpy(texel, values, sizeof values);
  });
}

vec3 srgb(std::uint32_t hex) {
  vec3 linear;
  for (int k = 0; k < 3; ++k) {
    const float c = static_cast<float>((hex >> (16 - 8 * k)) & 0xffu) / 255.0f;
    linear[k] = c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
  }
  return linear;
}

}  // namespace candela::content
