#include "path/capture.h"

#include "base/error.h"
#include "math/hash.h"
#include "path/statistics.h"
#include "shade/cube.glsl.h"

namespace candela::path {

namespace {

constexpr int kFaces = 6;

/// A camera that sees one face as it is stored: column 0 at s = -1, row 0 at t = -1. Its axes are left-handed, as the
/// addresses of a cube map are; only rays are made of them.
View face_view(int face, vec3 position) {
  const vec3 middle = shade::cube_direction(face, 0.0f, 0.0f);
  const vec3 along_s = shade::cube_direction(face, 1.0f, 0.0f) - middle;
  const vec3 along_t = shade::cube_direction(face, 0.0f, 1.0f) - middle;
  View view;
  view.world_from_camera = mat4(vec4(along_s, 0.0f), vec4(-along_t, 0.0f), vec4(-middle, 0.0f), vec4(position, 1.0f));
  view.projection = PerspectiveCamera{.yfov = 0.5f * kPi, .aspect_ratio = 1.0f};
  return view;
}

Settings face_settings(const Settings& settings, int face, int size) {
  Settings s = settings;
  s.width = s.height = size;
  s.filter = PixelFilter::box;  // what is beyond a texel belongs to its neighbour
  s.filter_radius = 0.0f;
  s.background = Background::environment;
  s.sees_backdrop = false;
  s.layers.clear();
  s.seed = hash_combine(settings.seed, static_cast<std::uint32_t>(face));
  if (settings.time_limit_s) s.time_limit_s = *settings.time_limit_s / kFaces;
  return s;
}

}  // namespace

Cubemap capture_environment(const Tracer& tracer, vec3 position, int size, const Settings& settings, const Job& job,
                            Statistics* statistics) {
  Statistics total;
  Cubemap cube;
  const JobParts faces(job, kFaces);
  for (int face = 0; face < kFaces; ++face) {
    Statistics of_face;
    const Film film = tracer.render(face_view(face, position), face_settings(settings, face, size),
                                    faces.part(static_cast<std::size_t>(face)), &of_face);
    if (of_face.interrupted) throw Interrupted("while a scene was captured");
    if (cube.empty()) cube.levels.push_back(make_cube_faces(size));
    Image& image = cube.levels[0][static_cast<std::size_t>(face)];
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) image.set_rgb(x, y, film.beauty.rgb(x, y));
    add_work(of_face, total);
    total.mean_samples_per_pixel += of_face.mean_samples_per_pixel / kFaces;
  }
  if (statistics != nullptr) *statistics = total;
  return cube;
}

}  // namespace candela::path
