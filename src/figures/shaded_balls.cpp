#include "figures/shaded_balls.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "figures/figure.h"
#include "scene/surface_params.h"

namespace candela::figures {

Image shaded_balls(const std::vector<Material>& materials, int side, const ShadePoint& shade_point) {
  constexpr int kFine = 3;  // points per pixel and axis
  const int count = static_cast<int>(materials.size());
  Image image(side * count, side, 4);
  const mat3 world_from_camera(sphere_view(1).world_from_camera);
  parallel_for(0, static_cast<std::size_t>(side), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      const int y = static_cast<int>(row);
      for (int x = 0; x < image.width; ++x) {
        const auto ball = static_cast<std::size_t>(x / side);
        const shade::SurfaceParams params = surface_params(materials[ball], shade::shading_model_candela());
        vec4 sum(0.0f);
        for (int k = 0; k < kFine * kFine; ++k) {
          const ivec2 fine(k % kFine, k / kFine);
          const vec2 at(static_cast<float>(x % side) + (static_cast<float>(fine.x) + 0.5f) / kFine,
                        static_cast<float>(y) + (static_cast<float>(fine.y) + 0.5f) / kFine);
          vec2 p = (2.0f * at / static_cast<float>(side) - 1.0f) * (0.5f * kSphereSpacing);
          p.y = -p.y;
          const float r2 = glm::dot(p, p);
          if (r2 >= 1.0f) continue;
          const float mu = std::sqrt(1.0f - r2);
          const vec3 n(p, mu), wo(std::sqrt(std::max(1.0f - mu * mu, 0.0f)), 0.0f, mu);
          const vec3 mirrored = shade::microfacet_reflect(vec3(0, 0, 1), n);
          sum += vec4(shade_point({ball, shade::surface_prepare(params, wo), wo, world_from_camera * n,
                                   glm::normalize(world_from_camera * mirrored), world_from_camera * vec3(0, 0, 1)}),
                      1.0f);
        }
        sum /= static_cast<float>(kFine * kFine);
        for (int c = 0; c < 4; ++c) image.at(x, y)[static_cast<std::size_t>(c)] = sum[c];
      }
    }
  });
  return image;
}

vec3 ball_direction(vec3 seen) { return glm::normalize(mat3(sphere_view(1).world_from_camera) * seen); }

}  // namespace candela::figures
