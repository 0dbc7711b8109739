#include "check/check_samples.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "math/sobol.h"

namespace candela::check {

namespace {

float triangle_area(const Primitive& p, const uvec3& t) {
  return 0.5f * glm::length(glm::cross(p.positions[t.y] - p.positions[t.x], p.positions[t.z] - p.positions[t.x]));
}

int wrap_texel(int i, int size, Wrap wrap) {
  if (wrap == Wrap::clamp_to_edge) return std::clamp(i, 0, size - 1);
  const int period = wrap == Wrap::repeat ? size : 2 * size;
  const int m = ((i % period) + period) % period;
  return m < size ? m : period - 1 - m;
}

}  // namespace

double area_scale(const mat4& world_from_node) {
  constexpr double kLargest = 1e30;  // still a float after a multiplication by the area of a mesh of some metres
  const glm::dmat3 linear(world_from_node);
  return std::min(std::pow(std::fabs(glm::determinant(linear)), 2.0 / 3.0), kLargest);
}

vec2 SurfaceSample::uv(int set) const {
  const std::vector<vec2>& uvs = primitive->uvs[static_cast<std::size_t>(set)];
  if (uvs.empty()) return vec2(0.0f);
  return uvs[triangle.x] * barycentric.x + uvs[triangle.y] * barycentric.y + uvs[triangle.z] * barycentric.z;
}

vec4 SurfaceSample::color() const {
  const std::vector<vec4>& c = primitive->colors;
  if (c.empty()) return vec4(1.0f);
  return c[triangle.x] * barycentric.x + c[triangle.y] * barycentric.y + c[triangle.z] * barycentric.z;
}

bool SurfaceSample::is_normal_turned() const {
  const std::vector<vec3>& p = primitive->positions;
  const std::vector<vec3>& n = primitive->normals;
  const dvec3 facet =
      glm::cross(dvec3(p[triangle.y]) - dvec3(p[triangle.x]), dvec3(p[triangle.z]) - dvec3(p[triangle.x]));
  const vec3 smooth = n[triangle.x] * barycentric.x + n[triangle.y] * barycentric.y + n[triangle.z] * barycentric.z;
  return glm::dot(facet, dvec3(smooth)) < 0.0;
}

MaterialSurface::MaterialSurface(const std::vector<Part>& parts) {
  constexpr float kMost = 1e30f;  // sums of them stay finite
  std::vector<float> weights;
  for (const auto& [primitive, scale] : parts) {
    for (std::size_t t = 0; t < primitive->triangles.size(); ++t) {
      faces_.push_back({primitive, static_cast<std::uint32_t>(t)});
      weights.push_back(
          std::min(static_cast<float>(scale) * triangle_area(*primitive, primitive->triangles[t]), kMost));
    }
  }
  if (faces_.empty()) return;
  by_area_ = Distribution1D(weights);
  area_ = by_area_.total();
}

SurfaceSample MaterialSurface::sample(std::uint32_t index) const {
  constexpr std::uint32_t kSeed = 0x63616e64;
  const vec2 u = SobolSampler(kSeed, index).next_2d();
  const Distribution1D::Sample chosen = by_area_.sample(u.x);
  const Face& face = faces_[static_cast<std::size_t>(chosen.index)];
  // Turk 1990, "Generating Random Points in Triangles", Graphics Gems.
  const float s = std::sqrt(chosen.u);
  return {face.primitive, face.primitive->triangles[face.triangle], {1.0f - s, s * (1.0f - u.y), s * u.y}};
}

std::vector<MaterialSurface> material_surfaces(const Scene& scene) {
  std::vector<double> scale(scene.meshes.size(), 0.0);
  for (const Node& node : scene.nodes) {
    if (node.mesh >= 0) scale[static_cast<std::size_t>(node.mesh)] += area_scale(node.world_from_node);
  }
  std::vector<std::vector<MaterialSurface::Part>> parts(scene.materials.size());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    if (scale[m] <= 0.0) continue;
    for (const Primitive& primitive : scene.meshes[m].primitives) {
      parts[static_cast<std::size_t>(primitive.material)].push_back({&primitive, scale[m]});
    }
  }
  std::vector<MaterialSurface> result;
  result.reserve(parts.size());
  for (const auto& of_material : parts) result.emplace_back(of_material);
  return result;
}

std::uint32_t samples_per_material(std::size_t materials) {
  constexpr std::size_t kMost = 4096;
  constexpr std::size_t kLeast = 256;
  constexpr std::size_t kBudget = std::size_t{1} << 22;
  return static_cast<std::uint32_t>(std::clamp(kBudget / std::max<std::size_t>(materials, 1), kLeast, kMost));
}

TexelGrid::TexelGrid(const Scene& scene, int texture)
    : image_(*scene.images[static_cast<std::size_t>(scene.textures[static_cast<std::size_t>(texture)].image)]),
      size_(image_.width, image_.height),
      wrap_u_(scene.textures[static_cast<std::size_t>(texture)].wrap_u),
      wrap_v_(scene.textures[static_cast<std::size_t>(texture)].wrap_v) {}

ivec2 TexelGrid::texel_at(const TextureSlot& slot, vec2 uv) const {
  const vec2 at = slot.apply(uv) * vec2(size_);
  // Beyond this a float has no texels to tell apart; the loader keeps coordinates far below.
  constexpr float kLargest = 1e9f;
  const vec2 held = glm::clamp(glm::floor(at), vec2(-kLargest), vec2(kLargest));
  return {wrap_texel(static_cast<int>(held.x), size_.x, wrap_u_),
          wrap_texel(static_cast<int>(held.y), size_.y, wrap_v_)};
}

vec3 TexelGrid::rgb(ivec2 texel) const {
  const auto x = static_cast<std::size_t>(wrap_texel(texel.x, size_.x, wrap_u_));
  const auto y = static_cast<std::size_t>(wrap_texel(texel.y, size_.y, wrap_v_));
  const std::size_t offset = (y * static_cast<std::size_t>(size_.x) + x) * 4;
  if (image_.bits == 16) {
    std::uint16_t p[3];
    std::memcpy(p, image_.pixels.data() + offset * 2, sizeof p);
    return vec3(p[0], p[1], p[2]) / 65535.0f;
  }
  const std::uint8_t* p = image_.pixels.data() + offset;
  return vec3(p[0], p[1], p[2]) / 255.0f;
}

}  // namespace candela::check
