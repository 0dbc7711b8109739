#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "raster/gpu_scene.h"
#include "raster/render.h"
#include "unit/path/scenes.h"
#include "unit/raster/gl_fixture.h"

// A scene at one moment after another: each is drawn as it is alone, and what they share stays with the driver.

namespace candela {
namespace {

using namespace test;

class unit_raster_moments : public NeedsGl {};  // NOLINT(readability-identifier-naming): a suite is named as its laws

raster::Settings drawn() {
  raster::Settings s;
  s.width = s.height = 32;
  s.msaa = 1;
  return s;
}

const View kView = look_at({1.5f, 2.5f, 4.0f}, vec3(0.0f), 0.8f);

/// Pictures of scenes as moments of the first.
std::vector<Image> draw_in_turn(const std::vector<Scene>& moments, const Environment& environment) {
  std::vector<Image> pictures;
  raster::Session session;
  Diagnostics diagnostics;
  session.draw(
      moments.front(), environment, std::vector<View>(moments.size(), kView), drawn(), diagnostics,
      [&](std::size_t, Film film) { pictures.push_back(std::move(film.beauty)); }, nullptr,
      [&](std::size_t picture, int) {
        return raster::Moment{&moments[picture], kView};
      });
  return pictures;
}

Image draw_alone(const Scene& scene, const Environment& environment) {
  Diagnostics diagnostics;
  return raster::render(scene, environment, kView, drawn(), diagnostics).beauty;
}

double difference(const Image& a, const Image& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) sum += static_cast<double>(std::abs(a.pixels[i] - b.pixels[i]));
  return sum / static_cast<double>(a.pixels.size());
}

/// A floor, a ball with one texture of two, and a box; their meshes are known.
Scene things() {
  SceneBuilder b;
  b.add(plane({0, -1, 0}, 3.0f), matte(vec3(0.8f)));
  Material painted = plastic(vec3(1.0f), 0.5f);
  painted.base_color_texture = slot(b.add_texture(2, 1, {200, 40, 20, 255, 20, 40, 200, 255}, Filter::nearest));
  b.add_texture(1, 1, {30, 220, 60, 128});
  b.add(sphere(vec3(0.0f), 1.0f, 3, false), painted);
  b.add(box(vec3(-0.4f), vec3(0.4f)), matte({0.2f, 0.5f, 0.2f}), translation({1.4f, -0.6f, 0.6f}));
  b.add_light(point_light(vec3(1.0f), 30.0f), translation({2, 3, 2}));
  Scene scene = b.build();
  for (Mesh& mesh : scene.meshes) mesh.identity = std::make_shared<const char>();
  return scene;
}

TEST_F(unit_raster_moments, each_is_drawn_as_it_is_alone) {
  constexpr std::size_t kBall = 1, kBox = 2;
  const Environment sky = mapped_environment(32, 16, [](vec3 d) { return vec3(0.5f) + 0.4f * d; });
  struct Change {
    const char* what;
    std::function<void(Scene&)> change;
    bool is_noisy = false;  ///< from frame to frame
  };
  const std::vector<Change> changes = {
      {"a colour", [](Scene& s) { s.materials[kBox].base_color = vec3(0.9f, 0.1f, 0.1f); }},
      {"another texture", [](Scene& s) { s.materials[kBall].base_color_texture.texture = 1; }},
      {"another image", [](Scene& s) { s.textures[0].image = 1; }},
      {"images in another order",
       [](Scene& s) {
         std::swap(s.images[0], s.images[1]);
         std::swap(s.textures[0].image, s.textures[1].image);
         s.materials[kBox].base_color_texture = slot(1);
       }},
      {"a filter", [](Scene& s) { s.textures[0].filter = Filter::linear; }},
      {"a place",
       [](Scene& s) {
         s.nodes[kBox].world_from_node = translation({-1.4f, -0.2f, 0.6f});
       }},
      {"a mirror",
       [](Scene& s) {
         s.nodes[kBall].world_from_node = scaling({-1, 1, 1});
       }},
      {"another shape",
       [](Scene& s) {
         const int material = s.meshes[kBox].primitives[0].material;
         s.meshes[kBox] = {.name = {}, .primitives = {sphere(vec3(0.0f), 0.5f, 2, false)}};
         s.meshes[kBox].primitives[0].material = material;
       }},
      {"something hidden", [](Scene& s) { s.nodes[kBall].mesh = -1; }},
      {"a node's colour", [](Scene& s) { s.nodes[kBox].color = vec4(0.2f, 0.9f, 1.0f, 1.0f); }},
      {"what blends",
       [](Scene& s) { s.materials[kBall].alpha_mode = AlphaMode::blend, s.materials[kBall].opacity = 0.5f; }},
      {"what is masked",
       [](Scene& s) {
         s.materials[kBall].alpha_mode = AlphaMode::mask;
         s.materials[kBall].base_color_texture.texture = 1;
         s.materials[kBall].alpha_cutoff = 0.6f;
       }},
      {"a lamp", [](Scene& s) { s.lights[0].color = vec3(1.0f, 0.2f, 0.1f); }},
      {"what transmits", [](Scene& s) { s.materials[kBall].transmission = 0.9f; }},
      {"cloth",
       [](Scene& s) { s.materials[kBall].sheen_color = vec3(1.0f), s.materials[kBall].sheen_roughness = 0.4f; }},
      {"what glows", [](Scene& s) { s.materials[kBox].emission = vec3(20.0f); }, true},
      {"what scatters",
       [](Scene& s) {
         Material& m = s.materials[kBall];
         m.transmission = 1.0f, m.thickness = 1.0f, m.attenuation_distance = 0.2f;
         m.attenuation_color = {0.9f, 0.5f, 0.4f}, m.multiscatter_color = vec3(0.8f);
       },
       true},
  };
  const Scene rest = things();
  const Image at_rest = draw_alone(rest, sky);
  // From rest to each of them and back.
  std::vector<Scene> moments = {rest};
  for (const Change& c : changes) {
    moments.push_back(rest);
    c.change(moments.back());
    moments.push_back(rest);
  }
  const std::vector<Image> pictures = draw_in_turn(moments, sky);
  EXPECT_EQ(difference(pictures[0], at_rest), 0.0);
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const char* what = changes[i].what;
    const double most = changes[i].is_noisy ? 0.01 : 0.0;
    const Image expected = draw_alone(moments[2 * i + 1], sky);
    EXPECT_GT(difference(expected, at_rest), most + 0.001) << what << " changes nothing";
    EXPECT_LE(difference(pictures[2 * i + 1], expected), most) << what;
    EXPECT_EQ(difference(pictures[2 * i + 2], at_rest), 0.0) << what << ", and back again";
  }
}

TEST_F(unit_raster_moments, what_is_known_is_uploaded_once) {
  const auto context = gl::Context::open();
  Diagnostics diagnostics;
  Scene scene = things();
  raster::GpuScene gpu(scene, shade::shading_model_candela(), diagnostics);
  const auto buffers = [&] {
    std::vector<GLuint> names;
    for (const raster::GpuPrimitive& p : gpu.primitives()) names.push_back(p.vertices);
    return names;
  };
  const auto ball = [&]() -> const raster::GpuMaterial& {
    for (const raster::Draw& d : gpu.draws())
      if (d.node == 1) return gpu.material_of(d);
    throw Error("the ball is not drawn", "test");
  };
  const std::vector<GLuint> before = buffers();
  const GLuint texture = ball().textures[raster::base_color_slot];
  ASSERT_NE(texture, 0u);
  scene.materials[1].roughness = 0.1f;
  scene.nodes[1].world_from_node = translation({0, 1, 0});
  // An image that comes first leaves that of the ball where it is.
  scene.images.insert(scene.images.begin(), std::make_shared<const TextureImage>(*scene.images[1]));
  for (Texture& t : scene.textures) ++t.image;
  gpu.set_scene(scene, diagnostics);
  EXPECT_EQ(buffers(), before);
  EXPECT_EQ(ball().textures[raster::base_color_slot], texture);
  // What says nothing of being the same is not.
  scene.meshes[1].identity = nullptr;
  scene.meshes[2].identity = std::make_shared<const char>();
  gpu.set_scene(scene, diagnostics);
  const std::vector<GLuint> after = buffers();
  EXPECT_EQ(after[0], before[0]);
  EXPECT_NE(after[1], before[1]);
  EXPECT_NE(after[2], before[2]);
}

}  // namespace
}  // namespace candela
