#include "scene/view.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "base/error.h"

namespace candela {
namespace {

/// The subject touches this part of the picture's half-size where it is tightest.
constexpr float kFill = 0.92f;
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
    text += (i == 0 ? "" : ", ") + std::to_string(i);
    if (!scene.cameras[i].name.empty()) text += " \"" + scene.cameras[i].name + "\"";
    for (const Node& node : scene.nodes)
      if (node.camera == static_cast<int>(i) && !node.name.empty() && node.name != scene.cameras[i].name)
        text += " (node \"" + node.name + "\")";
  }
  return text;
}

/// The node that `wanted` means; an index wins over a name, the first match over later ones.
const Node* find_camera_node(const Scene& scene, const std::string& wanted) {
  int index = -1;
  const char* const end = wanted.data() + wanted.size();
  const auto parsed = std::from_chars(wanted.data(), end, index);
  const bool is_index = parsed.ec == std::errc() && parsed.ptr == end && index >= 0;
  for (const Node& node : scene.nodes)
    if (node.camera >= 0 && is_index && node.camera == index) return &node;
  for (const Node& node : scene.nodes) {
    if (node.camera < 0) continue;
    if (scene.cameras[static_cast<std::size_t>(node.camera)].name == wanted || node.name == wanted) return &node;
  }
  return nullptr;
}

}  // namespace

View frame_box(const Box3& box, float aspect, float yfov, const Orbit& orbit) {
  const Box3 shown = box.empty() ? Box3{vec3(-0.5f), vec3(0.5f)} : box;
  const vec3 center = shown.center();
  // A subject without extent still needs a place to be seen from.
  const vec3 half_size = glm::max(0.5f * shown.size(), vec3(1e-5f + 1e-5f * glm::length(center)));

  const float ca = std::cos(orbit.azimuth), sa = std::sin(orbit.azimuth);
  const float ce = std::cos(orbit.elevation), se = std::sin(orbit.elevation);
  const vec3 back(sa * ce, se, ca * ce);
  const vec3 right(ca, 0.0f, -sa);
  const vec3 up = glm::cross(back, right);

  // A corner p is inside when |dot(p - eye, right)| <= k (distance - dot(p, back)); likewise for `up`. Each side of the
  // frame bounds the distance and the sideways shift of the camera linearly, so the tightest view has a closed form.
  const float tan_y = std::tan(0.5f * yfov);
  const float ky = kFill * tan_y, kx = ky * aspect;
  float most_right = -kInfinity, most_left = -kInfinity, most_up = -kInfinity, most_down = -kInfinity;
  float nearest = -kInfinity;
  for (int corner = 0; corner < 8; ++corner) {
    const vec3 p = half_size * vec3(corner & 1 ? 1.0f : -1.0f, corner & 2 ? 1.0f : -1.0f, corner & 4 ? 1.0f : -1.0f);
    const float x = glm::dot(p, right), y = glm::dot(p, up), z = glm::dot(p, back);
    most_right = std::max(most_right, x + kx * z);
    most_left = std::max(most_left, -x + kx * z);
    most_up = std::max(most_up, y + ky * z);
    most_down = std::max(most_down, -y + ky * z);
    nearest = std::max(nearest, z);
  }
  const float fitting = std::max((most_right + most_left) / (2.0f * kx), (most_up + most_down) / (2.0f * ky));
  const float distance = std::max(fitting, nearest + 1e-3f * glm::length(half_size)) * orbit.distance_scale;
  const vec3 shift = 0.5f * (most_right - most_left) * right + 0.5f * (most_up - most_down) * up;

  View view;
  view.world_from_camera = rigid(right, up, back, center + shift + distance * back);
  view.projection = PerspectiveCamera{.yfov = yfov, .aspect_ratio = aspect};
  view.lens.focus_distance = distance;
  return view;
}

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

View scene_camera(const Scene& scene, const std::string& index_or_name, float aspect) {
  const Node* const node = find_camera_node(scene, index_or_name);
  if (node == nullptr) {
    throw Error(scene.cameras.empty() ? "the scene has no camera, so none is called \"" + index_or_name + "\""
                                      : "no camera \"" + index_or_name + "\"; there are " + camera_list(scene));
  }
  const Camera& camera = scene.cameras[static_cast<std::size_t>(node->camera)];

  View view;
  view.world_from_camera = without_scale(node->world_from_node, node->name.empty() ? camera.name : node->name);
  view.projection =
      std::visit([&](const auto& p) -> decltype(view.projection) { return fit(p, aspect); }, camera.projection);
  if (camera.focus_distance > 0.0f) {
    view.lens.focus_distance = camera.focus_distance;
  } else if (const Box3 bounds = world_bounds(scene); !bounds.empty()) {
    const vec3 to_subject = bounds.center() - vec3(view.world_from_camera[3]);
    const float depth = -glm::dot(to_subject, vec3(view.world_from_camera[2]));
    if (depth > 0.0f) view.lens.focus_distance = depth;
  }
  if (const auto* perspective = std::get_if<PerspectiveCamera>(&camera.projection);
      perspective != nullptr && camera.f_number > 0.0f)
    view.lens.radius = aperture_radius(camera.f_number, perspective->yfov);
  return view;
}

float aperture_radius(float f_number, float yfov) {
  if (!(f_number > 0.0f)) throw Error("an f-number is above 0");
  const float focal_length = 0.5f * kSensorHeight / std::tan(0.5f * yfov);
  return 0.5f * focal_length / f_number;
}

}  // namespace candela
