#include "candela/shot.h"

#include <gtest/gtest.h>

#include <atomic>

#include "candela/light.h"
#include "candela/verdict.h"
#include "ibl/cube.h"
#include "path/capture.h"
#include "unit/image/labelled_cube.h"
#include "unit/path/scenes.h"

namespace candela {
namespace {

using namespace test;

Shot small() {
  Shot shot{.scene = "demo:spheres", .size = {24, 16}};
  shot.traced.samples = 2;
  shot.environment = "furnace";
  return shot;
}

std::vector<TakenPicture> taken(const Shot& shot, const Job& job = {}) {
  std::vector<TakenPicture> pictures;
  Take(shot).render([&](TakenPicture picture) { pictures.push_back(std::move(picture)); }, job);
  return pictures;
}

TEST(unit_candela_shot, a_turntable_is_the_scene_from_all_around) {
  Shot shot = small();
  shot.turntable = 4;
  shot.exposure = std::optional<float>();  // metered
  const std::vector<TakenPicture> pictures = taken(shot);
  ASSERT_EQ(pictures.size(), 4u);
  const Scene scene = load(shot.scene);
  const Environment light = make_environment("furnace");
  const View front = default_view(scene, 1.5f);
  const vec3 center = subject_bounds(scene).center();
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const float angle = 0.5f * kPi * static_cast<float>(i);
    View view = front;
    view.world_from_camera =
        translation(center) * rotation({0, 1, 0}, angle) * translation(-center) * front.world_from_camera;
    const Film expected = path::render(scene, light, view, traced_settings(shot));
    EXPECT_EQ(pictures[i].index, i);
    EXPECT_LT(glm::length(mean_of(pictures[i].film.beauty) - mean_of(expected.beauty)), 2e-2) << i;
    EXPECT_EQ(pictures[i].develop.exposure, pictures[0].develop.exposure) << "one for all";
    EXPECT_EQ(pictures[i].film.metadata.at("camera"), "default");
    // The acceleration structure is made once.
    EXPECT_EQ(pictures[i].traced.build_s > 0.0, i == 0);
  }
  EXPECT_TRUE(films_are_identical(pictures[0].film, path::render(scene, light, front, traced_settings(shot))));
  EXPECT_FALSE(films_are_identical(pictures[0].film, pictures[2].film));
}

TEST(unit_candela_shot, views_are_framed_alike_and_share_one_acceleration_structure) {
  Shot shot = small();
  shot.views = {"front", "iso"};
  shot.margin = 0.2f;
  Take take(shot);
  const std::vector<PictureLabel> labels = take.labels();
  ASSERT_EQ(labels.size(), 2u);
  EXPECT_EQ(labels[0], (PictureLabel{.view = "front"}));
  EXPECT_EQ(labels[1], (PictureLabel{.view = "iso"}));
  const std::vector<TakenPicture> pictures = taken(shot);
  const Scene scene = load(shot.scene);
  for (std::size_t i = 0; i < 2; ++i) {
    const View view = frame(Extent(scene), {.orbit = named_orbit(shot.views[i]), .aspect = 1.5f, .margin = 0.2f});
    const Film expected = path::render(scene, make_environment("furnace"), view, traced_settings(shot));
    EXPECT_EQ(pictures[i].label, labels[i]);
    EXPECT_EQ(pictures[i].film.beauty.pixels, expected.beauty.pixels);
    EXPECT_EQ(pictures[i].film.metadata.at("camera"), shot.views[i]);
    EXPECT_EQ(pictures[i].traced.build_s > 0.0, i == 0);
  }
}

TEST(unit_candela_shot, lists_of_cameras_and_places_on_a_sphere_are_looked_through) {
  Shot shot = small();
  const Scene scene = load(shot.scene);
  const View view = frame(Extent(scene), {.aspect = 1.5f});
  shot.cameras = {{.name = "a", .view = view, .size = {}, .picture = {}},
                  {.name = "", .view = view, .size = {}, .picture = {}}};
  shot.turntable = 2;
  Take take(shot);
  take.prepare();
  std::vector<std::string> names;
  for (const PictureLabel& label : take.labels()) names.push_back(label.camera);
  EXPECT_EQ(names, (std::vector<std::string>{"a", "a", "001", "001"}));
  ASSERT_EQ(take.views().size(), 4u);
  EXPECT_EQ(take.views()[2].world_from_camera, view.world_from_camera);
  shot.cameras.clear();
  shot.turntable.reset();
  shot.camera_sphere = CameraSphere{.count = 5, .seed = 2};
  Take around(shot);
  around.prepare();
  ASSERT_EQ(around.labels().size(), 5u);
  EXPECT_EQ(around.labels()[4].camera, "004");
  const vec3 center = world_bounds(scene).center();
  const auto distance = [&](const View& v) { return glm::length(vec3(v.world_from_camera[3]) - center); };
  for (const View& v : around.views()) {
    EXPECT_NEAR(distance(v), distance(around.views()[0]), 1e-4f);
    EXPECT_TRUE(sees_something(scene, v));
  }
}

TEST(unit_candela_shot, the_scenes_own_camera_can_be_ignored) {
  Shot shot = small();
  const Scene scene = load(shot.scene);
  ASSERT_TRUE(has_camera(scene));
  Take own(shot);
  own.prepare();
  shot.ignores_own_camera = true;
  Take framed(shot);
  framed.prepare();
  EXPECT_EQ(own.views()[0].world_from_camera, default_view(scene, 1.5f).world_from_camera);
  EXPECT_EQ(framed.views()[0].world_from_camera, frame(Extent(scene), {.aspect = 1.5f}).world_from_camera);
}

TEST(unit_candela_shot, a_stop_leaves_the_picture_at_hand_and_begins_no_other) {
  Shot shot = small();
  shot.turntable = 3;
  shot.traced.samples = 100000;
  const std::atomic<bool> stop{true};
  std::size_t count = 0;
  const TakeResult result = Take(shot).render(
      [&](const TakenPicture& picture) {
        EXPECT_FALSE(picture.is_whole());
        ++count;
      },
      {.stop = &stop});
  EXPECT_EQ(count, 1u);
  EXPECT_EQ(result.done, 1u);
  EXPECT_EQ(result.asked, 3u);
  EXPECT_TRUE(result.interrupted && result.is_last_unfinished);
}

TEST(unit_candela_shot, a_stop_while_it_is_denoised_leaves_the_picture_as_it_was_traced) {
  Shot shot = small();
  shot.traced.seed = 3;
  const std::vector<TakenPicture> plain = taken(shot);
  shot.denoiser = denoise::Method::regression;
  const std::vector<TakenPicture> whole = taken(shot);
  EXPECT_TRUE(whole[0].is_denoised && whole[0].is_whole());
  EXPECT_TRUE(whole[0].film.metadata.contains("denoiser"));
  std::atomic<bool> stop{false};
  Job job{.stop = &stop};
  job.progress = [&](const Progress& p) { stop = stop || p.what.find("denoising") != std::string::npos; };
  const std::vector<TakenPicture> stopped = taken(shot, job);
  EXPECT_FALSE(stopped[0].is_denoised || stopped[0].is_whole());
  EXPECT_FALSE(stopped[0].film.metadata.contains("denoiser"));
  EXPECT_EQ(stopped[0].film.beauty.pixels, plain[0].film.beauty.pixels);
}

TEST(unit_candela_shot, a_quality_has_samples_noise_and_a_denoiser_and_frames) {
  Shot shot = small();
  set_quality(Quality::final, shot);
  EXPECT_TRUE(shot.traced.noise && shot.denoiser);
  EXPECT_GT(shot.drawn.frames, 1);
  set_quality(Quality::draft, shot);
  EXPECT_FALSE(shot.traced.noise);
  EXPECT_EQ(shot.traced.samples, 16);
  EXPECT_EQ(shot.drawn.frames, 1);
  EXPECT_EQ(parse_quality("good"), Quality::good);
  EXPECT_THROW(parse_quality("best"), Error);
  // Each takes more than the one before.
  for (std::size_t i = 1; i < kQualities.size(); ++i) {
    EXPECT_GT(kQualities[i].samples, kQualities[i - 1].samples);
    EXPECT_GT(kQualities[i].frames, kQualities[i - 1].frames);
  }
}

TEST(unit_candela_shot, paper_is_ground_and_background_in_one_colour) {
  Shot shot = small();
  shot.ground = GroundChoice{.color = vec3(0.2f, 0.4f, 0.8f)};
  const TakenPicture picture = taken(shot).at(0);
  ASSERT_TRUE(picture.develop.background.has_value());
  EXPECT_EQ(*picture.develop.background, *shot.ground->color);
  EXPECT_FALSE(picture.film.through.empty());
  // On another page it is only the light that comes back from it.
  shot.background = Background::transparent;
  EXPECT_FALSE(taken(shot).at(0).develop.background.has_value());
}

TEST(unit_candela_shot, the_ground_is_under_the_subject_unless_it_is_told_where) {
  Shot shot = small();
  shot.scene = "demo:product";
  shot.size = {48, 32};
  shot.traced.samples = 16;
  shot.orbit = Orbit{.elevation = radians(50.0f), .distance_scale = 1.5f};
  shot.ground = GroundChoice{};
  shot.background = Background::transparent;
  const auto shade = [&] {
    const TakenPicture picture = taken(shot).at(0);
    return 1.0 - mean_luminance(picture.film.through);
  };
  const double touching = shade();
  const float lowest = subject_bounds(load(shot.scene)).lower.y;
  shot.ground->height = lowest;
  EXPECT_NEAR(shade(), touching, 0.002);
  shot.ground->height = lowest - 20.0f;
  EXPECT_LT(shade(), touching - 0.02);
}

TEST(unit_candela_shot, a_studio_is_light_and_paper) {
  for (const StudioInfo& info : kStudios) {
    Shot shot = small();
    set_studio(parse_studio(info.name), shot);
    EXPECT_EQ(make_environment(*shot.environment).exposure, 1.0f) << info.name;
    EXPECT_EQ(*shot.ground->color, info.paper) << info.name;
    EXPECT_EQ(shot.ground->mirror, info.mirror) << info.name;
  }
  EXPECT_THROW(parse_studio("beige"), Error);
}

TEST(unit_candela_shot, noise_is_judged_at_the_shots_exposure) {
  Shot shot = small();
  shot.traced.samples = 256;
  shot.traced.noise = 0.01f;
  const auto samples = [&](float exposure) {
    shot.exposure = std::optional(exposure);
    return taken(shot)[0].traced.mean_samples_per_pixel;
  };
  EXPECT_EQ(samples(1e-4f), 16.0) << "black";
  EXPECT_GT(samples(1.0f), 16.0);
}

TEST(unit_candela_shot, progress_grows_over_all_pictures_and_partial_ones_have_metadata) {
  Shot shot = small();
  shot.turntable = 2;
  double last = 0.0;
  int partials = 0;
  Job job;
  job.progress = [&](const Progress& p) {
    EXPECT_GE(p.fraction, last);
    EXPECT_NE(p.what.find("of 2"), std::string::npos);
    last = p.fraction;
  };
  job.partial_interval_s = 0.0;
  job.partial = [&](const Film& film) {
    EXPECT_EQ(film.metadata.at("scene"), "demo:spheres");
    ++partials;
  };
  taken(shot, job);
  EXPECT_EQ(last, 1.0);
  EXPECT_GT(partials, 2);
}

TEST(unit_candela_shot, what_the_scene_has_not_is_named_by_its_option) {
  const auto where = [](const std::function<void(Shot&)>& change) -> std::string {
    Shot shot = small();
    change(shot);
    try {
      Take(shot).prepare();
    } catch (const Error& error) {
      return error.where();
    }
    return "";
  };
  EXPECT_EQ(where([](Shot&) {}), "");
  EXPECT_EQ(where([](Shot& s) { s.eye = s.target = vec3(1.0f); }), "--eye");
  EXPECT_EQ(where([](Shot& s) { s.blades = 5; }), "--blades");
  EXPECT_EQ(where([](Shot& s) { s.focus_distance = 1.0f; }), "--focus-distance");
}

TEST(unit_candela_shot, the_lens_focuses_on_the_target) {
  Shot shot = small();
  shot.eye = vec3(0, 0, 8);
  shot.target = vec3(0, 0, 1);
  shot.f_number = 1.0f;
  shot.traced.samples = 64;
  const Scene scene = load(shot.scene);
  View view = look_at(*shot.eye, *shot.target, PerspectiveCamera{}.yfov);
  view.lens.radius = aperture_radius(1.0f, PerspectiveCamera{}.yfov);
  view.lens.focus_distance = 7.0f;
  const Film expected = path::render(scene, make_environment("furnace"), view, traced_settings(shot));
  EXPECT_LT(largest_difference(taken(shot)[0].film.beauty, expected.beauty), 1e-3);
}

TEST(unit_candela_probes, one_tracer_serves_all_probes) {
  const Scene scene = load("demo:spheres");
  const path::Tracer tracer(borrowed(scene), make_environment("sky"));
  const std::vector<raster::Probe> probes = bake_probes(tracer, 2, 1);
  ASSERT_EQ(probes.size(), 2u);
  path::Settings settings;
  settings.samples = 1;
  settings.sees_lamps = false;
  for (const raster::Probe& probe : probes) {
    const path::Tracer own(borrowed(scene), make_environment("sky"));
    const Cubemap seen = path::capture_environment(own, probe.position, 64, settings);
    const raster::BakedLight expected = raster::bake_light(seen.levels[0], false);
    EXPECT_TRUE(faces_are_equal(probe.light.specular.levels[1], expected.specular.levels[1]));
  }
  EXPECT_FALSE(faces_are_equal(probes[0].light.specular.levels[1], probes[1].light.specular.levels[1]));
  const std::atomic<bool> stop{true};
  EXPECT_THROW(bake_probes(tracer, 1, 100, {.stop = &stop}), Interrupted);
}

TEST(unit_candela_light, what_is_loaded_is_turned_and_dimmed_as_asked) {
  const LoadedLight plain = load_light({.environment = "sky"}, 8);
  const LoadedLight half = load_light({.environment = "sky", .intensity = 0.5f}, 8);
  EXPECT_NEAR(ibl::total_flux(half.source).y / ibl::total_flux(plain.source).y, 0.5, 1e-6);
  EXPECT_FALSE(plain.faces);
  // Within a furnace every side is the furnace.
  const LoadedLight seen =
      load_light({.environment = "furnace", .scene = "demo:spheres", .position = {0, 50, 0}, .samples = 1}, 4);
  ASSERT_TRUE(seen.faces);
  EXPECT_NEAR((*seen.faces)[2].rgb(1, 1).x, make_environment("furnace").constant.x, 1e-3f);
}

TEST(unit_candela_verdict, scenes_are_judged_and_what_cannot_be_read_says_why) {
  const Verdict verdict = judge("demo:spheres");
  EXPECT_FALSE(verdict.unreadable);
  EXPECT_GT(verdict.material_count, 0u);
  EXPECT_GT(verdict.triangle_count, 0u);
  const Verdict absent = judge("there-is-no-such-file.glb");
  EXPECT_TRUE(absent.unreadable);
  ASSERT_EQ(absent.findings.size(), 1u);
  EXPECT_EQ(absent.findings[0].finding.code, "unreadable");
  const std::atomic<bool> stop{true};
  EXPECT_THROW(judge("demo:spheres", {}, {.stop = &stop}), Interrupted);
}

}  // namespace
}  // namespace candela
