#pragma once

#include <cstdint>
#include <vector>

#include "math/distribution.h"
#include "scene/scene.h"

namespace candela::check {

/// A point of a surface, before any transform.
struct SurfaceSample {
  const Primitive* primitive = nullptr;
  uvec3 triangle{0};
  vec3 barycentric{0.0f};

  vec2 uv(int set) const;  ///< authored; (0, 0) where the primitive has no such set
  vec4 color() const;      ///< of the vertices, white where there is none
  /// Whether the vertices' normal looks to the back of the facet, as its winding gives it.
  bool is_normal_turned() const;
};

/// Everything that wears one material, as points spread over it by area.
class MaterialSurface {
 public:
  /// A primitive that wears it, and how much more area the primitive's instances have than itself.
  struct Part {
    const Primitive* primitive;
    double scale;
  };
  explicit MaterialSurface(const std::vector<Part>& parts);

  bool empty() const { return faces_.empty(); }
  double area() const { return area_; }  ///< m² in the world
  /// Point `index` of a (0,2)-sequence; any first 2ⁿ points are evenly spread.
  SurfaceSample sample(std::uint32_t index) const;

 private:
  struct Face {
    const Primitive* primitive;
    std::uint32_t triangle;
  };
  std::vector<Face> faces_;
  Distribution1D by_area_;
  double area_ = 0.0;
};

/// How many times larger areas are after a transform: exact for similarities.
double area_scale(const mat4& world_from_node);

/// One per material of the scene.
std::vector<MaterialSurface> material_surfaces(const Scene& scene);

/// How many points to look at on each material: 4096, fewer where there are very many materials.
std::uint32_t samples_per_material(std::size_t materials);

/// Stored texels of a texture, without filter or decoding.
class TexelGrid {
 public:
  TexelGrid(const Scene& scene, int texture);

  ivec2 size() const { return size_; }
  /// The texel that an authored uv falls into by way of `slot`.
  ivec2 texel_at(const TextureSlot& slot, vec2 uv) const;
  /// RGB in [0, 1] as stored; coordinates outside wrap as the sampler says.
  vec3 rgb(ivec2 texel) const;

 private:
  const TextureImage& image_;
  ivec2 size_;
  Wrap wrap_u_, wrap_v_;
};

}  // namespace candela::check
