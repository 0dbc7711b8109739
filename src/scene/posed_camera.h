#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/view.h"

namespace candela {

/// A camera that stands somewhere, as lists of cameras have them.
struct PosedCamera {
  std::string name;           ///< may be empty
  View view = {};             ///< adapted to the aspect of `size`
  std::optional<ivec2> size;  ///< of the picture that it is for, where the list says so
  std::string picture = {};   ///< its file, as lists name it; may be empty
  std::string depth = {};     ///< of its depths, likewise
};

/// A pinhole camera of the computer vision kind: x = K (X / Z), with x in pixels from the picture's top left corner
/// (the middle of the first pixel is at ½, ½) and X along the axes right, down, forward.
struct CameraMatrix {
  glm::dmat3 k{1.0};  ///< columns, as glm has them: k[2] is (cx, cy, 1)
  ivec2 size{0};      ///< of the picture
};

/// The view of such a camera with square or other pixels, its axis anywhere and its axes skew: what a symmetric
/// projection cannot say is in the linear part of View::world_from_camera. `world_from_camera` is rigid and of OpenGL's
/// axes: right, up, backwards. Throws Error where K is singular or no camera matrix.
View view_of_matrix(const CameraMatrix& matrix, const mat4& world_from_camera);

/// The other way round: K, and the rigid pose with OpenGL's axes. Throws Error for an orthographic view.
struct RigidCamera {
  CameraMatrix matrix;
  glm::dmat4 world_from_camera{1.0};
};
RigidCamera matrix_of_view(const View& view, ivec2 size);

/// The rotation of that pose, of any view: columns are right, up and backwards in world space.
glm::dmat3 camera_rotation(const View& view);

/// A matrix that moves and turns, without the scale that it may have as well. Throws Error where it is singular, shears
/// or mirrors.
mat4 rigid_part(const glm::dmat4& matrix);

/// Cameras all around a subject, all at one distance.
struct CameraSphere {
  int count = 24;
  unsigned seed = 0;           ///< turns them all; 0 = not
  bool is_upper_half = false;  ///< from above the horizon only
};
/// Directions to them from the subject, unit, of equal density.
std::vector<vec3> directions_on_sphere(const CameraSphere& sphere);

}  // namespace candela
