#include "viewer/camera_control.h"

#include <algorithm>
#include <cmath>
#include <variant>

namespace candela::viewer {

namespace {

constexpr float kStepsPerOctave = 5.0f;  // of the wheel, until what is seen is twice as large
constexpr float kSteepest = 1.55f;       // radians

vec3 eye_of(const View& view) { return vec3(view.world_from_camera[3]); }
vec3 back_of(const View& view) { return glm::normalize(vec3(view.world_from_camera[2])); }
/// Of the direction from the pivot to the eye, above the horizon.
float elevation_of(vec3 back) { return std::asin(std::clamp(back.y, -1.0f, 1.0f)); }

mat4 turned_about(const mat4& world_from_camera, vec3 center, vec3 axis, float angle) {
  const mat4 there = glm::translate(mat4(1.0f), center);
  return there * glm::rotate(mat4(1.0f), angle, axis) * glm::translate(mat4(1.0f), -center) * world_from_camera;
}

}  // namespace

void CameraControl::set(const View& view, vec3 center) {
  view_ = view;
  const float along = glm::dot(eye_of(view) - center, back_of(view));
  // A subject behind the camera is nothing to turn about: then it looks around nearby.
  pivot_ = eye_of(view) - back_of(view) * (along > 0.0f ? along : 1.0f);
}

float CameraControl::distance() const { return glm::length(eye_of(view_) - pivot_); }

void CameraControl::orbit(vec2 angles) {
  const float elevation = elevation_of(back_of(view_));
  const float wanted = std::clamp(elevation + angles.y, -kSteepest, kSteepest);
  const vec3 right = glm::normalize(vec3(view_.world_from_camera[0]));
  // One that is steeper already may come down, but go no farther.
  const bool is_back = std::abs(wanted) < std::abs(elevation) || std::abs(elevation) <= kSteepest;
  if (is_back) view_.world_from_camera = turned_about(view_.world_from_camera, pivot_, right, elevation - wanted);
  view_.world_from_camera = turned_about(view_.world_from_camera, pivot_, vec3(0, 1, 0), -angles.x);
}

void CameraControl::pan(vec2 shares) {
  float height = 0.0f;
  if (const auto* perspective = std::get_if<PerspectiveCamera>(&view_.projection)) {
    height = 2.0f * distance() * std::tan(0.5f * perspective->yfov);
  } else {
    height = 2.0f * std::get<OrthographicCamera>(view_.projection).ymag;
  }
  const vec3 right = glm::normalize(vec3(view_.world_from_camera[0]));
  const vec3 up = glm::normalize(vec3(view_.world_from_camera[1]));
  const vec3 by = -height * (shares.x * right + shares.y * up);
  view_.world_from_camera[3] += vec4(by, 0.0f);
  pivot_ += by;
}

void CameraControl::zoom(float steps) {
  const float factor = std::exp2(-std::clamp(steps, -50.0f, 50.0f) / kStepsPerOctave);
  if (auto* orthographic = std::get_if<OrthographicCamera>(&view_.projection)) {
    orthographic->xmag *= factor;
    orthographic->ymag *= factor;
    return;
  }
  const float nearest = std::max(1e-6f, 1e-5f * glm::length(pivot_));
  const float wanted = std::max(distance() * factor, nearest);
  view_.world_from_camera[3] = vec4(pivot_ + back_of(view_) * wanted, 1.0f);
  // What was in focus at the pivot stays so.
  view_.lens.focus_distance *= view_.lens.radius > 0.0f ? factor : 1.0f;
}

void CameraControl::fit(const Extent& extent, float aspect) {
  const vec3 back = back_of(view_);
  Framing framing{.orbit = {.azimuth = std::atan2(back.x, back.z), .elevation = elevation_of(back)}, .aspect = aspect};
  if (const auto* perspective = std::get_if<PerspectiveCamera>(&view_.projection)) {
    framing.yfov = perspective->yfov;
  } else {
    framing.is_orthographic = true;
  }
  View framed = frame(extent, framing);
  framed.lens.radius = view_.lens.radius, framed.lens.blades = view_.lens.blades;
  framed.lens.vignetting = view_.lens.vignetting;
  set(framed, extent.empty() ? vec3(0.0f) : extent.bounds().center());
  view_.lens.focus_distance = distance();
}

void CameraControl::set_aspect(float aspect) {
  auto* orthographic = std::get_if<OrthographicCamera>(&view_.projection);
  if (orthographic != nullptr) orthographic->xmag = orthographic->ymag * aspect;
}

}  // namespace candela::viewer
