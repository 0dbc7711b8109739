#include "viewer/model.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "scene/material_table.h"

namespace candela::viewer {
namespace {

Shot shot_of(const std::string& scene) {
  Shot shot;
  shot.scene = scene;
  shot.engine = Engine::raster;
  return shot;
}

/// A value within the range that is not the one at hand.
float another(const Range& range, float value) {
  for (const float candidate : {0.25f, 0.5f, 1.5f, 1.25f}) {
    if (range.contains(candidate) && candidate != value) return candidate;
  }
  return range.upper;
}

TEST(unit_viewer_model, every_row_of_the_material_table_can_be_edited_and_taken_back) {
  Model model(shot_of("demo:spheres"));
  const Scene& first = *model.first();
  const int number = number_of(first.materials, 0);
  std::uint64_t version = 0;
  for (std::size_t row = 0; row < kMaterialProperties.size(); ++row) {
    const MaterialProperty& property = kMaterialProperties[row];
    auto edits = std::make_shared<Edits>();
    edits->version = ++version;
    vec3 value(0.0f);
    for (int i = 0; i < property.member.size(); ++i) {
      value[i] = another(property.range, property.member.at(first.materials[0], i));
    }
    edits->materials[number].rows[row] = value;
    Moment moment = model.first_moment();
    moment.edits = edits;
    const std::shared_ptr<const Scene> scene = model.scene(moment);  // which validates it
    for (int i = 0; i < property.member.size(); ++i) {
      EXPECT_EQ(property.member.at(scene->materials[0], i), value[i]) << property.name;
    }
    Material restored = scene->materials[0];
    for (int i = 0; i < property.member.size(); ++i) {
      property.member.at(restored, i) = property.member.at(first.materials[0], i);
    }
    EXPECT_EQ(restored, first.materials[0]) << property.name << " changes something else";
  }
  EXPECT_EQ(model.scene(model.first_moment()), model.first());
}

TEST(unit_viewer_model, a_lobe_that_needs_tangents_gets_them) {
  Model model(shot_of("demo:spheres"));
  const auto row =
      static_cast<std::size_t>(std::find_if(kMaterialProperties.begin(), kMaterialProperties.end(),
                                            [](const MaterialProperty& p) { return p.name == "anisotropy"; }) -
                               kMaterialProperties.begin());
  auto edits = std::make_shared<Edits>();
  edits->version = 1;
  edits->materials[number_of(model.first()->materials, 0)].rows[row] = vec3(0.8f);
  Moment moment = model.first_moment();
  moment.edits = edits;
  const std::shared_ptr<const Scene> scene = model.scene(moment);
  bool is_there = false;
  for (const Mesh& mesh : scene->meshes) {
    for (const Primitive& primitive : mesh.primitives) {
      if (primitive.material != 0) continue;
      is_there = true;
      EXPECT_EQ(primitive.tangents.size(), primitive.positions.size());
    }
  }
  EXPECT_TRUE(is_there);
}

TEST(unit_viewer_model, what_an_edit_does_not_touch_is_not_made_again) {
  Model model(shot_of("demo:spheres"));
  auto edits = std::make_shared<Edits>();
  edits->version = 1;
  edits->materials[number_of(model.first()->materials, 0)].rows[2] = vec3(0.3f);
  Moment moment = model.first_moment();
  moment.edits = edits;
  const std::shared_ptr<const Scene> scene = model.scene(moment);
  ASSERT_EQ(scene->meshes.size(), model.first()->meshes.size());
  for (std::size_t i = 0; i < scene->meshes.size(); ++i) {
    EXPECT_EQ(scene->meshes[i].identity, model.first()->meshes[i].identity);
  }
  EXPECT_EQ(model.scene(moment), scene) << "the same moment is the same scene";
}

}  // namespace
}  // namespace candela::viewer
