#pragma once

#include <optional>

#include "image/image.h"
#include "raster/camera.h"
#include "raster/gpu_scene.h"
#include "raster/programs.h"
#include "scene/scene.h"
#include "scene/view.h"

/// The scene's ground as the rasterizer shows it: see Ground. Which part of its light the scene keeps away is found
/// once per scene, as a picture of the ground; frames look it up.
namespace candela::raster {

/// What the scene leaves of the ground's light, around the subject.
struct GroundShare {
  Image share;        ///< RGB; the middle of the first texel is at (lowest x, lowest z)
  vec2 corner{0.0f};  ///< x and z of that texel's outer corner, world
  float size = 1.0f;  ///< metres along an edge
  float height = 0.0f;

  /// At a point of the ground, bilinear; 1 beyond the picture, to which it fades.
  vec3 at(vec2 xz) const;
};

/// Draws the scene's shadow for many directions of light, chosen by how much of the ground's light is from there: suns
/// as discs, points and spots as balls of `light_radius`. Light that the scene itself gives or turns is left out.
GroundShare draw_ground_share(const Scene& scene, const Environment& environment, float light_radius,
                              const GpuScene& gpu, Programs& programs);

/// The environment that the scene above the ground is lit by: below the horizon is the ground, evenly lit.
Environment environment_over_ground(const Environment& environment, const Ground& ground);

/// The view of the mirror image in a ground: its picture has to be turned upside down.
View mirrored_view(const View& view, float height);

/// Where a frame shows the ground.
class GroundSight {
 public:
  GroundSight(const FrameCamera& camera, ivec2 size, float height) : camera_(camera), size_(size), height_(height) {}

  struct Ray {
    vec3 origin, direction;  ///< the latter unit
  };
  Ray ray(int x, int y) const;
  /// x and z of the ground at a pixel; nothing where the frame does not show it. It has no back.
  std::optional<vec2> at(int x, int y) const;

 private:
  FrameCamera camera_;
  ivec2 size_;
  float height_;
};

}  // namespace candela::raster
