#include "candela/viewpoint.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene/posed_camera.h"

namespace candela {

namespace {

std::string vec3_text(vec3 v) { return fmt::format("{},{},{}", v.x, v.y, v.z); }

float aspect_of(const Shot& shot) { return static_cast<float>(shot.size.x) / static_cast<float>(shot.size.y); }

vec3 subject_center(const Seen& seen) { return seen.extent.empty() ? vec3(0.0f) : seen.extent.bounds().center(); }

Framing framing_of(const Shot& shot, const Orbit& orbit) {
  return {.orbit = orbit,
          .aspect = aspect_of(shot),
          .yfov = shot.yfov.value_or(PerspectiveCamera{}.yfov),
          .is_orthographic = shot.is_orthographic,
          .margin = shot.margin,
          .turns = shot.turntable.value_or(1)};
}

/// Along the same axis, with the same size at a distance.
void make_orthographic(View& view, float aspect, float distance) {
  const float half = distance * std::tan(0.5f * std::get<PerspectiveCamera>(view.projection).yfov);
  view.projection = OrthographicCamera{.xmag = half * aspect, .ymag = half};
}

Viewpoint from_eye(const Shot& shot, const Seen& seen) {
  const vec3 target = shot.target.value_or(subject_center(seen));
  if (*shot.eye == target) throw Error("the camera is where it looks at", "--eye");
  View view = look_at(*shot.eye, target, shot.yfov.value_or(PerspectiveCamera{}.yfov));
  if (shot.is_orthographic) make_orthographic(view, aspect_of(shot), glm::length(target - *shot.eye));
  return {view, "eye " + vec3_text(*shot.eye) + " target " + vec3_text(target)};
}

Viewpoint from_own_camera(const Shot& shot, const Seen& seen) {
  const float aspect = aspect_of(shot);
  View view = shot.camera ? scene_camera(seen.scene, *shot.camera, aspect)
                          : scene_camera(seen.scene, seen.scene.nodes[*seen.camera_node], aspect);
  if (shot.yfov) {
    auto* perspective = std::get_if<PerspectiveCamera>(&view.projection);
    if (perspective == nullptr) throw Error("the scene's camera is orthographic and has no field of view", "--fov");
    perspective->yfov = *shot.yfov;
  }
  return {view, shot.camera ? "camera " + *shot.camera : "default"};
}

std::string camera_name(const std::string& name, std::size_t index, std::size_t count) {
  const std::size_t digits = std::max<std::size_t>(3, std::to_string(count - 1).size());
  return name.empty() ? fmt::format("{:0{}}", index, digits) : name;
}

/// All at the distance from which each shows the whole subject about its centre.
std::vector<Viewpoint> from_sphere(const Shot& shot, const Seen& seen) {
  const Extent cube(Box3{vec3(-1.0f), vec3(1.0f)});
  const Extent& extent = seen.extent.empty() ? cube : seen.extent;
  const dvec3 center(extent.bounds().center());
  const double fill = 1.0 - 2.0 * static_cast<double>(shot.margin);
  const double ky = fill * std::tan(0.5 * static_cast<double>(shot.yfov.value_or(PerspectiveCamera{}.yfov)));
  const double kx = ky * static_cast<double>(aspect_of(shot));
  const std::vector<vec3> directions = directions_on_sphere(*shot.camera_sphere);
  double distance = least_size(center), half = distance;
  for (const vec3 direction : directions) {
    const glm::dmat3 axes(look_at(direction, vec3(0.0f), 1.0f).world_from_camera);
    const auto reach = [&](dvec3 d) { return extent.reach(d) - glm::dot(center, d); };
    for (const double sign : {-1.0, 1.0}) {
      distance =
          std::max({distance, reach(sign * axes[0] + kx * axes[2]) / kx, reach(sign * axes[1] + ky * axes[2]) / ky});
      half = std::max(
          {half, reach(sign * axes[0]) / fill / static_cast<double>(aspect_of(shot)), reach(sign * axes[1]) / fill});
    }
  }
  if (shot.is_orthographic) distance = 2.0 * static_cast<double>(glm::length(extent.bounds().size())) + half;
  std::vector<Viewpoint> all;
  for (const vec3 direction : directions) {
    View view =
        look_at(vec3(center + distance * dvec3(direction)), vec3(center), shot.yfov.value_or(PerspectiveCamera{}.yfov));
    if (shot.is_orthographic) {
      view.projection =
          OrthographicCamera{.xmag = static_cast<float>(half) * aspect_of(shot), .ymag = static_cast<float>(half)};
    }
    all.push_back({view, "camera " + camera_name("", all.size(), directions.size())});
  }
  return all;
}

void set_lens(const Shot& shot, const Seen& seen, View& view) {
  const auto* perspective = std::get_if<PerspectiveCamera>(&view.projection);
  if (shot.vignetting > 0.0f && perspective == nullptr) {
    throw Error("an orthographic camera has no lens", "--vignetting");
  }
  view.lens.vignetting = shot.vignetting;
  if (shot.f_number) {
    if (perspective == nullptr) throw Error("an orthographic camera has no lens", "--f-number");
    view.lens.radius = aperture_radius(*shot.f_number, perspective->yfov);
  }
  const bool is_focused = shot.focus_distance || shot.focuses_on_target;
  if (view.lens.radius <= 0.0f) {
    if (shot.blades > 0) throw Error("without an aperture has no effect: give --f-number", "--blades");
    if (is_focused) throw Error("without an aperture has no effect: give --f-number", "--focus-distance");
    return;
  }
  view.lens.blades = shot.blades;
  if (!shot.f_number && !is_focused) return;  // the scene's own camera, focused by its author
  if (shot.focus_distance) {
    view.lens.focus_distance = *shot.focus_distance;
    return;
  }
  const vec3 subject = shot.target.value_or(subject_center(seen));
  const float distance = -transform_point(glm::inverse(view.world_from_camera), subject).z;
  if (!(distance > 0.0f)) throw Error("the subject is behind the camera: give --focus-distance", "--f-number");
  view.lens.focus_distance = distance;
}

std::vector<Viewpoint> without_turns(const Shot& shot, const Seen& seen) {
  const auto framed = [&](const Orbit& orbit) { return frame(seen.extent, framing_of(shot, orbit)); };
  if (shot.camera_sphere) return from_sphere(shot, seen);
  std::vector<Viewpoint> all;
  for (std::size_t i = 0; i < shot.cameras.size(); ++i) {
    const PosedCamera& camera = shot.cameras[i];
    all.push_back({camera.view, "camera " + camera_name(camera.name, i, shot.cameras.size())});
  }
  for (const std::string& name : shot.views) all.push_back({framed(named_orbit(name)), name});
  if (!all.empty()) return all;
  if (shot.eye) return {from_eye(shot, seen)};
  if (shot.orbit) {
    const Orbit& orbit = *shot.orbit;
    return {{framed(orbit),
             fmt::format("orbit {},{},{}", degrees(orbit.azimuth), degrees(orbit.elevation), orbit.distance_scale)}};
  }
  if (!frames_subject(shot, seen.camera_node)) return {from_own_camera(shot, seen)};
  return {{framed(default_orbit(seen.scene, seen.extent.bounds())), "default"}};
}

}  // namespace

std::vector<ViewpointName> viewpoint_names(const Shot& shot) {
  std::vector<ViewpointName> names;
  const std::size_t count =
      shot.camera_sphere ? static_cast<std::size_t>(shot.camera_sphere->count) : shot.cameras.size();
  for (std::size_t i = 0; i < count; ++i) {
    names.push_back({"", camera_name(shot.camera_sphere ? "" : shot.cameras[i].name, i, count)});
  }
  if (count == 0) {
    for (const std::string& view : shot.views) names.push_back({view, ""});
  }
  if (names.empty()) names.emplace_back();
  return names;
}

bool frames_subject(const Shot& shot, std::optional<std::size_t> camera_node) {
  if (shot.camera || shot.eye || !shot.cameras.empty()) return false;
  return !shot.views.empty() || shot.camera_sphere || shot.orbit || shot.ignores_own_camera || !camera_node;
}

std::vector<View> all_around(const View& view, vec3 center, int count) {
  std::vector<View> views;
  for (int i = 0; i < count; ++i) {
    const float angle = 2.0f * kPi * static_cast<float>(i) / static_cast<float>(count);
    const mat4 turn = glm::mat4_cast(glm::angleAxis(angle, vec3(0, 1, 0)));
    mat4 there(1.0f), back(1.0f);
    there[3] = vec4(center, 1.0f), back[3] = vec4(-center, 1.0f);
    views.push_back(view);
    views.back().world_from_camera = there * turn * back * view.world_from_camera;
  }
  return views;
}

std::vector<Viewpoint> choose_viewpoints(const Shot& shot, const Seen& seen) {
  std::vector<Viewpoint> all;
  const vec3 center = shot.target.value_or(subject_center(seen));
  for (Viewpoint& viewpoint : without_turns(shot, seen)) {
    set_lens(shot, seen, viewpoint.view);
    for (const View& view : all_around(viewpoint.view, center, shot.turntable.value_or(1))) {
      all.push_back({view, viewpoint.description});
    }
  }
  return all;
}

}  // namespace candela
