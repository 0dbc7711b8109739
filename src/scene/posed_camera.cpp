#include "scene/posed_camera.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "math/hash.h"

namespace candela {

View view_of_matrix(const CameraMatrix& matrix, const mat4& world_from_camera) {
  const glm::dmat3& k = matrix.k;
  const double fx = k[0][0], fy = k[1][1], skew = k[1][0], cx = k[2][0], cy = k[2][1];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (!std::isfinite(k[i][j])) throw Error("K has a number that is not finite");
    }
  }
  if (fx == 0.0 || fy == 0.0) throw Error("K is singular: a focal length is 0");
  if (fx < 0.0 || fy < 0.0) throw Error("K has a negative focal length");
  if (k[0][1] != 0.0 || k[0][2] != 0.0 || k[1][2] != 0.0 || k[2][2] != 1.0) {
    throw Error("K is no camera matrix: it is [fx s cx; 0 fy cy; 0 0 1]");
  }
  const double width = matrix.size.x, height = matrix.size.y;
  // A pixel's ray is, to the right, (u - cx + s y) / fx and, upwards, y = (cy - v) / fy: what a symmetric projection
  // makes of it, times a factor, plus a shift.
  const double half_y = 0.5 * height / fy;
  const double stretch = 0.5 * width / fx / (half_y * width / height);
  const double up = (cy - 0.5 * height) / fy;
  const double right = (0.5 * width - cx) / fx + skew / fx * up;
  const glm::dmat4 pose(world_from_camera);
  glm::dmat4 sheared = pose;
  sheared[0] = stretch * pose[0];
  sheared[1] = pose[1] + skew / fx * pose[0];
  sheared[2] = pose[2] - right * pose[0] - up * pose[1];
  View view;
  view.world_from_camera = mat4(sheared);
  view.projection = PerspectiveCamera{.yfov = static_cast<float>(2.0 * std::atan(half_y)),
                                      .aspect_ratio = static_cast<float>(width / height)};
  return view;
}

glm::dmat3 camera_rotation(const View& view) {
  const glm::dmat3 axes(view.world_from_camera);
  const dvec3 right = glm::normalize(axes[0]);
  const dvec3 back = glm::normalize(glm::cross(axes[0], axes[1]));
  return {right, glm::cross(back, right), back};
}

RigidCamera matrix_of_view(const View& view, ivec2 size) {
  const auto* perspective = std::get_if<PerspectiveCamera>(&view.projection);
  if (perspective == nullptr) throw Error("an orthographic camera has no K");
  const glm::dmat4 given(view.world_from_camera);
  // The linear part is the rotation times a matrix with nothing below its diagonal.
  const glm::dmat3 rotation = camera_rotation(view);
  const glm::dmat3 upper = glm::transpose(rotation) * glm::dmat3(given);
  const double f = upper[2][2];
  const double half_y = std::tan(0.5 * static_cast<double>(perspective->yfov));
  const double width = size.x, height = size.y;
  const double dx = upper[0][0] * half_y * width / height / f, dy = upper[1][1] * half_y / f;
  const double skewed = upper[1][0] * half_y / f, shift_x = upper[2][0] / f, shift_y = upper[2][1] / f;
  const double fx = 0.5 * width / dx, fy = 0.5 * height / dy;
  RigidCamera result;
  result.matrix.size = size;
  result.matrix.k[0][0] = fx;
  result.matrix.k[1][1] = fy;
  result.matrix.k[1][0] = fx * skewed / dy;
  result.matrix.k[2][0] = 0.5 * width + fx * (shift_x - skewed * shift_y / dy);
  result.matrix.k[2][1] = 0.5 * height - shift_y * fy;
  result.world_from_camera = glm::dmat4(rotation);
  result.world_from_camera[3] = given[3];
  return result;
}

mat4 rigid_part(const glm::dmat4& matrix) {
  constexpr double kTolerance = 1e-3;  // of files that hold six digits, and less
  for (int c = 0; c < 4; ++c) {
    for (int r = 0; r < 4; ++r) {
      if (!std::isfinite(matrix[c][r])) throw Error("the matrix has a number that is not finite");
    }
  }
  if (matrix[0][3] != 0.0 || matrix[1][3] != 0.0 || matrix[2][3] != 0.0 || matrix[3][3] != 1.0) {
    throw Error("the matrix's last row is not 0 0 0 1");
  }
  glm::dmat3 axes(matrix);
  const double scale = std::cbrt(std::abs(glm::determinant(axes)));
  const double lengths = glm::length(axes[0]) * glm::length(axes[1]) * glm::length(axes[2]);
  if (!(lengths > 0.0) || std::abs(glm::determinant(axes)) < 1e-5 * lengths) throw Error("the matrix is singular");
  axes /= scale;
  if (glm::determinant(axes) < 0.0) throw Error("the matrix mirrors");
  const glm::dmat3 unit = glm::transpose(axes) * axes;
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 3; ++r) {
      if (std::abs(unit[c][r] - (c == r ? 1.0 : 0.0)) > kTolerance) throw Error("the matrix is no rotation");
    }
  }
  // Rounded numbers are made a rotation again: the viewing axis is kept, then the one upwards.
  const dvec3 back = glm::normalize(axes[2]);
  const dvec3 right = glm::normalize(glm::cross(axes[1], back));
  glm::dmat4 result(glm::dmat3(right, glm::cross(back, right), back));
  result[3] = matrix[3];
  return mat4(result);
}

std::vector<vec3> directions_on_sphere(const CameraSphere& sphere) {
  // Swinbank & Purser 2006, "Fibonacci grids": a golden angle from one to the next, and equal areas between heights.
  constexpr double kGoldenAngle = 2.39996322972865332;
  const double start = 2.0 * std::acos(-1.0) * static_cast<double>(hash(sphere.seed)) * 0x1p-32;
  std::vector<vec3> directions;
  for (int i = 0; i < sphere.count; ++i) {
    const double share = (i + 0.5) / sphere.count;
    const double y = sphere.is_upper_half ? 1.0 - share : 1.0 - 2.0 * share;
    const double r = std::sqrt(std::max(0.0, 1.0 - y * y));
    const double angle = kGoldenAngle * i + (sphere.seed == 0 ? 0.0 : start);
    directions.emplace_back(r * std::sin(angle), y, r * std::cos(angle));
  }
  return directions;
}

}  // namespace candela
