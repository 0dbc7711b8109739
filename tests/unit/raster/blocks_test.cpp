#include "raster/blocks.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "raster/material_block.h"
#include "raster/programs.h"
#include "unit/gl/gl_fixture.h"

namespace candela {
namespace {

using namespace raster;

class unit_blocks : public test::NeedsGl {};  // NOLINT(readability-identifier-naming): a suite is named as its laws

struct Member {
  std::string name;
  std::size_t offset;
};

/// Every member of an array's entry, in its first and its last.
template <typename Block, std::size_t N>
void add_entries(std::vector<Member>& all, const std::string& array, std::size_t at, const std::array<Block, N>&,
                 const std::vector<Member>& members) {
  for (const std::size_t i : {std::size_t{0}, N - 1}) {
    for (const Member& m : members) {
      all.push_back({array + "[" + std::to_string(i) + "]." + m.name, at + i * sizeof(Block) + m.offset});
    }
  }
}

#define CANDELA_MEMBER(Block, name) \
  { #name, offsetof(Block, name) }

std::vector<Member> members_of_frame() {
  return {CANDELA_MEMBER(FrameBlock, clip_from_world), CANDELA_MEMBER(FrameBlock, eye),
          CANDELA_MEMBER(FrameBlock, is_perspective),  CANDELA_MEMBER(FrameBlock, back),
          CANDELA_MEMBER(FrameBlock, light_levels),    CANDELA_MEMBER(FrameBlock, least_roughness),
          CANDELA_MEMBER(FrameBlock, sample_area),     CANDELA_MEMBER(FrameBlock, picture_height),
          CANDELA_MEMBER(FrameBlock, picture_levels),  CANDELA_MEMBER(FrameBlock, light_radius),
          CANDELA_MEMBER(FrameBlock, noise_turn),      CANDELA_MEMBER(FrameBlock, shadow_share),
          CANDELA_MEMBER(FrameBlock, light_count),     CANDELA_MEMBER(FrameBlock, shown_parts),
          CANDELA_MEMBER(FrameBlock, shown_light),     CANDELA_MEMBER(FrameBlock, area_count),
          CANDELA_MEMBER(FrameBlock, light_turn)};
}

std::vector<Member> members_of_lights() {
  const LightsBlock b;
  std::vector<Member> all;
  add_entries(
      all, "lights", offsetof(LightsBlock, lights), b.lights,
      {CANDELA_MEMBER(LightEntry, position), CANDELA_MEMBER(LightEntry, kind), CANDELA_MEMBER(LightEntry, direction),
       CANDELA_MEMBER(LightEntry, range), CANDELA_MEMBER(LightEntry, color), CANDELA_MEMBER(LightEntry, falloff),
       CANDELA_MEMBER(LightEntry, polynomial), CANDELA_MEMBER(LightEntry, profile), CANDELA_MEMBER(LightEntry, across),
       CANDELA_MEMBER(LightEntry, handedness), CANDELA_MEMBER(LightEntry, cos_inner),
       CANDELA_MEMBER(LightEntry, cos_outer), CANDELA_MEMBER(LightEntry, sun_radius),
       CANDELA_MEMBER(LightEntry, first_shadow), CANDELA_MEMBER(LightEntry, shadow_count)});
  add_entries(all, "shadows", offsetof(LightsBlock, shadows), b.shadows,
              {CANDELA_MEMBER(ShadowEntry, from_world), CANDELA_MEMBER(ShadowEntry, texel),
               CANDELA_MEMBER(ShadowEntry, is_perspective), CANDELA_MEMBER(ShadowEntry, near),
               CANDELA_MEMBER(ShadowEntry, far)});
  add_entries(
      all, "areas", offsetof(LightsBlock, areas), b.areas,
      {CANDELA_MEMBER(AreaEntry, corner_0), CANDELA_MEMBER(AreaEntry, radius), CANDELA_MEMBER(AreaEntry, corner_1),
       CANDELA_MEMBER(AreaEntry, half_side), CANDELA_MEMBER(AreaEntry, corner_2), CANDELA_MEMBER(AreaEntry, extent),
       CANDELA_MEMBER(AreaEntry, corner_3), CANDELA_MEMBER(AreaEntry, is_body), CANDELA_MEMBER(AreaEntry, color),
       CANDELA_MEMBER(AreaEntry, has_two_sides), CANDELA_MEMBER(AreaEntry, first_shadow),
       CANDELA_MEMBER(AreaEntry, shadow_count)});
  return all;
}

#undef CANDELA_MEMBER

void expect_offsets(const gl::Program& program, const std::string& block, std::size_t size,
                    const std::vector<Member>& members) {
  const GLuint index = glGetUniformBlockIndex(program.id(), block.c_str());
  ASSERT_NE(index, GL_INVALID_INDEX) << block;
  GLint bytes = 0;
  glGetActiveUniformBlockiv(program.id(), index, GL_UNIFORM_BLOCK_DATA_SIZE, &bytes);
  EXPECT_EQ(static_cast<std::size_t>(bytes), size) << block;
  for (const Member& m : members) {
    const char* name = m.name.c_str();
    GLuint uniform = GL_INVALID_INDEX;
    glGetUniformIndices(program.id(), 1, &name, &uniform);
    ASSERT_NE(uniform, GL_INVALID_INDEX) << "the shaders have no " << m.name;
    GLint offset = -1;
    glGetActiveUniformsiv(program.id(), 1, &uniform, GL_UNIFORM_OFFSET, &offset);
    EXPECT_EQ(static_cast<std::size_t>(offset), m.offset) << m.name;
  }
}

/// Members, arrays counted by their entries, that the driver has in a block.
std::size_t members_in(const gl::Program& program, const std::string& block) {
  GLint count = 0;
  glGetActiveUniformBlockiv(program.id(), glGetUniformBlockIndex(program.id(), block.c_str()),
                            GL_UNIFORM_BLOCK_ACTIVE_UNIFORMS, &count);
  return static_cast<std::size_t>(count);
}

TEST_F(unit_blocks, a_materials_numbers_lie_where_the_driver_reads_them) {
  const auto context = gl::Context::open();
  Programs programs(shade::shading_model_candela());
  const gl::Program& program = *programs.mesh(MaterialKey{}, PassKey{}).program;
  std::vector<Member> members;
  for (const BlockField& field : material_block_fields()) members.push_back({field.name, field.offset});
  expect_offsets(program, "Material", material_block_size(), members);
  // Of every slot's transform four members; above are those of two slots.
  EXPECT_EQ(members_in(program, "Material"), members.size() - 8 + 4 * kTextureSlots);
}

TEST_F(unit_blocks, members_lie_where_the_driver_reads_them) {
  const auto context = gl::Context::open();
  Programs programs(shade::shading_model_candela());
  PassKey pass;
  pass.has_lights = pass.has_areas = pass.has_soft_shadows = true;
  const gl::Program& program = *programs.mesh(MaterialKey{}, pass).program;
  const std::vector<Member> frame = members_of_frame(), lights = members_of_lights();
  expect_offsets(program, "Frame", sizeof(FrameBlock), frame);
  expect_offsets(program, "Lights", sizeof(LightsBlock), lights);
  // None is left out above: a member that only the shaders have would be read as nothing.
  EXPECT_EQ(members_in(program, "Frame"), frame.size());
  EXPECT_EQ(members_in(program, "Lights"), 15u * kMostLights + 5u * kMostShadows + 12u * kMostAreas);
}

}  // namespace
}  // namespace candela
