#pragma once

#include <optional>
#include <string>
#include <variant>

#include "scene/scene.h"

namespace candela {

/// Thin lens. Camera space: looks along -z, +y up, +x right.
struct Lens {
  float radius = 0.0f;          ///< of the aperture, metres; 0 = pinhole, everything sharp
  float focus_distance = 1.0f;  ///< metres along -z to the plane that is sharp
  int blades = 0;               ///< corners of the aperture; below 3 it is round
  float vignetting = 0.0f;      ///< 0 = none, 1 = natural cos⁴ fall-off towards the corners
};

/// Where the picture is taken from. `projection` is already adapted to the picture's aspect ratio.
struct View {
  mat4 world_from_camera{1.0f};
  std::variant<PerspectiveCamera, OrthographicCamera> projection;
  Lens lens;
  /// What the camera itself sees, metres along -z; mirrors and lamps see all.
  float near_plane = 0.0f;
  float far_plane = kInfinity;

  bool is_clipped() const { return near_plane > 0.0f || far_plane < kInfinity; }
};

/// How far along -z the rays of a view start: at the near plane, which takes away all that lies before it, matter as
/// well as surfaces. A hair beyond, so that what lies in the plane is away for every ray, however it is rounded.
float start_of_rays(const View& view);

/// What a camera ray sees that hits nothing, or nothing but glass that it passes. A plain colour is `transparent` with
/// DevelopSettings::background.
enum class Background { environment, transparent };

/// Where around a subject the camera is. Azimuth 0 looks along -z (sees +z sides), positive azimuth moves the camera
/// towards +x. `distance_scale` 1 fits, see frame(); 0.5 is twice as close.
struct Orbit {
  float azimuth = 0.610865f;    ///< radians; 35°
  float elevation = 0.349066f;  ///< radians, up; 20°
  float distance_scale = 1.0f;
};

/// Camera at `eye` looking at `target`; +y is up unless looking along it.
View look_at(vec3 eye, vec3 target, float yfov);

/// The file's camera by number or by name (of the camera or its node). Throws Error naming what exists.
View scene_camera(const Scene& scene, const std::string& number_or_name, float aspect);
/// That of a node that has one. Throws Error where its transform leaves no direction to look in.
View scene_camera(const Scene& scene, const Node& node, float aspect);

/// Aperture radius in metres from an f-number, the field of view and a 24 mm high sensor.
float aperture_radius(float f_number, float yfov);

/// A point of the aperture, uniform for uniform `u` in [0,1)²: in the unit disc, or in the polygon of the blades.
vec2 sample_aperture(const Lens& lens, vec2 u);

}  // namespace candela
