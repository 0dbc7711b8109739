#include "scene/framing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "base/error.h"
#include "base/named_row.h"
#include "math/box.h"

namespace candela {
namespace {

constexpr std::size_t kGroup = 64;

/// Largest dot(p, direction) within a box; not less than that of any point in it.
double reach_of(const Box3& box, dvec3 direction) {
  const dvec3 lower(box.lower), upper(box.upper);
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    sum += std::max(direction[axis] * lower[axis], direction[axis] * upper[axis]);
  }
  return sum;
}

/// The box of a box that is turned; rounded outwards.
Box3 box_in_world(const glm::dmat4& world_from_points, const Box3& box) {
  Box3 all;
  for (const vec3 p : corners(box)) {
    const dvec3 q(world_from_points * glm::dvec4(dvec3(p), 1.0));
    for (int axis = 0; axis < 3; ++axis) {
      const auto rounded = static_cast<float>(q[axis]);
      all.lower[axis] = std::min(all.lower[axis], std::nextafter(rounded, -kInfinity));
      all.upper[axis] = std::max(all.upper[axis], std::nextafter(rounded, kInfinity));
    }
  }
  return all;
}

std::vector<vec3> corners_of(const Box3& box) {
  if (box.empty()) return {};
  const std::array<vec3, 8> all = corners(box);
  return {all.begin(), all.end()};
}

}  // namespace

void Extent::add_groups(const vec3* points, std::size_t count) {
  for (std::size_t first = 0; first < count; first += kGroup) {
    Group group{.box = {}, .points = points + first, .count = std::min(kGroup, count - first)};
    for (std::size_t i = 0; i < group.count; ++i) group.box.extend(group.points[i]);
    groups_.push_back(group);
  }
}

void Extent::place(const glm::dmat4& world_from_points, std::size_t first_group, std::size_t end_group) {
  Box3 local;
  for (std::size_t i = first_group; i < end_group; ++i) local.extend(groups_[i].box);
  if (local.empty()) return;
  placed_.push_back({world_from_points, first_group, end_group, box_in_world(world_from_points, local)});
}

Extent::Extent(const Scene& scene) : bounds_(world_bounds(scene)) {
  std::vector<std::pair<std::size_t, std::size_t>> groups_of_mesh;
  groups_of_mesh.reserve(scene.meshes.size());
  for (const Mesh& mesh : scene.meshes) {
    const std::size_t first = groups_.size();
    for (const Primitive& primitive : mesh.primitives) {
      add_groups(primitive.positions.data(), primitive.positions.size());
    }
    groups_of_mesh.emplace_back(first, groups_.size());
  }
  for (const Node& node : scene.nodes) {
    if (node.mesh < 0 || is_lamp(scene, node)) continue;
    const auto [first, end] = groups_of_mesh[static_cast<std::size_t>(node.mesh)];
    place(glm::dmat4(node.world_from_node), first, end);
  }
}

Extent::Extent(const std::vector<vec3>& points) {
  const auto own = std::make_shared<const std::vector<vec3>>(points);
  own_points_.push_back(own);
  for (const vec3 p : points) bounds_.extend(p);
  add_groups(own->data(), own->size());
  place(glm::dmat4(1.0), 0, groups_.size());
}

Extent::Extent(const Box3& box) : Extent(corners_of(box)) {}

void Extent::add(const Extent& other) {
  const std::size_t first = groups_.size();
  groups_.insert(groups_.end(), other.groups_.begin(), other.groups_.end());
  for (Placed placed : other.placed_) {
    placed.first_group += first, placed.end_group += first;
    placed_.push_back(placed);
  }
  own_points_.insert(own_points_.end(), other.own_points_.begin(), other.own_points_.end());
  bounds_.extend(other.bounds_);
}

std::optional<dvec3> Extent::farthest(dvec3 direction, double& best) const {
  std::optional<dvec3> found;
  best = -std::numeric_limits<double>::infinity();
  for (const Placed& placed : placed_) {
    if (reach_of(placed.box, direction) <= best) continue;
    const dvec3 local = glm::transpose(glm::dmat3(placed.world_from_points)) * direction;
    const double offset = glm::dot(dvec3(placed.world_from_points[3]), direction);
    for (std::size_t i = placed.first_group; i < placed.end_group; ++i) {
      const Group& group = groups_[i];
      if (reach_of(group.box, local) + offset <= best) continue;
      for (std::size_t k = 0; k < group.count; ++k) {
        const double reached = glm::dot(dvec3(group.points[k]), local) + offset;
        if (reached <= best) continue;
        best = reached;
        found = dvec3(placed.world_from_points * glm::dvec4(dvec3(group.points[k]), 1.0));
      }
    }
  }
  return found;
}

double Extent::reach(dvec3 direction) const {
  double best = 0.0;
  farthest(direction, best);
  return best;
}

std::vector<vec3> Extent::outline(int count) const {
  std::vector<vec3> points;
  for (int i = 0; i < count; ++i) {
    // Swinbank & Purser 2006, "Fibonacci grids": equal areas, about the golden angle from one to the next.
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double angle = 2.39996322972865332 * i;
    const double r = std::sqrt(std::max(0.0, 1.0 - z * z));
    double best = 0.0;
    if (const auto p = farthest({r * std::cos(angle), r * std::sin(angle), z}, best)) points.emplace_back(*p);
  }
  const auto before = [](vec3 a, vec3 b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); };
  std::sort(points.begin(), points.end(), before);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

Orbit named_orbit(std::string_view name) {
  const NamedView& view = row_named(kNamedViews, name, "there is no view");
  return {.azimuth = radians(view.azimuth_deg), .elevation = radians(view.elevation_deg)};
}

namespace {

/// Which way the surfaces face in the mean, by area.
dvec3 mean_normal(const Scene& scene) {
  dvec3 sum(0.0);
  for (const Node& node : scene.nodes) {
    if (node.mesh < 0 || is_lamp(scene, node)) continue;
    const glm::dmat3 world(node.world_from_node);
    // Of a node that mirrors, the front is on the other side of the cross product.
    const double side = glm::determinant(world) < 0.0 ? -1.0 : 1.0;
    for (const Primitive& p : scene.meshes[static_cast<std::size_t>(node.mesh)].primitives) {
      for (const uvec3& t : p.triangles) {
        const dvec3 a(p.positions[t.x]);
        const dvec3 u = world * (dvec3(p.positions[t.y]) - a), v = world * (dvec3(p.positions[t.z]) - a);
        sum += 0.5 * side * glm::cross(u, v);
      }
    }
  }
  return sum;
}

}  // namespace

Orbit default_orbit(const Scene& scene, const Box3& bounds) {
  // So thin that from the side it is a line: a chart, a sign, a picture. What lies on the ground must be thinner still,
  // for landscapes and carpets are looked across.
  constexpr float kFlat = 0.05f, kSheet = 0.005f;
  if (bounds.empty()) return {};
  const vec3 size = bounds.size();
  const int axis = size.x <= size.y && size.x <= size.z ? 0 : size.y <= size.z ? 1 : 2;
  const float next = std::min(size[(axis + 1) % 3], size[(axis + 2) % 3]);
  if (!(size[axis] <= (axis == 1 ? kSheet : kFlat) * next) || next <= 0.0f) return {};
  // What faces both sides is seen from where the axis points.
  const bool faces_back = mean_normal(scene)[axis] < 0.0;
  if (axis == 0) return named_orbit(faces_back ? "left" : "right");
  if (axis == 1) return named_orbit(faces_back ? "bottom" : "top");
  return named_orbit(faces_back ? "back" : "front");
}

namespace {

/// Axes of a camera on an orbit, unit.
struct Axes {
  dvec3 right, up, back;
};
Axes axes_of(const Orbit& orbit) {
  const double azimuth = orbit.azimuth, elevation = orbit.elevation;
  const double ca = std::cos(azimuth), sa = std::sin(azimuth);
  const double ce = std::cos(elevation), se = std::sin(elevation);
  const dvec3 back(sa * ce, se, ca * ce), right(ca, 0.0, -sa);
  return {right, glm::cross(back, right), back};
}

}  // namespace

double least_size(dvec3 center) {
  constexpr double kSmallest = 1e-9, kRounding = 4.0 * 0x1p-23;  // metres; of single precision, there
  return kSmallest + kRounding * glm::length(center);
}

namespace {

/// Extent relative to a point, of all its positions on a turntable together, and never without a size.
class Subject {
 public:
  Subject(const Extent& extent, int turns) : extent_(extent), center_(extent.bounds().center()) {
    constexpr int kMostTurns = 720;
    turns = std::clamp(turns, 1, kMostTurns);
    for (int i = 0; i < turns; ++i) {
      const double angle = 2.0 * std::acos(-1.0) * i / turns;
      turns_.emplace_back(std::cos(angle), std::sin(angle));
    }
    size_ = static_cast<double>(glm::length(extent.bounds().size()));
    const double least = least_size(center_);
    ball_ = size_ < least ? least : 0.0;
    size_ = std::max(size_, least);
  }

  const dvec3& center() const { return center_; }
  double size() const { return size_; }
  double reach(dvec3 direction) const {
    double best = -std::numeric_limits<double>::infinity();
    for (const dvec2& turn : turns_) {
      const dvec3 d(turn.x * direction.x + turn.y * direction.z, direction.y,
                    turn.x * direction.z - turn.y * direction.x);
      best = std::max(best, extent_.reach(d) - glm::dot(center_, d));
    }
    return best + ball_ * glm::length(direction);
  }

 private:
  const Extent& extent_;
  dvec3 center_;
  std::vector<dvec2> turns_;  ///< cosine and sine
  double size_ = 0.0;
  double ball_ = 0.0;  ///< what a point is taken for
};

/// Where the camera stands along one axis of the picture: its distance and how far it is shifted sideways.
struct AxisFit {
  double distance;
  double shift;
};

/// The nearest place from where everything is seen within the slope `k`. A point is inside when
/// |sideways - shift| <= k (distance - towards): each side plane is pushed against the subject, which gives two linear
/// bounds and thereby a closed form.
AxisFit fit_axis(const Subject& subject, dvec3 sideways, dvec3 back, double k) {
  const double right = subject.reach(sideways + k * back);
  const double left = subject.reach(-sideways + k * back);
  return {.distance = (right + left) / (2.0 * k), .shift = 0.5 * (right - left)};
}

/// The shift that centres the subject as seen from `distance`, on the axis that is perhaps not the tight one: the slope
/// for which `distance` is just right is found by halving.
double centered_shift(const Subject& subject, dvec3 sideways, dvec3 back, double k, double distance) {
  constexpr int kHalvings = 30;
  AxisFit best = fit_axis(subject, sideways, back, k);
  if (best.distance >= distance * (1.0 - 1e-9)) return best.shift;
  double lower = 0.0, upper = k;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (lower + upper);
    const AxisFit fit = fit_axis(subject, sideways, back, middle);
    (fit.distance > distance ? lower : upper) = middle;
    if (fit.distance <= distance) best = fit;
  }
  return best.shift;
}

View placed_view(const Axes& axes, dvec3 eye, double distance) {
  View view;
  view.world_from_camera =
      mat4(vec4(axes.right, 0.0f), vec4(axes.up, 0.0f), vec4(axes.back, 0.0f), vec4(vec3(eye), 1.0f));
  view.lens.focus_distance = static_cast<float>(distance);
  return view;
}

View frame_in_parallel(const Subject& subject, const Axes& axes, const Framing& framing) {
  const auto half_of = [&](dvec3 axis) { return 0.5 * (subject.reach(axis) + subject.reach(-axis)); };
  const auto middle_of = [&](dvec3 axis) { return 0.5 * (subject.reach(axis) - subject.reach(-axis)); };
  const double fill = 1.0 - 2.0 * static_cast<double>(framing.margin);
  const double aspect = framing.aspect;
  const double half = std::max(half_of(axes.up), half_of(axes.right) / aspect) / fill *
                      static_cast<double>(framing.orbit.distance_scale);
  const double distance = subject.reach(axes.back) + subject.size();
  const dvec3 eye =
      subject.center() + middle_of(axes.right) * axes.right + middle_of(axes.up) * axes.up + distance * axes.back;
  View view = placed_view(axes, eye, distance);
  view.projection = OrthographicCamera{.xmag = static_cast<float>(half * aspect), .ymag = static_cast<float>(half)};
  return view;
}

}  // namespace

View frame(const Extent& extent, const Framing& framing) {
  if (extent.empty()) return frame(Extent(Box3{vec3(-1.0f), vec3(1.0f)}), framing);
  const Axes axes = axes_of(framing.orbit);
  const Subject subject(extent, framing.turns);
  if (framing.is_orthographic) return frame_in_parallel(subject, axes, framing);
  const double fill = 1.0 - 2.0 * static_cast<double>(framing.margin);
  const double ky = fill * std::tan(0.5 * static_cast<double>(framing.yfov));
  const double kx = ky * static_cast<double>(framing.aspect);
  const double fitting = std::max(fit_axis(subject, axes.right, axes.back, kx).distance,
                                  fit_axis(subject, axes.up, axes.back, ky).distance);
  const double whole = std::max(fitting, subject.reach(axes.back) + 5e-4 * subject.size());
  const double distance = whole * static_cast<double>(framing.orbit.distance_scale);
  const dvec3 shift = centered_shift(subject, axes.right, axes.back, kx, whole) * axes.right +
                      centered_shift(subject, axes.up, axes.back, ky, whole) * axes.up;
  View view = placed_view(axes, subject.center() + shift + distance * axes.back, distance);
  view.projection = PerspectiveCamera{.yfov = framing.yfov, .aspect_ratio = framing.aspect};
  return view;
}

View moved_to(const View& framed, vec3 center, const Orbit& orbit) {
  const dvec3 eye = dvec3(framed.world_from_camera[3]) - dvec3(center);
  const dvec3 local = glm::transpose(glm::dmat3(framed.world_from_camera)) * eye;
  const Axes axes = axes_of(orbit);
  const double distance = local.z * static_cast<double>(orbit.distance_scale);
  View view =
      placed_view(axes, dvec3(center) + local.x * axes.right + local.y * axes.up + distance * axes.back, distance);
  view.projection = framed.projection;
  return view;
}

}  // namespace candela
