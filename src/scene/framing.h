#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.h"
#include "scene/view.h"

/// Cameras that show a subject as a whole, neither too large nor too small: fitted to its silhouette.
namespace candela {

/// What is smaller is framed as if it had this size, metres: about what single precision tells apart around `center`.
double least_size(dvec3 center);

/// How far things reach in any direction, exactly: the support function of their vertices. Vertices are kept in groups
/// with a box each, so that most are never looked at.
class Extent {
 public:
  /// Everything that has a mesh, as it stands, without lamps of EXT_lights_area. Reads `scene`, which must outlive it.
  explicit Extent(const Scene& scene);
  explicit Extent(const std::vector<vec3>& points);
  explicit Extent(const Box3& box);

  /// That of both. Reads what `other` reads.
  void add(const Extent& other);
  bool empty() const { return bounds_.empty(); }
  const Box3& bounds() const { return bounds_; }
  /// Largest dot(p, direction) of a vertex p; -infinity of nothing.
  double reach(dvec3 direction) const;
  /// The vertices that reach farthest in `count` directions all around, each once.
  std::vector<vec3> outline(int count) const;

 private:
  struct Group {
    Box3 box;
    const vec3* points = nullptr;
    std::size_t count = 0;
  };
  struct Placed {
    glm::dmat4 world_from_points{1.0};
    std::size_t first_group = 0;
    std::size_t end_group = 0;
    Box3 box;  ///< in the world
  };
  std::optional<dvec3> farthest(dvec3 direction, double& best) const;
  void add_groups(const vec3* points, std::size_t count);
  void place(const glm::dmat4& world_from_points, std::size_t first_group, std::size_t end_group);

  std::vector<std::shared_ptr<const std::vector<vec3>>> own_points_;
  std::vector<Group> groups_;
  std::vector<Placed> placed_;
  Box3 bounds_;
};

/// A viewpoint that has a name.
struct NamedView {
  std::string_view name;
  float azimuth_deg;  ///< as Orbit
  float elevation_deg;
};
/// As a draughtsman calls them for a subject that faces +z; "right" is from +x. `iso` is isometric where the projection
/// is orthographic; `three-quarter` is Orbit's default.
inline constexpr auto kNamedViews = std::to_array<NamedView>({{"front", 0.0f, 0.0f},
                                                              {"back", 180.0f, 0.0f},
                                                              {"left", -90.0f, 0.0f},
                                                              {"right", 90.0f, 0.0f},
                                                              {"top", 0.0f, 90.0f},
                                                              {"bottom", 0.0f, -90.0f},
                                                              {"iso", 45.0f, 35.264390f},
                                                              {"three-quarter", 35.0f, 20.0f}});
/// Throws Error that lists them.
Orbit named_orbit(std::string_view name);

/// Where a scene is best seen from: the front of what is flat, as charts are, else three-quarter.
Orbit default_orbit(const Scene& scene, const Box3& bounds);

/// How a subject is put into a picture.
struct Framing {
  Orbit orbit = {};
  float aspect = 1.0f;  ///< width over height
  float yfov = PerspectiveCamera{}.yfov;
  bool is_orthographic = false;  ///< along the same axis; `yfov` has no effect then
  /// What remains free at two opposite sides where the subject touches first, each as a share of the picture's width or
  /// height; within 0 … 0.49.
  float margin = 0.08f;
  /// Pictures all around, as all_around() makes them of the view: all of them fit, and one touches.
  int turns = 1;
};

/// The nearest camera that shows all of `extent` with these margins, with the subject's silhouette in the middle.
/// Orbit::distance_scale counts from there. What has no size gets a place to be seen from; of nothing, a cube of two
/// metres about the origin is framed.
View frame(const Extent& extent, const Framing& framing);

/// What a framed view becomes when one goes on from its orbit to another about `center`, without coming nearer or
/// farther but by `orbit.distance_scale`. The first must have a scale of 1.
View moved_to(const View& framed, vec3 center, const Orbit& orbit);

}  // namespace candela
