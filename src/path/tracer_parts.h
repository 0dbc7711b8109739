#pragma once

#include <memory>
#include <utility>

#include "base/stopwatch.h"
#include "math/hash.h"
#include "path/geometry.h"
#include "path/lights.h"
#include "path/origin.h"
#include "path/render.h"

namespace candela::path {

/// What a tracer keeps of a scene.
struct Tracer::Parts {
  Parts(std::shared_ptr<const Scene> made_of, std::shared_ptr<const PreparedEnvironment> environment,
        const shade::ShadingModel& shading, double light_s = 0.0)
      : scene(std::move(made_of)),
        shape(scene),
        shared_geometry(std::make_shared<Geometry>(checked(scene), shading, tracing_origin(*scene))),
        geometry(*shared_geometry),
        lights(*scene, std::move(environment), geometry),
        build_s(light_s + watch.seconds()) {}
  Parts(const Parts& before, std::shared_ptr<const Scene> made_of,
        std::shared_ptr<const PreparedEnvironment> environment)
      : scene(std::move(made_of)),
        shape(before.shape),
        shared_geometry(before.shared_geometry),
        geometry(*shared_geometry),
        lights(checked(scene), std::move(environment), geometry),
        build_s(watch.seconds()) {}

  static const Scene& checked(const std::shared_ptr<const Scene>& scene) {
    validate(*scene);
    return *scene;
  }

  Stopwatch watch;
  std::shared_ptr<const Scene> scene;
  std::shared_ptr<const Scene> shape;  ///< what the geometry reads
  std::shared_ptr<Geometry> shared_geometry;
  Geometry& geometry;
  Lights lights;
  double build_s;
};

/// Throws Error for what no picture can be made with.
void check(const Settings& settings, const View& view);

/// Of the numbers of a pixel's samples.
inline std::uint32_t pixel_seed(std::uint32_t seed, int x, int y) {
  return hash_combine(hash_combine(seed, static_cast<std::uint32_t>(x)), static_cast<std::uint32_t>(y));
}

}  // namespace candela::path
