#pragma once

#include <span>
#include <vector>

#include "scene/scene.h"

/// Meshes made by code. All have unit analytic normals, uvs with v downwards, tangents for normal textures, triangles
/// counter-clockwise seen from outside, and material 0.
namespace candela::content {

/// A point of an outline (radius, height) that is turned about +y. The solid lies left of the direction of travel.
struct OutlinePoint {
  vec2 position{0.0f};
  vec2 normal{0.0f};  ///< away from the solid
};
using Outline = std::vector<OutlinePoint>;

struct OutlineCorner {
  vec2 position{0.0f};
  float fillet = 0.0f;  ///< radius of the arc that replaces the corner; 0 = sharp
};
/// Straight lines between corners, rounded where they say so.
Outline rounded_outline(std::span<const OutlineCorner> corners);

/// Half circle from the lower to the upper pole.
Outline sphere_outline(float radius, int segments);

/// Spherical shell between two radii and two polar angles from +y, all its edges rounded by `fillet`. `to` = π closes
/// it at the lower pole.
Outline shell_outline(float inner, float outer, float from, float to, float fillet, int segments);

/// Turns an outline about +y. u runs once around per `u_repeat`, v from 1 at the outline's start to 0 at its end,
/// `v_repeat` times.
Primitive lathe(const Outline& outline, int segments, vec2 uv_repeat = vec2(1.0f));

Primitive sphere(float radius, int segments = 96);

/// Box with rounded edges; each face has the whole texture.
Primitive rounded_box(vec3 half_size, float bevel, int bevel_segments = 6);

/// Tube around a (p, q) torus knot about the z axis; u runs along the tube, v around it.
Primitive torus_knot(int p, int q, float ring_radius, float knot_radius, float tube_radius, int segments, int sides,
                     vec2 uv_repeat = vec2(1.0f));

/// Parallelogram, seen from cross(edge_u, edge_v); uv (0, 1) at `corner`, u along edge_u, v against edge_v.
Primitive quad(vec3 corner, vec3 edge_u, vec3 edge_v);

/// A floor that bends upwards into a back wall: z from `front` to `back` (back < front), the bend with `radius`, as
/// wide as ±half_width, the wall `height` high. Its uv is metres along width and length.
Primitive backdrop_sweep(float half_width, float front, float back, float radius, float height, int segments);

}  // namespace candela::content
