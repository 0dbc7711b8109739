#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <memory>
#include <vector>

#include "base/error.h"
#include "unit/path/scenes.h"

// One prepared scene for many pictures, and pictures that go on.

namespace candela {
namespace {

using namespace test;

/// A gloss, a lamp and something blended, so that samples differ.
Scene still_life() {
  SceneBuilder b;
  b.add(plane(vec3(0.0f), 3.0f), plastic({0.5f, 0.6f, 0.4f}, 0.4f));
  Material veil = matte({0.9f, 0.2f, 0.1f});
  veil.alpha_mode = AlphaMode::blend;
  veil.opacity = 0.5f;
  b.add(sphere({0, 0.5f, 0}, 0.5f, 2, false), veil);
  b.add(quad({-0.5f, 1.8f, -0.5f}, {1, 0, 0}, {0, 0, 1}), lamp(vec3(4.0f)));
  return b.build();
}

Environment dusk() { return constant_environment({0.2f, 0.25f, 0.4f}); }
View front() { return look_at({1, 1.3f, 3}, {0, 0.4f, 0}, 0.7f); }

path::Settings with_layers(int size, int samples) {
  path::Settings s = settings(size, samples, 3);
  s.layers = {Layer::albedo, Layer::normal, Layer::depth};
  return s;
}

TEST(unit_path_tracer, a_picture_that_goes_on_is_that_of_one_run) {
  const path::Tracer tracer(still_life(), dusk());
  // Of the targets pixels come to some at one look, some at another.
  for (const float target : {0.0f, 0.2f, 0.12f, 0.08f}) {
    path::Settings s = with_layers(20, 83);
    if (target > 0.0f) s.noise = target;
    path::Statistics of_whole;
    const Film whole = tracer.render(front(), s, {}, &of_whole);
    path::Picture picture(tracer, front(), s);
    for (const int samples : {0, 2, 2, 5, 21, 40, 83}) picture.trace(samples);
    EXPECT_TRUE(films_are_identical(picture.film(), whole));
    EXPECT_EQ(picture.statistics().samples, of_whole.samples);
    EXPECT_EQ(picture.statistics().shadow_rays, of_whole.shadow_rays);
    if (target > 0.0f) {
      EXPECT_LT(of_whole.mean_samples_per_pixel, 83.0) << "some pixels end early";
      continue;
    }
    // The twin: one sample more is another picture.
    picture.trace(84);
    EXPECT_FALSE(films_are_identical(picture.film(), whole));
  }
}

TEST(unit_path_tracer, what_was_stopped_within_a_pass_goes_on_there) {
  const path::Tracer tracer(still_life(), dusk());
  path::Settings s = with_layers(240, 40);
  s.bounces = 1;
  const Film whole = tracer.render(front(), s);
  path::Picture picture(tracer, front(), s);
  std::atomic<bool> stop{true};
  int stops = 0;
  do {
    picture.trace(s.samples, {.stop = &stop});
    if (picture.statistics().interrupted) ++stops;
  } while (picture.statistics().interrupted);
  EXPECT_GE(stops, 4) << "after each pass, and within those that take longer than a look at the clock";
  EXPECT_TRUE(films_are_identical(picture.film(), whole));
  EXPECT_EQ(picture.statistics().samples + picture.statistics().spared_samples, 240u * 240u * 40u);
}

TEST(unit_path_tracer, one_tracer_makes_the_pictures_of_many) {
  const Scene scene = still_life();
  const path::Tracer tracer(borrowed(scene), dusk());
  for (const float x : {-1.0f, 1.0f}) {
    const View view = look_at({x, 1.3f, 3}, {0, 0.4f, 0}, 0.7f);
    const path::Settings s = with_layers(16, 4);
    EXPECT_TRUE(films_are_identical(tracer.render(view, s), path::render(scene, dusk(), view, s)));
  }
}

TEST(unit_path_tracer, scenes_under_one_prepared_light_are_traced_as_each_alone) {
  Environment striped;
  striped.map = std::make_shared<const Image>([] {
    Image map(16, 8, 3);
    for (std::size_t i = 0; i < map.pixels.size(); ++i) map.pixels[i] = i % 5 == 0 ? 3.0f : 0.1f;
    return map;
  }());
  const path::FarLight light(striped);
  SceneBuilder b;
  b.add(plane({0, 0, 0}, 2.0f), matte(vec3(0.7f)));
  const auto other = std::make_shared<const Scene>(b.build());
  for (const auto& scene : {std::make_shared<const Scene>(still_life()), other}) {
    const path::Settings s = with_layers(16, 4);
    const Film shared = path::Tracer(scene, light).render(front(), s);
    EXPECT_TRUE(films_are_identical(shared, path::Tracer(scene, striped).render(front(), s)));
  }
}

TEST(unit_path_tracer, other_materials_on_the_same_tree_give_the_picture_of_a_new_tracer) {
  const path::FarLight light(dusk());
  const shade::ShadingModel shading = shade::shading_model_candela();
  struct Change {
    std::function<void(Scene&)> make;
    bool is_taken;  ///< what is built serves again
  };
  const std::vector<Change> changes = {
      {[](Scene& s) { s.materials[0].base_color = vec3(0.1f, 0.1f, 0.9f); }, true},
      {[](Scene& s) { s.materials[2].emission = vec3(0.0f); }, true},
      {[](Scene& s) { s.materials[0].emission = vec3(1.0f, 0.0f, 0.0f); }, true},
      {[](Scene& s) { s.materials[1].opacity = 0.9f; }, true},
      {[](Scene& s) { s.materials.push_back(s.materials[2]); }, true},
      {[](Scene& s) { s.materials[1].alpha_mode = AlphaMode::opaque; }, false},
      {[](Scene& s) { s.materials[0].transmission = 1.0f, s.materials[0].roughness = 0.0f; }, false},
      {[](Scene& s) { s.materials[0].transmission = 1.0f, s.materials[0].thickness = 1.0f; }, false},
      {[](Scene& s) { s.materials[0].anisotropy = 0.5f; }, false},
  };
  const path::Settings s = with_layers(16, 8);
  for (std::size_t i = 0; i < changes.size(); ++i) {
    auto scene = std::make_shared<Scene>(still_life());
    for (Primitive& p : scene->meshes[0].primitives) p.tangents.assign(p.positions.size(), vec4(1, 0, 0, 1));
    path::Tracer tracer(std::make_shared<const Scene>(*scene), light);
    const Film before = tracer.render(front(), s);
    changes[i].make(*scene);
    EXPECT_EQ(tracer.take_materials(scene, light, shading), changes[i].is_taken) << i;
    const Film wanted = path::render(changes[i].is_taken ? *scene : still_life(), dusk(), front(), s);
    const Film after = tracer.render(front(), s);
    EXPECT_TRUE(films_are_identical(after, wanted)) << i;
    const bool has_spare = scene->materials.size() > still_life().materials.size();
    EXPECT_EQ(films_are_identical(after, before), !changes[i].is_taken || has_spare) << i;
  }
  // What somebody else holds is not changed under him.
  const auto scene = std::make_shared<const Scene>(still_life());
  path::Tracer tracer(scene, light);
  const path::Tracer same = tracer;
  EXPECT_FALSE(tracer.take_materials(scene, light, shading));
  const path::Tracer on_its_tree(tracer, scene, light);
  EXPECT_FALSE(tracer.take_materials(scene, light, shading));
}

TEST(unit_path_tracer, scenes_that_name_what_is_not_there_are_refused) {
  const auto refuses = [](const std::function<void(Scene&)>& change) {
    Scene scene = still_life();
    change(scene);
    try {
      path::render(scene, dusk(), front(), settings(4, 1, 1));
    } catch (const Error&) {
      return true;
    }
    return false;
  };
  EXPECT_TRUE(refuses([](Scene& s) { s.meshes[0].primitives[0].material = 99; }));
  EXPECT_TRUE(refuses([](Scene& s) { s.nodes[0].mesh = 99; }));
  EXPECT_TRUE(refuses([](Scene& s) { s.meshes[0].primitives[0].triangles[0].x = 99999; }));
  EXPECT_TRUE(refuses([](Scene& s) { s.materials[0].base_color_texture.texture = 3; }));
  EXPECT_TRUE(refuses([](Scene& s) { s.materials.clear(); }));
  EXPECT_FALSE(refuses([](Scene&) {}));
}

TEST(unit_path_tracer, a_backdrop_is_seen_only_where_it_is_asked_for) {
  Environment light = mapped_environment(16, 8, [](vec3) { return vec3(2.0f); });
  auto backdrop = std::make_shared<Image>(16, 8, 3);
  light.backdrop = backdrop;
  const path::Tracer tracer(SceneBuilder().build(), light);
  path::Settings s = settings(4, 1, 1);
  EXPECT_EQ(tracer.render(front(), s).beauty.rgb(1, 1), vec3(0.0f));
  s.sees_backdrop = false;
  EXPECT_LT(glm::length(tracer.render(front(), s).beauty.rgb(1, 1) - vec3(2.0f)), 1e-5f);
}

}  // namespace
}  // namespace candela
