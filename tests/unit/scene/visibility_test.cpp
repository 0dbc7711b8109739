#include "scene/visibility.h"

#include <gtest/gtest.h>

#include <cmath>

#include "content/make_environment.h"
#include "scene/brightness.h"
#include "scene/environment.h"

namespace candela {
namespace {

/// A cube of 24 vertices in one primitive.
Primitive cube(float half, vec3 at = vec3(0)) {
  Primitive p;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0f, 1.0f}) {
      const auto first = static_cast<std::uint32_t>(p.positions.size());
      for (int i = 0; i < 4; ++i) {
        vec3 corner;
        corner[axis] = side;
        corner[(axis + 1) % 3] = (i & 1) != 0 ? side : -side;
        corner[(axis + 2) % 3] = (i & 2) != 0 ? 1.0f : -1.0f;
        vec3 normal(0);
        normal[axis] = side;
        p.positions.push_back(at + half * corner);
        p.normals.push_back(normal);
      }
      p.triangles.emplace_back(first, first + 1, first + 3);
      p.triangles.emplace_back(first, first + 3, first + 2);
    }
  }
  return p;
}

Scene scene_of(std::vector<Primitive> primitives) {
  Scene scene;
  scene.materials.emplace_back();
  scene.meshes.push_back({.name = {}, .primitives = std::move(primitives)});
  Node node;
  node.mesh = 0;
  scene.nodes.push_back(node);
  return scene;
}

TEST(unit_scene_visibility, what_is_in_front_of_the_camera_is_seen_and_nothing_else) {
  const Scene scene = scene_of({cube(0.5f)});
  const float yfov = 0.6f;
  EXPECT_TRUE(sees_something(scene, look_at(vec3(0, 0, 5), vec3(0), yfov)));
  EXPECT_FALSE(sees_something(scene, look_at(vec3(0, 0, 5), vec3(0, 0, 10), yfov))) << "behind the camera";
  EXPECT_FALSE(sees_something(scene, look_at(vec3(0, 0, 5), vec3(4, 0, 0), yfov))) << "beside the picture";
  EXPECT_TRUE(sees_something(scene, look_at(vec3(0, 0, 5), vec3(1.6f, 0, 0), yfov))) << "at its edge";
  EXPECT_TRUE(sees_something(scene, look_at(vec3(0), vec3(0, 1, 3), yfov))) << "from inside a closed room";
  View orthographic = look_at(vec3(0, 0, 5), vec3(0), yfov);
  orthographic.projection = OrthographicCamera{.xmag = 1, .ymag = 1};
  EXPECT_TRUE(sees_something(scene, orthographic));
  orthographic.world_from_camera[3] = vec4(2, 0, 5, 1);
  EXPECT_FALSE(sees_something(scene, orthographic));
  orthographic.world_from_camera = look_at(vec3(0, 0, 5), vec3(0, 0, 10), yfov).world_from_camera;
  EXPECT_FALSE(sees_something(scene, orthographic)) << "behind the camera";
}

TEST(unit_scene_visibility, what_is_not_between_the_planes_is_not_seen) {
  const Scene scene = scene_of({cube(1.0f)});
  View view = look_at({0, 0, 5}, vec3(0), 0.6f), orthographic = view;
  orthographic.projection = OrthographicCamera{.xmag = 1.5f, .ymag = 1.5f};
  for (View seen : {view, orthographic}) {
    const auto sees = [&](float near, float far) {
      seen.near_plane = near, seen.far_plane = far;
      return sees_something(scene, seen);
    };
    EXPECT_TRUE(sees(0.1f, 100.0f));
    EXPECT_TRUE(sees(5.0f, 5.1f)) << "the sides of the cube";
    EXPECT_FALSE(sees(0.1f, 3.0f));
    EXPECT_FALSE(sees(7.0f, 100.0f));
    EXPECT_FALSE(sees(7.0f, kInfinity));
  }
}

TEST(unit_scene_visibility, a_triangle_counts_where_none_of_its_corners_is_in_the_picture) {
  // A huge triangle around a narrow view; and one whose box fills the view that it passes by.
  Primitive huge;
  huge.positions = {{-1000, -1000, 0}, {1000, -1000, 0}, {0, 1000, 0}};
  huge.normals.assign(3, vec3(0, 0, 1));
  huge.triangles = {uvec3(0, 1, 2)};
  EXPECT_TRUE(sees_something(scene_of({huge}), look_at(vec3(0, 0, 5), vec3(0), 0.1f)));
  Primitive past = huge;
  past.positions = {{-10, 10, 0}, {-10, -10, 0}, {10, -10, 0}};
  EXPECT_FALSE(sees_something(scene_of({past}), look_at(vec3(5, 5, 5), vec3(5, 5, 0), 0.1f)));
  EXPECT_TRUE(sees_something(scene_of({past}), look_at(vec3(-5, -5, 5), vec3(-5, -5, 0), 0.1f)));
}

TEST(unit_scene_visibility, a_vertex_far_out_that_leaves_nothing_to_see_is_found) {
  EXPECT_FALSE(find_emptiness(scene_of({cube(0.5f)})));
  for (const float far : {1e3f, 1e6f, 1e9f}) {
    Scene scene = scene_of({cube(0.5f)});
    Primitive& p = scene.meshes[0].primitives[0];
    p.positions[5] = vec3(far, 0, 0);
    scene.nodes[0].name = "spike";
    const auto found = find_emptiness(scene);
    ASSERT_TRUE(found) << far;
    EXPECT_NE(found->message.find("node 0 'spike' has a vertex"), std::string::npos) << found->message;
  }
  // A floor that fills the picture, two things far apart, and a subject on a stage are something to see.
  std::vector<Primitive> crowd(20, cube(0.5f));
  Primitive floor;
  floor.positions = {{-500, 0, -500}, {-500, 0, 500}, {500, 0, 500}, {500, 0, -500}};
  floor.normals.assign(4, vec3(0, 1, 0));
  floor.triangles = {uvec3(0, 1, 2), uvec3(0, 2, 3)};
  crowd.push_back(floor);
  EXPECT_FALSE(find_emptiness(scene_of(crowd)));
  EXPECT_FALSE(find_emptiness(scene_of({cube(500.0f), cube(0.5f)})));
  EXPECT_FALSE(find_emptiness(scene_of({cube(0.5f), cube(0.5f, vec3(300, 0, 0))})));
}

TEST(unit_scene_visibility, things_so_far_apart_that_none_covers_a_pixel_are_found) {
  Scene scene = scene_of({cube(0.5f)});  // two of it, neither of which is the stray
  scene.nodes.push_back(scene.nodes[0]);
  scene.nodes[1].name = "far";
  scene.nodes[1].world_from_node[3] = vec4(1e6f, 0, 0, 1);
  const auto found = find_emptiness(scene);
  ASSERT_TRUE(found);
  EXPECT_NE(found->message.find("node 0 and node 1 'far' lie 1e+06 m apart"), std::string::npos) << found->message;
  // Of one mesh, and as many as there are directions.
  Scene one = scene_of({cube(0.5f)});
  Primitive& p = one.meshes[0].primitives[0];
  const std::size_t own = p.positions.size();
  for (std::size_t i = 0; i < own; ++i) {
    p.positions.push_back(p.positions[i] + vec3(0, 1e5f, 0));
    p.normals.push_back(p.normals[i]);
  }
  const std::vector<uvec3> triangles = p.triangles;
  for (const uvec3& t : triangles) p.triangles.push_back(t + static_cast<unsigned>(own));
  ASSERT_TRUE(find_emptiness(one));
  EXPECT_NE(find_emptiness(one)->message.find("vertices of node 0 lie 1e+05 m apart"), std::string::npos);
  std::vector<Primitive> stars;
  for (const vec3 at : {vec3(1e6f, 0, 0), vec3(-1e6f, 0, 0), vec3(0, 1e6f, 0), vec3(0, -1e6f, 0), vec3(0, 0, 1e6f)}) {
    stars.push_back(cube(0.5f, at));
  }
  EXPECT_TRUE(find_emptiness(scene_of(stars)));
  // Dots of some pixels are something to see, in a picture that has the pixels.
  const Scene near = scene_of({cube(0.5f), cube(0.5f, vec3(1000, 0, 0))});
  EXPECT_FALSE(find_emptiness(near));
  EXPECT_TRUE(find_emptiness(near, 240));
}

TEST(unit_scene_visibility, what_is_empty_says_why) {
  Scene scene = scene_of({cube(0.5f)});
  scene.meshes[0].primitives.clear();
  EXPECT_EQ(find_emptiness(scene)->message, "no mesh of the scene has a triangle");
  scene.meshes.clear();
  scene.nodes.clear();
  EXPECT_EQ(find_emptiness(scene)->message, "nothing in the scene has a mesh");
}

// ----- whether the scene's own lamps outshine its environment

Scene with_lamp(const Light& light, vec3 at) {
  Scene scene = scene_of({cube(1.0f)});
  scene.lights.push_back(light);
  Node node;
  node.light = 0;
  node.world_from_node[3] = vec4(at, 1);
  scene.nodes.push_back(node);
  return scene;
}

Environment furnace(float radiance) {
  Environment environment;
  environment.constant = vec3(radiance);
  environment.exposure = 1.0f;
  return environment;
}

TEST(unit_scene_brightness, lamps_outshine_an_environment_by_the_light_that_they_give) {
  Light lamp;
  const auto outshines_at = [&](float intensity, vec3 at) {
    lamp.intensity = intensity;
    return outshines(with_lamp(lamp, at), furnace(1.0f));  // π lux
  };
  EXPECT_FALSE(outshines_at(0.0f, vec3(0, 3, 0)));
  EXPECT_FALSE(outshines_at(1.0f, vec3(0, 3, 0))) << "a candle two metres above";
  EXPECT_TRUE(outshines_at(5435.0f, vec3(0, 3, 0))) << "a lamp of 100 W";
  EXPECT_FALSE(outshines_at(5435.0f, vec3(0, 300, 0))) << "the same far away";
  lamp.type = LightType::directional;
  EXPECT_FALSE(outshines_at(3.0f, vec3(0)));
  EXPECT_TRUE(outshines_at(1e5f, vec3(0))) << "the sun";
  lamp.type = LightType::spot;
  EXPECT_FALSE(outshines_at(5435.0f, vec3(0, 3, 0))) << "it shines along -z, past the cube";
  EXPECT_TRUE(outshines_at(5435.0f, vec3(0, 0, 3)));
  lamp.type = LightType::point;
  lamp.color = vec3(0);
  EXPECT_FALSE(outshines_at(5435.0f, vec3(0, 3, 0)));
}

TEST(unit_scene_brightness, a_ground_however_large_is_half_of_the_surface_at_most) {
  for (const float size : {5.0f, 50.0f, 5000.0f}) {
    Light lamp;
    const auto outshines_at = [&](float intensity) {
      lamp.intensity = intensity;
      Scene scene = with_lamp(lamp, {3, 3, 3});
      Primitive ground = cube(size, vec3(0, -size - 1.0f, 0));
      scene.meshes[0].primitives.push_back(ground);
      return outshines(scene, furnace(1.0f));
    };
    EXPECT_TRUE(outshines_at(5435.0f)) << size;
    EXPECT_FALSE(outshines_at(1.0f)) << size;
  }
}

TEST(unit_scene_brightness, what_glows_counts_by_its_own_brightness_and_by_what_it_lights) {
  Scene scene = scene_of({cube(1.0f)});
  scene.materials[0].emission = vec3(1);
  EXPECT_FALSE(outshines(scene, furnace(1.0f)));
  scene.materials[0].emission = vec3(1000);
  EXPECT_TRUE(outshines(scene, furnace(1.0f))) << "a screen";
  EXPECT_FALSE(outshines(scene, furnace(600.0f))) << "in daylight";
  // A small bulb is no great part of the surface; what it shines on is.
  Scene room = scene_of({cube(1.0f), cube(0.01f, vec3(0, 1.5f, 0))});
  room.materials.emplace_back();
  room.meshes[0].primitives[1].material = 1;
  room.materials[1].emission = vec3(10);
  EXPECT_FALSE(outshines(room, furnace(1.0f)));
  room.materials[1].emission = vec3(1e6f);
  EXPECT_TRUE(outshines(room, furnace(1.0f)));
  // One that is seen on less than a tenth of the surface, and lights next to nothing, decides nothing either.
  Scene lantern = scene_of({cube(1.0f), cube(0.2f, vec3(0, 1.5f, 0))});
  lantern.materials.emplace_back();
  lantern.meshes[0].primitives[1].material = 1;
  lantern.materials[1].emission = vec3(5);
  EXPECT_FALSE(outshines(lantern, furnace(1.0f)));
  lantern.materials[1].emission = vec3(500);
  EXPECT_TRUE(outshines(lantern, furnace(1.0f)));
  // Unlit surfaces show a colour, and give no light.
  room.materials[1].unlit = true;
  EXPECT_FALSE(outshines(room, furnace(1.0f)));
}

TEST(unit_scene_brightness, the_studios_exposure_is_kept_where_nothing_shines) {
  EXPECT_FALSE(outshines(scene_of({cube(1.0f)}), make_environment("studio")));
  Environment dark = furnace(0.0f);
  EXPECT_FALSE(outshines(scene_of({cube(1.0f)}), dark));
  Light faint;
  faint.intensity = 1e-3f;
  EXPECT_TRUE(outshines(with_lamp(faint, vec3(0, 3, 0)), dark)) << "the only light there is";
}

}  // namespace
}  // namespace candela
