#include "path/origin.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace candela::path {

namespace {

float upper_median(std::vector<float> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Box3 box_of(const Mesh& mesh) {
  Box3 box;
  for (const Primitive& primitive : mesh.primitives) {
    for (const vec3 p : primitive.positions) box.extend(p);
  }
  return box;
}

/// What a node shows, as a ball.
struct Ball {
  vec3 center;
  float radius;
};

std::vector<Ball> balls_of(const Scene& scene) {
  std::vector<Box3> boxes;
  for (const Mesh& mesh : scene.meshes) boxes.push_back(box_of(mesh));
  std::vector<Ball> balls;
  for (const Node& node : scene.nodes) {
    if (node.mesh < 0) continue;
    const Box3& box = boxes[static_cast<std::size_t>(node.mesh)];
    if (box.empty()) continue;
    const mat4& m = node.world_from_node;
    const vec3 half = 0.5f * box.size();
    const vec3 reach = glm::abs(vec3(m[0])) * half.x + glm::abs(vec3(m[1])) * half.y + glm::abs(vec3(m[2])) * half.z;
    const Ball ball{transform_point(m, box.center()), glm::length(reach)};
    if (is_finite(ball.center) && std::isfinite(ball.radius)) balls.push_back(ball);
  }
  return balls;
}

}  // namespace

vec3 tracing_origin(const Scene& scene) {
  constexpr float kNear = 64.0f;  // metres
  constexpr float kFar = 16.0f;   // times the scene's size
  const std::vector<Ball> balls = balls_of(scene);
  if (balls.empty()) return vec3(0.0f);
  // Medians, so that what stands far from the rest does not count.
  vec3 middle;
  std::vector<float> values(balls.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::transform(balls.begin(), balls.end(), values.begin(), [axis](const Ball& b) { return b.center[axis]; });
    middle[axis] = upper_median(values);
  }
  std::transform(balls.begin(), balls.end(), values.begin(),
                 [middle](const Ball& b) { return glm::distance(b.center, middle) + b.radius; });
  const float farthest = max_component(glm::abs(middle));
  const bool is_far = farthest > kNear && farthest > kFar * upper_median(values);
  return is_far ? glm::round(middle) : vec3(0.0f);
}

View relative(View view, vec3 origin) {
  view.world_from_camera[3] -= vec4(origin, 0.0f);
  return view;
}

}  // namespace candela::path
