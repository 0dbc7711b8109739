#include "scene/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <glm/gtc/matrix_transform.hpp>

#include "base/error.h"

namespace candela {
namespace {

using ::testing::HasSubstr;

Node node(int parent, vec3 translation) {
  Node n;
  n.parent = parent;
  n.parent_from_node = glm::translate(mat4(1), translation);
  return n;
}

/// One triangle under a parent, with everything else that validate looks at.
Scene small_scene() {
  Scene scene;
  scene.materials.resize(1);
  Primitive p;
  p.positions = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}};
  p.normals.assign(3, vec3(0, 0, 1));
  p.triangles = {{0, 1, 2}};
  scene.meshes = {Mesh{"mesh", {p}}};
  scene.nodes = {node(1, {10, 0, 0}), node(-1, {0, 5, 0})};
  scene.nodes[0].mesh = 0;
  auto image = std::make_shared<TextureImage>();
  image->width = image->height = 1;
  image->pixels.assign(4, 0);
  scene.images = {image};
  scene.textures.resize(1);
  scene.textures[0].image = 0;
  scene.materials[0].normal_texture.texture = 0;
  scene.cameras.resize(1);
  scene.lights.resize(1);
  update_world_transforms(scene);
  return scene;
}

std::string error_of(const Scene& scene) {
  try {
    validate(scene);
  } catch (const Error& error) {
    return error.what();
  }
  return "valid";
}

TEST(unit_scene, world_transforms_follow_parents_that_come_later) {
  Scene scene;
  scene.nodes = {node(2, {1, 0, 0}), node(0, {0, 1, 0}), node(3, {0, 0, 1}), node(-1, {5, 5, 5})};
  update_world_transforms(scene);
  EXPECT_EQ(scene.nodes[1].world_from_node[3], vec4(6, 6, 6, 1));
  EXPECT_EQ(scene.nodes[2].world_from_node[3], vec4(5, 5, 6, 1));
}

TEST(unit_scene, parents_apply_from_the_left) {
  Scene scene;
  scene.nodes = {node(-1, {1, 0, 0}), node(0, {1, 0, 0})};
  scene.nodes[0].parent_from_node = glm::scale(mat4(1), vec3(2));
  update_world_transforms(scene);
  EXPECT_EQ(scene.nodes[1].world_from_node[3], vec4(2, 0, 0, 1));
}

TEST(unit_scene, cycles_and_absent_parents_are_errors) {
  Scene scene;
  scene.nodes = {node(1, {}), node(2, {}), node(0, {})};
  EXPECT_THROW(update_world_transforms(scene), Error);
  scene.nodes = {node(0, {})};
  EXPECT_THROW(update_world_transforms(scene), Error);
  scene.nodes = {node(-1, {}), node(2, {}), node(1, {})};
  EXPECT_THROW(update_world_transforms(scene), Error);
  scene.nodes = {node(7, {})};
  EXPECT_THROW(update_world_transforms(scene), Error);
  scene.nodes = {node(-2, {})};
  EXPECT_THROW(update_world_transforms(scene), Error);
}

TEST(unit_scene, a_long_chain_is_linear_in_time) {
  Scene scene;
  constexpr int count = 300000;
  for (int i = 0; i < count; ++i) scene.nodes.push_back(node(i + 1 < count ? i + 1 : -1, {0.5f, 0, 0}));
  update_world_transforms(scene);
  EXPECT_EQ(scene.nodes[0].world_from_node[3].x, 150000.0f);
}

TEST(unit_scene, bounds_are_those_of_the_transformed_vertices) {
  Scene scene = small_scene();
  scene.nodes[0].parent_from_node = glm::rotate(mat4(1), kPi / 4, vec3(0, 0, 1));
  update_world_transforms(scene);
  const Box3 box = world_bounds(scene);
  // The corner of the mesh's own box would reach further than any vertex.
  EXPECT_NEAR(box.lower.x, -std::sqrt(2.0f), 1e-6f);
  EXPECT_NEAR(box.upper.x, std::sqrt(0.5f), 1e-6f);
  EXPECT_NEAR(box.lower.y, 5, 1e-6f);
  EXPECT_NEAR(box.upper.y, 5 + std::sqrt(2.0f), 1e-6f);
  scene.nodes[0].mesh = -1;
  EXPECT_TRUE(world_bounds(scene).empty());
}

TEST(unit_scene, the_ranges_that_formulas_rely_on_are_checked) {
  struct Case {
    float Material::*field;
    float wrong;
  };
  for (const Case& c : {Case{&Material::opacity, 1.5f},
                        {&Material::metallic, -0.5f},
                        {&Material::roughness, 1.5f},
                        {&Material::ior, 0.5f},
                        {&Material::clearcoat, 1.5f},
                        {&Material::clearcoat_roughness, -0.5f},
                        {&Material::sheen_roughness, 1.5f},
                        {&Material::anisotropy, -0.5f},
                        {&Material::iridescence, 2},
                        {&Material::iridescence_ior, 0.9f},
                        {&Material::iridescence_thickness_min_nm, -1},
                        {&Material::iridescence_thickness_max_nm, -1},
                        {&Material::transmission, 1.5f},
                        {&Material::thickness, -1},
                        {&Material::attenuation_distance, 0},
                        {&Material::dispersion, -1},
                        {&Material::diffuse_transmission, 1.5f},
                        {&Material::sheet_scatter, 1.5f},
                        {&Material::scatter_anisotropy, -1}}) {
    Scene scene = small_scene();
    scene.materials[0].*c.field = c.wrong;
    EXPECT_THAT(error_of(scene), HasSubstr("materials/0: ")) << c.wrong;
  }
  for (vec3 Material::*const color :
       {&Material::sheen_color, &Material::attenuation_color, &Material::conductor_n, &Material::multiscatter_color,
        &Material::diffuse_transmission_color, &Material::conductor_k}) {
    Scene scene = small_scene();
    (scene.materials[0].*color).y = -1;
    EXPECT_THAT(error_of(scene), HasSubstr("materials/0: "));
  }
  Scene scene = small_scene();
  scene.materials[0].attenuation_color = vec3(0);
  EXPECT_THAT(error_of(scene), HasSubstr("materials/0: "));
  scene = small_scene();
  scene.materials[0].ior = 0;
  EXPECT_EQ(error_of(scene), "valid");
}

TEST(unit_scene, lobes_are_those_that_have_an_effect) {
  using Lobes = std::vector<std::string_view>;
  Material m;
  EXPECT_EQ(material_lobes(m), Lobes{"metallic-roughness"});
  m.anisotropy = m.iridescence = m.clearcoat = m.transmission = m.diffuse_transmission = m.thickness = 0.5f;
  m.sheen_color = m.multiscatter_color = m.conductor_k = vec3(0.5f);
  m.dispersion = 1;
  EXPECT_EQ(material_lobes(m),
            (Lobes{"metallic-roughness", "conductor", "anisotropy", "iridescence", "clearcoat", "sheen", "transmission",
                   "diffuse transmission", "volume", "scattering", "dispersion"}));
  // Of a sheet what it transmits may scatter, too.
  m.thickness = 0, m.sheet_scatter = 0.5f;
  EXPECT_EQ(material_lobes(m).back(), "scattering");
  m.thickness = 0.5f, m.sheet_scatter = 0;
  // Nothing that is inside a volume shows when no light enters it.
  m.transmission = m.diffuse_transmission = 0;
  EXPECT_EQ(material_lobes(m).back(), "sheen");
  m = {};
  m.specular_glossiness = true;
  EXPECT_EQ(material_lobes(m), Lobes{"specular-glossiness"});
  m.unlit = true;
  EXPECT_EQ(material_lobes(m), Lobes{"unlit"});
}

TEST(unit_scene, a_good_scene_is_valid_and_each_broken_promise_is_found) {
  EXPECT_EQ(error_of(small_scene()), "valid");
  const auto broken = [](auto change) {
    Scene scene = small_scene();
    change(scene);
    return error_of(scene);
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(broken([](Scene& s) { s.materials.clear(); }), HasSubstr("no material"));
  EXPECT_THAT(broken([](Scene& s) { s.nodes[0].parent = 2; }), HasSubstr("nodes/0: the parent"));
  EXPECT_THAT(broken([](Scene& s) { s.nodes[1].mesh = 1; }), HasSubstr("nodes/1: the mesh"));
  EXPECT_THAT(broken([](Scene& s) { s.nodes[1].camera = 1; }), HasSubstr("the camera"));
  EXPECT_THAT(broken([](Scene& s) { s.nodes[1].light = -2; }), HasSubstr("the light"));
  EXPECT_THAT(broken([&](Scene& s) { s.nodes[1].world_from_node[2][1] = nan; }), HasSubstr("matrix is not finite"));
  EXPECT_THAT(broken([](Scene& s) { s.meshes[0].primitives[0].normals.clear(); }),
              HasSubstr("meshes/0/primitives/0: needs as many normals"));
  EXPECT_THAT(broken([](Scene& s) { s.meshes[0].primitives[0].tangents.resize(2); }), HasSubstr("as many tangents"));
  EXPECT_THAT(broken([](Scene& s) { s.meshes[0].primitives[0].uvs[1].resize(4); }), HasSubstr("as many uvs"));
  EXPECT_THAT(broken([](Scene& s) { s.meshes[0].primitives[0].colors.resize(1); }), HasSubstr("as many colours"));
  EXPECT_THAT(broken([](Scene& s) { s.meshes[0].primitives[0].triangles[0].z = 3; }),
              HasSubstr("a vertex that does not exist"));
  EXPECT_THAT(broken([](Scene& s) { s.meshes[0].primitives[0].material = 1; }), HasSubstr("material does not exist"));
  EXPECT_THAT(broken([&](Scene& s) { s.meshes[0].primitives[0].positions[1].z = nan; }),
              HasSubstr("a vertex is not finite"));
  EXPECT_THAT(broken([&](Scene& s) { s.materials[0].roughness = nan; }),
              HasSubstr("materials/0: roughness nan lies outside 0 to 1"));
  EXPECT_THAT(broken([](Scene& s) { s.materials[0].emissive_texture.texture = 1; }),
              HasSubstr("the texture does not exist"));
  EXPECT_THAT(broken([](Scene& s) { s.materials[0].normal_texture.uv_set = -1; }), HasSubstr("uv set"));
  EXPECT_THAT(broken([&](Scene& s) { s.materials[0].normal_texture.transform[2].x = nan; }),
              HasSubstr("texture transform"));
  EXPECT_THAT(broken([](Scene& s) { s.textures[0].image = -1; }), HasSubstr("textures/0: the image"));
  EXPECT_THAT(broken([](Scene& s) { s.images[0] = nullptr; }), HasSubstr("images/0: the image is missing"));
  EXPECT_THAT(broken([](Scene& s) { s.images[0] = std::make_shared<TextureImage>(); }), HasSubstr("empty"));
  EXPECT_THAT(broken([](Scene& s) { s.cameras[0].projection = PerspectiveCamera{.yfov = 0, .aspect_ratio = {}}; }),
              HasSubstr("field of view"));
  EXPECT_THAT(broken([](Scene& s) { s.cameras[0].projection = OrthographicCamera{.xmag = 1, .ymag = 0}; }),
              HasSubstr("size"));
  EXPECT_THAT(broken([](Scene& s) { s.lights[0].inner_cone = 1; }), HasSubstr("cones"));
  EXPECT_THAT(broken([](Scene& s) { s.lights[0].range = 0; }), HasSubstr("range"));
  EXPECT_THAT(broken([](Scene& s) { s.lights[0].polynomial = vec3(0); }), HasSubstr("polynomial"));
  EXPECT_THAT(broken([](Scene& s) { s.lights[0].polynomial.y = -1; }), HasSubstr("polynomial"));
  EXPECT_THAT(broken([](Scene& s) { s.lights[0].ies = 0; }), HasSubstr("the IES profile does not exist"));
  const auto with_profile = [&](auto change) {
    return broken([&](Scene& s) {
      s.ies_profiles.resize(1);
      s.ies_profiles[0].vertical_deg = {0, 90};
      s.ies_profiles[0].horizontal_deg = {0, 180, 360};
      s.ies_profiles[0].candela.assign(6, 1.0f);
      s.lights[0].ies = 0;
      change(s);
    });
  };
  EXPECT_EQ(with_profile([](Scene&) {}), "valid");
  EXPECT_THAT(with_profile([](Scene& s) { s.lights[0].type = LightType::spot; }), HasSubstr("only a point"));
  for (const auto& change : std::vector<std::function<void(IesProfile&)>>{
           [](IesProfile& p) { p.candela.pop_back(); }, [](IesProfile& p) { p.candela[0] = -1; },
           [&](IesProfile& p) { p.candela[0] = nan; }, [](IesProfile& p) { p.vertical_deg[1] = 0; },
           [](IesProfile& p) { p.vertical_deg[1] = 181; }, [](IesProfile& p) { p.horizontal_deg[2] = 270; },
           [](IesProfile& p) { p.horizontal_deg[1] = 0; }}) {
    EXPECT_THAT(with_profile([&](Scene& s) { change(s.ies_profiles[0]); }), HasSubstr("ies_profiles/0"));
  }
}

}  // namespace
}  // namespace candela
