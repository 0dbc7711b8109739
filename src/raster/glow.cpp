#include "raster/glow.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <numeric>
#include <unordered_map>

#include "math/position_hash.h"
#include "shade/color.glsl.h"

namespace candela::raster {

namespace {

constexpr float kFaintest = 0.01f;       // of the brightest triangle: below is what compression left in black
constexpr std::size_t kMostParts = 64;   // of a primitive, by splitting what hangs together
constexpr float kLongest = 2.5f;         // over its width, of a lamp that counts as one
constexpr float kFullest = 0.6f;         // of its rectangle, the same
constexpr int kMostSide = 12;            // points along a triangle's side
constexpr float kTexelsPerPoint = 4.0f;  // along it

int wrapped(int i, int size, Wrap wrap) {
  switch (wrap) {
    case Wrap::repeat:
      return ((i % size) + size) % size;
    case Wrap::clamp_to_edge:
      return std::clamp(i, 0, size - 1);
    case Wrap::mirrored_repeat: {
      const int twice = ((i % (2 * size)) + 2 * size) % (2 * size);
      return twice < size ? twice : 2 * size - 1 - twice;
    }
  }
  return 0;
}

/// One slot's texture on one primitive, by nearest texels.
class Texels {
 public:
  Texels(const Scene& scene, const Primitive& primitive, const TextureSlot& slot) : slot_(slot) {
    if (!slot) return;
    texture_ = &scene.textures[static_cast<std::size_t>(slot.texture)];
    image_ = scene.images[static_cast<std::size_t>(texture_->image)].get();
    // Without a second set the first serves.
    uvs_ = &primitive.uvs[static_cast<std::size_t>(slot.uv_set)];
    if (uvs_->empty()) uvs_ = &primitive.uvs[0];
    if (image_->pixels.empty() || uvs_->empty()) image_ = nullptr;
    for (std::size_t i = 0; i < decoded_.size(); ++i) {
      decoded_[i] = shade::srgb_decode_channel(static_cast<float>(i) / 255.0f);
    }
  }

  explicit operator bool() const { return image_ != nullptr; }

  /// Colour decoded, alpha as it is; white without a texture.
  vec4 at(const uvec3& t, vec3 weights) const {
    if (image_ == nullptr) return vec4(1.0f);
    const vec2 uv = slot_.apply((*uvs_)[t.x] * weights.x + (*uvs_)[t.y] * weights.y + (*uvs_)[t.z] * weights.z);
    const vec2 texel = glm::clamp(glm::floor(uv * vec2(image_->width, image_->height)), vec2(-1e9f), vec2(1e9f));
    const int x = wrapped(static_cast<int>(texel.x), image_->width, texture_->wrap_u);
    const int y = wrapped(static_cast<int>(texel.y), image_->height, texture_->wrap_v);
    const std::size_t first =
        4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image_->width) + static_cast<std::size_t>(x));
    if (image_->bits == 8) {
      const std::uint8_t* p = image_->pixels.data() + first;
      return {decoded_[p[0]], decoded_[p[1]], decoded_[p[2]], static_cast<float>(p[3]) / 255.0f};
    }
    std::array<std::uint16_t, 4> p{};
    std::memcpy(p.data(), image_->pixels.data() + 2 * first, sizeof p);
    vec4 value = vec4(p[0], p[1], p[2], p[3]) / 65535.0f;
    for (int c = 0; c < 3; ++c) value[c] = shade::srgb_decode_channel(value[c]);
    return value;
  }

  /// Texels along the longest side of a triangle.
  float reach(const uvec3& t) const {
    if (image_ == nullptr) return 0.0f;
    const vec2 size(image_->width, image_->height);
    const vec2 a = slot_.apply((*uvs_)[t.x]) * size, b = slot_.apply((*uvs_)[t.y]) * size;
    const vec2 c = slot_.apply((*uvs_)[t.z]) * size;
    return std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
  }

 private:
  TextureSlot slot_;
  const Texture* texture_ = nullptr;
  const TextureImage* image_ = nullptr;
  const std::vector<vec2>* uvs_ = nullptr;
  std::array<float, 256> decoded_{};
};

/// What a triangle sends out from each of its area, and how much of it is there.
struct Glow {
  vec3 emission{0.0f};  ///< times the share
  float share = 1.0f;
  float area = 0.0f;
};

std::vector<Glow> glow_of_triangles(const Scene& scene, const Primitive& primitive, const Material& material) {
  const Texels emissive(scene, primitive, material.emissive_texture);
  const bool has_alpha = material.alpha_mode != AlphaMode::opaque;
  const Texels base(scene, primitive, has_alpha ? material.base_color_texture : TextureSlot{});
  std::vector<Glow> all;
  all.reserve(primitive.triangles.size());
  for (const uvec3& t : primitive.triangles) {
    Glow& glow = all.emplace_back();
    const vec3 a = primitive.positions[t.x];
    glow.area = 0.5f * glm::length(glm::cross(primitive.positions[t.y] - a, primitive.positions[t.z] - a));
    const bool varies = has_alpha && !primitive.colors.empty();
    const float reach = std::max(emissive.reach(t), base.reach(t));
    const int side = std::clamp(static_cast<int>(reach / kTexelsPerPoint) + 1, varies ? 4 : 1, kMostSide);
    vec3 sum(0.0f);
    float there = 0.0f;
    int count = 0;
    for (int i = 0; i < side; ++i) {
      for (int j = 0; i + j < side; ++j, ++count) {
        const vec2 b = (vec2(i, j) + 1.0f / 3.0f) / static_cast<float>(side);
        const vec3 weights(1.0f - b.x - b.y, b.x, b.y);
        float alpha = 1.0f;
        if (has_alpha) {
          alpha = material.opacity * base.at(t, weights).w;
          if (varies) {
            alpha *= glm::dot(weights, vec3(primitive.colors[t.x].w, primitive.colors[t.y].w, primitive.colors[t.z].w));
          }
          if (material.alpha_mode == AlphaMode::mask) alpha = alpha < material.alpha_cutoff ? 0.0f : 1.0f;
        }
        sum += alpha * material.emission * vec3(emissive.at(t, weights));
        there += alpha;
      }
    }
    glow.emission = sum / static_cast<float>(count);
    glow.share = there / static_cast<float>(count);
  }
  return all;
}

/// Numbers of corners, the same for those at one place.
std::vector<std::uint32_t> welded(const Primitive& primitive) {
  std::unordered_map<vec3, std::uint32_t, PositionHash> first;
  first.reserve(primitive.positions.size());
  std::vector<std::uint32_t> corner(primitive.positions.size());
  for (std::uint32_t i = 0; i < corner.size(); ++i) {
    // Zero of either sign is one place.
    corner[i] = first.try_emplace(primitive.positions[i] + 0.0f, i).first->second;
  }
  return corner;
}

/// Of opaque triangles at one place that face the same way, the last, which is the one that is seen.
std::vector<std::uint32_t> without_hidden(const Primitive& primitive, const Material& material,
                                          const std::vector<std::uint32_t>& corner,
                                          const std::vector<std::uint32_t>& lit) {
  if (material.alpha_mode != AlphaMode::opaque) return lit;
  std::map<std::array<std::uint32_t, 3>, std::uint32_t> last;
  for (const std::uint32_t i : lit) {
    const uvec3& t = primitive.triangles[i];
    std::array<std::uint32_t, 3> at{corner[t.x], corner[t.y], corner[t.z]};
    std::rotate(at.begin(), std::min_element(at.begin(), at.end()), at.end());
    if (material.double_sided) std::sort(at.begin(), at.end());
    last[at] = i;
  }
  std::vector<std::uint32_t> seen;
  for (const auto& [at, i] : last) seen.push_back(i);
  std::sort(seen.begin(), seen.end());
  return seen;
}

/// Groups of triangles that share corners, each of which has the number `corner` says.
std::vector<std::vector<std::uint32_t>> connected(const Primitive& primitive, const std::vector<std::uint32_t>& corner,
                                                  const std::vector<std::uint32_t>& lit) {
  std::vector<std::uint32_t> parent(corner.size());
  for (std::uint32_t i = 0; i < parent.size(); ++i) parent[i] = i;
  const auto root = [&](std::uint32_t i) {
    i = corner[i];
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const std::uint32_t t : lit) {
    const uvec3& v = primitive.triangles[t];
    parent[root(v.y)] = root(v.x);
    parent[root(v.z)] = root(v.x);
  }
  std::unordered_map<std::uint32_t, std::size_t> group;
  std::vector<std::vector<std::uint32_t>> groups;
  for (const std::uint32_t t : lit) {
    const auto [entry, is_new] = group.try_emplace(root(primitive.triangles[t].x), groups.size());
    if (is_new) groups.emplace_back();
    groups[entry->second].push_back(t);
  }
  return groups;
}

vec3 middle_of(const Primitive& primitive, std::uint32_t triangle) {
  const uvec3& t = primitive.triangles[triangle];
  return (primitive.positions[t.x] + primitive.positions[t.y] + primitive.positions[t.z]) / 3.0f;
}

/// The axis to part a group along, so that its parts are more compact; -1 where it is compact enough.
int axis_to_part(const Primitive& primitive, const std::vector<std::uint32_t>& group) {
  if (group.size() < 2) return -1;
  Box3 box;
  vec3 facing(0.0f);
  float area = 0.0f;
  for (const std::uint32_t i : group) {
    const uvec3& t = primitive.triangles[i];
    const vec3 a = primitive.positions[t.x], b = primitive.positions[t.y], c = primitive.positions[t.z];
    box.extend(a), box.extend(b), box.extend(c);
    const vec3 twice = glm::cross(b - a, c - a);
    facing += 0.5f * twice;
    area += 0.5f * glm::length(twice);
  }
  const vec3 size = box.size();
  const int longest = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const float second = std::max(size[(longest + 1) % 3], size[(longest + 2) % 3]);
  if (glm::length(facing) > 0.98f * area) {
    // A rectangle says it, however long, unless it has holes. One that leans is as large as its sides along the axes
    // say.
    const vec3 n = glm::abs(glm::normalize(facing));
    const int across = n.x >= n.y && n.x >= n.z ? 0 : n.y >= n.z ? 1 : 2;
    const float rectangle = size[(across + 1) % 3] * size[(across + 2) % 3] / n[across];
    return area < 0.4f * rectangle ? longest : -1;
  }
  return size[longest] > kLongest * second || area < kFullest * (size[longest] * second) ? longest : -1;
}

void part_further(const Primitive& primitive, std::vector<std::vector<std::uint32_t>>& groups) {
  for (std::size_t i = 0; i < groups.size() && groups.size() < kMostParts;) {
    const int axis = axis_to_part(primitive, groups[i]);
    if (axis < 0) {
      ++i;
      continue;
    }
    Box3 box;
    for (const std::uint32_t t : groups[i]) box.extend(middle_of(primitive, t));
    const float half = box.center()[axis];
    const auto end = std::stable_partition(groups[i].begin(), groups[i].end(),
                                           [&](std::uint32_t t) { return middle_of(primitive, t)[axis] < half; });
    if (end == groups[i].begin() || end == groups[i].end()) {
      ++i;
      continue;
    }
    groups.emplace_back(end, groups[i].end());
    groups[i].erase(end, groups[i].end());
  }
}

}  // namespace

std::vector<GlowingPart> glowing_parts(const Scene& scene, const Primitive& primitive, const Material& material) {
  if (max_component(material.emission) <= 0.0f || material.unlit) return {};
  const std::vector<Glow> glow = glow_of_triangles(scene, primitive, material);
  float brightest = 0.0f;
  for (const Glow& g : glow) brightest = std::max(brightest, luminance(g.emission));
  std::vector<std::uint32_t> lit;
  for (std::uint32_t i = 0; i < glow.size(); ++i) {
    if (glow[i].area > 0.0f && luminance(glow[i].emission) >= kFaintest * brightest) lit.push_back(i);
  }
  if (brightest <= 0.0f || lit.empty()) return {};
  const std::vector<std::uint32_t> corner = welded(primitive);
  lit = without_hidden(primitive, material, corner, lit);
  std::vector<std::vector<std::uint32_t>> groups = connected(primitive, corner, lit);
  part_further(primitive, groups);
  std::vector<GlowingPart> parts;
  for (std::vector<std::uint32_t>& group : groups) {
    GlowingPart part;
    float area = 0.0f, there = 0.0f;
    for (const std::uint32_t i : group) {
      area += glow[i].area;
      there += glow[i].area * glow[i].share;
      part.emission += glow[i].area * glow[i].emission;
    }
    part.emission /= there;
    part.share = there / area;
    part.triangles = std::move(group);
    parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace candela::raster
