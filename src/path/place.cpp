#include "path/place.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "path/surface_point.h"

namespace candela::path {

void Place::begin(const Ray& ray, const Hit& hit) {
  arrival_ = ray;
  hits_[0] = hit;
  count_ = 1;
  index_ = 0;
  sense_ = 1;
}

bool Place::extend(const Geometry& geometry) {
  if (count_ == kMost) return false;
  const Hit& last = hits_[static_cast<std::size_t>(count_ - 1)];
  // A little more than what is stepped over along the ray, and at grazing angles no more than a few times that.
  constexpr float kMargin = 1.1f;
  constexpr float kGrazing = 0.125f;
  constexpr float kRounding = 0x1p-20f;  // of a distance
  const Placement& placement = geometry.placement(last.placement);
  const TrianglePositions p = triangle_positions(placement, last.triangle);
  const vec3 normal = glm::cross(p.p1 - p.p0, p.p2 - p.p0);
  const float length = glm::length(normal);
  if (!(length > 0.0f)) return false;
  const vec3 n = normal / length;
  const float cosine = std::abs(glm::dot(n, arrival_.direction));
  const float rounding = kRounding * last.t;
  const float reach = kMargin * surface_clearance(placement, p, n) / std::max(cosine, kGrazing) + rounding;
  // What lies at the same distance may be found a rounding before.
  const float begin = std::max(arrival_.t_min, last.t - 0.125f * reach - rounding);
  const Ray window{arrival_.origin, arrival_.direction, begin, last.t + reach};
  const Hit next = geometry.intersect_beyond(window, last.seed, {hits_.data(), static_cast<std::size_t>(count_)});
  if (!next) return false;
  hits_[static_cast<std::size_t>(count_++)] = next;
  return true;
}

int Place::neighbour(const Geometry& geometry, int sense) {
  const int next = index_ + sense;
  return next == count_ && !extend(geometry) ? -1 : next;
}

bool Place::step(const Geometry& geometry, const Ray& ray, Hit& hit, bool is_through) {
  if (count_ == 0) {
    if (!is_through) return false;
    begin(ray, hit);
  }
  if (!is_through) sense_ = -sense_;
  const int next = neighbour(geometry, sense_);
  if (next < 0) {
    count_ = 0;
    return false;
  }
  index_ = next;
  hit = hits_[static_cast<std::size_t>(next)];
  return true;
}

void Place::enter_before_leaving(const Geometry& geometry, const Ray& ray, Hit& hit) {
  if (count_ == 0) begin(ray, hit);
  const int next = neighbour(geometry, sense_);
  if (next < 0) return;
  Hit& here = hits_[static_cast<std::size_t>(index_)];
  Hit& there = hits_[static_cast<std::size_t>(next)];
  const int body = geometry.placement(there.placement).body;
  if (body == 0 || body == geometry.placement(here.placement).body || is_back_hit(geometry, there, ray.direction)) {
    return;
  }
  std::swap(here, there);
  hit = here;
}

vec3 Place::transmittance(const Geometry& geometry, const Ray& ray, const Hit& hit, bool is_through, vec3 direction,
                          vec3& origin) {
  vec3 result(1.0f);
  if (count_ == 0) {
    if (!is_through) return result;
    begin(ray, hit);
  }
  const int sense = is_through ? sense_ : -sense_;
  for (int i = index_ + sense; i >= 0 && (i < count_ || extend(geometry)); i += sense) {
    const Hit& other = hits_[static_cast<std::size_t>(i)];
    result *= geometry.transmittance(other, direction);
    if (max_component(result) <= 0.0f) return result;
    origin = origin_beyond(geometry, other, direction);
  }
  return result;
}

}  // namespace candela::path
