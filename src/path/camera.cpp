#include "path/camera.h"

#include <cmath>

#include "shade/lens.glsl.h"

namespace candela::path {

Camera::Camera(const View& view, int width, int height)
    : axes_{vec3(view.world_from_camera[0]), vec3(view.world_from_camera[1]), vec3(view.world_from_camera[2])},
      eye_(view.world_from_camera[3]),
      lens_(view.lens),
      film_size_(width, height),
      near_(start_of_rays(view)),
      far_(view.far_plane),
      is_clipped_(view.is_clipped()) {
  const float aspect = film_size_.x / film_size_.y;
  if (const auto* perspective = std::get_if<PerspectiveCamera>(&view.projection)) {
    const float half = std::tan(0.5f * perspective->yfov);
    half_extent_ = {half * aspect, half};
  } else {
    const auto& orthographic = std::get<OrthographicCamera>(view.projection);
    half_extent_ = {orthographic.xmag, orthographic.ymag};
    is_orthographic_ = true;
  }
}

Box3 Camera::origins() const {
  // On the near plane a lens spreads by as much again at most.
  const vec2 half = half_extent_ * (is_orthographic_ ? 1.0f : near_) +
                    lens_.radius * (1.0f + (has_lens() ? near_ / lens_.focus_distance : 0.0f));
  Box3 box;
  for (int corner = 0; corner < 4; ++corner) {
    const vec2 sign((corner & 1) != 0 ? 1.0f : -1.0f, (corner & 2) != 0 ? 1.0f : -1.0f);
    box.extend(eye_ + axes_.to_world(vec3(sign * half, -near_)));
  }
  return box;
}

std::optional<Camera::Pinhole> Camera::pinhole() const {
  const glm::dmat3 world_from_camera(axes_.t, axes_.b, axes_.n);
  if (is_orthographic_ || has_lens() || glm::determinant(world_from_camera) == 0.0) return std::nullopt;
  return Pinhole{eye_, glm::inverse(world_from_camera), film_size_, half_extent_};
}

Camera::Sample Camera::generate(vec2 film, vec2 u) const {
  const vec2 ndc(2.0f * film.x / film_size_.x - 1.0f, 1.0f - 2.0f * film.y / film_size_.y);
  const vec2 p = ndc * half_extent_;
  vec3 origin(0.0f);
  vec3 direction(p, -1.0f);
  if (is_orthographic_) {
    origin = vec3(p, 0.0f);
    direction = vec3(0, 0, -1);
  }
  Sample sample;
  if (has_lens()) {
    const vec3 focus = origin + direction * lens_.focus_distance;
    origin += vec3(sample_aperture(lens_, u) * lens_.radius, 0.0f);
    direction = focus - origin;
  }
  if (lens_.vignetting > 0.0f && !is_orthographic_) {
    const float cos2 = direction.z * direction.z / glm::dot(direction, direction);
    sample.weight = shade::lens_vignetting(cos2, lens_.vignetting);
  }
  sample.ray.origin = eye_ + axes_.to_world(origin);
  sample.ray.direction = glm::normalize(axes_.to_world(direction));
  if (is_clipped_) {
    const float along = glm::length(axes_.to_world(direction)) / -direction.z;
    sample.start = near_ * along;
    sample.ray.origin += sample.ray.direction * sample.start;
    sample.ray.t_max = (far_ - near_) * along;
  }
  return sample;
}

}  // namespace candela::path
