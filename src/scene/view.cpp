#include "scene/view.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "base/error.h"
#include "shade/diffuse.glsl.h"

namespace candela {
namespace {

constexpr float kSensorHeight = 0.024f;

mat4 rigid(vec3 right, vec3 up, vec3 back, vec3 eye) {
  return mat4(vec4(right, 0.0f), vec4(up, 0.0f), vec4(back, 0.0f), vec4(eye, 1.0f));
}

/// The rotation of `m` without its scale and shear; the viewing axis is kept exactly, then the up axis.
mat4 without_scale(const mat4& m, const std::string& where) {
  const vec3 back = vec3(m[2]);
  const vec3 up = vec3(m[1]);
  const float back_length = glm::length(back);
  const vec3 right = glm::cross(up, back);
  const float right_length = glm::length(right);
  if (!(back_length > 0.0f) || !(right_length > 0.0f) || !is_finite(right) || !is_finite(vec3(m[3])))
    throw Error("the camera's transform is singular", where);
  const vec3 z = back / back_length;
  const vec3 x = right / right_length;
  return rigid(x, glm::cross(z, x), z, vec3(m[3]));
}

PerspectiveCamera fit(PerspectiveCamera camera, float aspect) {
  // glTF 2.0 § 3.10.3: a viewport of another shape must not crop, so a narrower picture keeps the horizontal angle.
  if (camera.aspect_ratio && aspect < *camera.aspect_ratio)
    camera.yfov = 2.0f * std::atan(std::tan(0.5f * camera.yfov) * *camera.aspect_ratio / aspect);
  camera.aspect_ratio = aspect;
  return camera;
}

OrthographicCamera fit(OrthographicCamera camera, float aspect) {
  const float xmag = std::abs(camera.xmag);
  const float ymag = std::abs(camera.ymag);
  return {.xmag = std::max(xmag, ymag * aspect), .ymag = std::max(ymag, xmag / aspect)};
}

std::string camera_list(const Scene& scene) {
  std::string text;
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
    text += (i == 0 ? "" : ", ") + std::to_string(number_of(scene.cameras, i));
    if (!scene.cameras[i].name.empty()) text += " \"" + scene.cameras[i].name + "\"";
    for (const Node& node : scene.nodes)
      if (node.camera == static_cast<int>(i) && !node.name.empty() && node.name != scene.cameras[i].name)
        text += " (node \"" + node.name + "\")";
  }
  return text;
}

/// The node that `wanted` means; a number wins over a name, the first match over later ones.
const Node* find_camera_node(const Scene& scene, const std::string& wanted) {
  int index = -1;
  const char* const end = wanted.data() + wanted.size();
  const auto parsed = std::from_chars(wanted.data(), end, index);
  const bool is_index = parsed.ec == std::errc() && parsed.ptr == end && index >= 0;
  for (const Node& node : scene.nodes) {
    const bool has_camera = node.camera >= 0;
    if (has_camera && is_index && number_of(scene.cameras, static_cast<std::size_t>(node.camera)) == index)
      return &node;
  }
  for (const Node& node : scene.nodes) {
    if (node.camera < 0) continue;
    if (scene.cameras[static_cast<std::size_t>(node.camera)].name == wanted || node.name == wanted) return &node;
  }
  return nullptr;
}

}  // namespace

View look_at(vec3 eye, vec3 target, float yfov) {
  const vec3 offset = eye - target;
  const float distance = glm::length(offset);
  if (!(distance > 0.0f) || !std::isfinite(distance)) throw Error("the camera stands at its own target");
  const vec3 back = offset / distance;
  // Looking straight up or down: the picture's top is -z or +z, where an orbit at azimuth 0 arrives.
  const bool vertical = std::abs(back.y) > 0.99999f;
  const vec3 reference = vertical ? vec3(0.0f, 0.0f, back.y > 0.0f ? -1.0f : 1.0f) : vec3(0.0f, 1.0f, 0.0f);
  const vec3 right = glm::normalize(glm::cross(reference, back));

  View view;
  view.world_from_camera = rigid(right, glm::cross(back, right), back, eye);
  view.projection = PerspectiveCamera{.yfov = yfov, .aspect_ratio = {}};
  view.lens.focus_distance = distance;
  return view;
}

float start_of_rays(const View& view) {
  constexpr float kHair = 0x1p-21f;  // of coordinates: some roundings
  if (view.near_plane <= 0.0f) return 0.0f;
  const vec3 eye(view.world_from_camera[3]);
  const float start = view.near_plane + kHair * (max_component(glm::abs(eye)) + view.near_plane);
  return std::min(start, 0.5f * (view.near_plane + view.far_plane));
}

View scene_camera(const Scene& scene, const std::string& number_or_name, float aspect) {
  const Node* const node = find_camera_node(scene, number_or_name);
  if (node == nullptr) {
    throw Error(scene.cameras.empty() ? "the scene has no camera, so none is called \"" + number_or_name + "\""
                                      : "no camera \"" + number_or_name + "\" (known: " + camera_list(scene) + ")");
  }
  return scene_camera(scene, *node, aspect);
}

View scene_camera(const Scene& scene, const Node& node, float aspect) {
  const Camera& camera = scene.cameras[static_cast<std::size_t>(node.camera)];

  View view;
  view.world_from_camera = without_scale(node.world_from_node, node.name.empty() ? camera.name : node.name);
  using Projection = std::variant<PerspectiveCamera, OrthographicCamera>;
  view.projection = std::visit([&](const auto& p) -> Projection { return fit(p, aspect); }, camera.projection);
  view.near_plane = camera.near_plane;
  view.far_plane = camera.far_plane;
  if (camera.focus_distance > 0.0f) {
    view.lens.focus_distance = camera.focus_distance;
  } else if (const Box3 bounds = world_bounds(scene); !bounds.empty()) {
    const vec3 to_subject = bounds.center() - vec3(view.world_from_camera[3]);
    const float depth = -glm::dot(to_subject, vec3(view.world_from_camera[2]));
    if (depth > 0.0f) view.lens.focus_distance = depth;
  }
  if (const auto* perspective = std::get_if<PerspectiveCamera>(&camera.projection);
      perspective != nullptr && camera.f_number > 0.0f)
    view.lens.radius = camera.focal_length > 0.0f ? 0.5f * camera.focal_length / camera.f_number
                                                  : aperture_radius(camera.f_number, perspective->yfov);
  return view;
}

float aperture_radius(float f_number, float yfov) {
  if (!(f_number > 0.0f)) throw Error("an f-number is above 0");
  const float focal_length = 0.5f * kSensorHeight / std::tan(0.5f * yfov);
  return 0.5f * focal_length / f_number;
}

vec2 sample_aperture(const Lens& lens, vec2 u) {
  if (lens.blades < 3) {
    const vec3 d = shade::cosine_sample({u.x, u.y});  // its x and y are uniform on the disc
    return {d.x, d.y};
  }
  // A regular polygon: choose one of its triangles, then a point in it (u.x serves twice).
  const float corners = static_cast<float>(lens.blades);
  const float corner = std::floor(u.x * corners);
  const float step = 2.0f * kPi / corners;
  const float r = std::sqrt(u.x * corners - corner);
  const vec2 a(std::cos(step * corner), std::sin(step * corner));
  const vec2 b(std::cos(step * (corner + 1.0f)), std::sin(step * (corner + 1.0f)));
  return r * ((1.0f - u.y) * a + u.y * b);
}

}  // namespace candela
