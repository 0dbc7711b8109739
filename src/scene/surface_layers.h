#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>

#include "image/film.h"
#include "scene/view.h"

/// What of a surface the layers of a picture show that have no mean: places and numbers. One source for both engines.
namespace candela {

/// World-space position of a place of a triangle: `barycentric` are the weights of its second and third corner.
vec3 position_at(const Scene& scene, int node, int primitive, std::uint32_t triangle, vec2 barycentric);
/// The first texture coordinates there; 0 where the mesh has none.
vec2 uv_at(const Scene& scene, int node, int primitive, std::uint32_t triangle, vec2 barycentric);

/// The material's index; -1 = none.
int material_of(const Scene& scene, const SurfaceSample& sample);

/// Adds those of `layers` that have no mean, but for Layer::motion. `map` was made of this scene and view.
void add_surface_layers(const Scene& scene, const View& view, const SurfaceMap& map, const std::set<Layer>& layers,
                        Film& film);

/// Layer::motion: how far, in pixels to the right and down, each surface is from its place in a picture of the same
/// size of another moment of the scene. 0 where nothing is, where the surface is behind the other view's eye, and of
/// what the other moment has not.
Image motion_layer(const Scene& scene, const View& view, const SurfaceMap& map, const Scene& next,
                   const View& next_view);

/// Turns a layer of world-space normals into camera space: right, up, towards the viewer.
void turn_to_camera(const View& view, Image& normals);
void turn(const mat3& rotation, Image& normals);

/// Names that tell nodes, or materials, apart: their own, with the number (number_of) where several share one or one
/// has none: "leg", "leg.12", "node 7". By index; of nodes those with a mesh.
std::map<std::uint32_t, std::string> matte_names(const Scene& scene, MatteKind kind);

/// Throws Error where a number of these layers is above kLargestNumber.
void check_numbers(const Scene& scene, const std::set<Layer>& layers);

}  // namespace candela
