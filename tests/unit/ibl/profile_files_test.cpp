#include "ibl/profile_files.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "base/error.h"
#include "image/cube_file.h"
#include "image/image_file.h"
#include "unit/base/temp_folder.h"
#include "unit/image/labelled_cube.h"

namespace candela::ibl {
namespace {

struct Baked {
  Cubemap specular;
  CubeFaces diffuse = make_cube_faces(8);
  std::vector<dvec3> sh = std::vector<dvec3>(9);
  Image table{4, 4, 3};

  Baked() {
    for (const int size : {16, 8, 4, 2, 1}) specular.levels.push_back(test::labelled_faces(size));
    for (Image& face : diffuse) std::fill(face.pixels.begin(), face.pixels.end(), std::numbers::pi_v<float>);
    for (int i = 0; i < 9; ++i) sh[static_cast<std::size_t>(i)] = dvec3(1.0 + i, 0.5 * i, -0.25 * i);
    std::fill(table.pixels.begin(), table.pixels.end(), 0.25f);
  }
  BakedLight light() const {
    return {.specular = &specular, .diffuse = &diffuse, .sh = sh, .table = &table, .source = "labels"};
  }
};

std::vector<std::string> names(const WrittenFiles& files) {
  std::vector<std::string> result;
  result.reserve(files.paths.size());
  for (const auto& path : files.paths) result.push_back(path.filename().string());
  std::sort(result.begin(), result.end());
  return result;
}

double largest_difference(const CubeFaces& a, const CubeFaces& b) {
  double largest = 0.0;
  for (std::size_t face = 0; face < 6; ++face)
    for (std::size_t i = 0; i < a[face].pixels.size(); ++i)
      largest = std::max(largest, static_cast<double>(std::abs(a[face].pixels[i] - b[face].pixels[i])));
  return largest;
}

TEST(unit_ibl_profile_files, each_engine_gets_what_it_takes) {
  const Baked baked;
  const std::map<std::string_view, std::vector<std::string>> expected{
      {"filament", {"dfg.exr", "dfg.ktx2", "sh.h", "sh.json", "specular.ktx"}},
      {"three",
       {"dfg.exr", "dfg.ktx2", "sh.h", "sh.json", "specular_nx.hdr", "specular_ny.hdr", "specular_nz.hdr",
        "specular_px.hdr", "specular_py.hdr", "specular_pz.hdr"}},
      {"babylon", {"dfg.exr", "dfg.ktx2", "sh.h", "sh.json", "specular.dds"}},
      {"khronos", {"dfg.exr", "dfg.ktx2", "diffuse.ktx2", "specular.ktx2"}},
      {"bevy", {"dfg.exr", "dfg.ktx2", "diffuse.ktx2", "specular.ktx2"}},
      {"godot", {"dfg.exr", "dfg.ktx2", "environment.exr"}},
      {"unreal", {"dfg.exr", "dfg.ktx2", "specular.dds"}},
      {"unity", {"dfg.exr", "dfg.ktx2", "specular.dds"}},
  };
  for (const Profile& profile : profiles()) {
    const test::TempFolder folder;
    const WrittenFiles files = write_for(profile, folder.path(), baked.light());
    EXPECT_EQ(names(files), expected.at(profile.name)) << profile.name;
    EXPECT_EQ(folder.entries(), files.paths.size());
    EXPECT_FALSE(files.loss.any());
  }
}

TEST(unit_ibl_profile_files, cubes_are_read_back_in_the_axes_of_the_world) {
  const Baked baked;
  for (const Profile& profile : profiles()) {
    if (profile.container == ProfileContainer::exr_panorama) continue;
    const test::TempFolder folder;
    const WrittenFiles files = write_for(profile, folder.path(), baked.light());
    const bool has_faces = profile.container == ProfileContainer::hdr_faces;
    const auto specular = std::find_if(files.paths.begin(), files.paths.end(),
                                       [](const auto& path) { return path.stem() == "specular"; });
    // DDS files do not say their axes.
    const bool is_dds = profile.container == ProfileContainer::dds;
    const Cubemap cube = has_faces ? read_cubemap(folder.path())
                         : is_dds  ? read_cubemap(*specular, profile.axes)
                                   : read_cubemap(*specular);
    EXPECT_EQ(cube.levels.size(), profile.is_filtered ? 5u : 1u) << profile.name;
    // Labels are 1 to 3: 6 bits of mantissa are 1/32 there, 5 bits 1/16.
    for (std::size_t level = 0; level < cube.levels.size(); ++level)
      EXPECT_LT(largest_difference(cube.levels[level], baked.specular.levels[level]), 0.04) << profile.name;
  }
}

TEST(unit_ibl_profile_files, diffuse_cubes_are_irradiance_over_pi) {
  const Baked baked;
  const test::TempFolder folder;
  write_for(find_profile("khronos"), folder.path(), baked.light());
  const Cubemap diffuse = read_cubemap(folder / "diffuse.ktx2");
  for (const Image& face : diffuse.levels[0])
    for (const float v : face.pixels) EXPECT_NEAR(v, 1.0f, 1e-3f);
}

TEST(unit_ibl_profile_files, filament_finds_its_harmonics_in_the_file) {
  const Baked baked;
  const test::TempFolder folder;
  write_for(find_profile("filament"), folder.path(), baked.light());
  const TextureInfo info = read_texture_info(folder / "specular.ktx");
  EXPECT_EQ(info.key_values.at("sh"), sh_lines(convert_sh(DiffuseUnit::polynomial_over_pi, baked.sh)));
}

TEST(unit_ibl_profile_files, babylon_evaluates_its_powers_by_its_own_vector) {
  const Baked baked;
  const Profile& babylon = find_profile("babylon");
  const auto world = convert_sh(DiffuseUnit::powers_over_pi, baked.sh);
  const auto turned = sh_for(babylon, baked.sh);
  const auto evaluate = [](const std::vector<dvec3>& q, dvec3 n) {
    return q[0] * n.x + q[1] * n.y + q[2] * n.z + q[3] * n.x * n.x + q[4] * n.y * n.y + q[5] * n.z * n.z +
           q[6] * n.y * n.z + q[7] * n.z * n.x + q[8] * n.x * n.y;
  };
  for (const dvec3 n : {dvec3(1, 0, 0), glm::normalize(dvec3(1, 2, -3)), glm::normalize(dvec3(-3, 1, 1))}) {
    const dvec3 lookup(babylon.sh_axes.lookup_from_world(vec3(n)));
    EXPECT_LT(glm::length(evaluate(turned, lookup) - evaluate(world, n)), 1e-5);
    EXPECT_GT(glm::length(evaluate(world, lookup) - evaluate(world, n)), 1e-2);  // the twin: not turned
  }
  // Any axes, by a profile of their own.
  Profile other = babylon;
  other.sh_axes = *parse_axes("+z-x-y");
  const dvec3 n = glm::normalize(dvec3(0.3, -0.5, 0.8));
  EXPECT_LT(glm::length(evaluate(sh_for(other, baked.sh), dvec3(other.sh_axes.lookup_from_world(vec3(n)))) -
                        evaluate(world, n)),
            1e-5);
  EXPECT_THROW(sh_for(find_profile("bevy"), baked.sh), Error);
}

TEST(unit_ibl_profile_files, suns_that_do_not_fit_are_told) {
  Baked baked;
  baked.specular.levels[0][2].set_rgb(3, 4, vec3(1e6f));
  const test::TempFolder folder;
  const WrittenFiles files = write_for(find_profile("khronos"), folder.path(), {.specular = &baked.specular});
  EXPECT_EQ(files.loss.clamped, 1u);
  EXPECT_EQ(files.loss.largest, 1e6f);
  EXPECT_EQ(names(files), std::vector<std::string>{"specular.ktx2"});
}

TEST(unit_ibl_profile_files, panoramas_are_turned_for_the_engine) {
  const Baked baked;
  const test::TempFolder folder;
  Image panorama(16, 8, 3);
  for (int x = 0; x < 16; ++x)
    for (int y = 0; y < 8; ++y) panorama.set_rgb(x, y, vec3(static_cast<float>(x)));
  BakedLight light = baked.light();
  light.panorama = &panorama;
  write_for(find_profile("godot"), folder.path(), light);
  EXPECT_EQ(read_image(folder / "environment.exr").rgb(0, 0).x, 4.0f);  // a quarter turn
  light.panorama = nullptr;
  write_for(find_profile("godot"), folder.path(), light);
  EXPECT_EQ(read_image(folder / "environment.exr").width, 64);
}

}  // namespace
}  // namespace candela::ibl
