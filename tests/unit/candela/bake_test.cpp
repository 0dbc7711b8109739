#include "candela/bake.h"

#include <gtest/gtest.h>

#include <functional>
#include <set>

#include "base/error.h"
#include "unit/base/temp_folder.h"

namespace candela {
namespace {

using test::TempFolder;

/// Small, so that it takes no time.
BakeOrder sky() {
  BakeOrder order;
  order.light.environment = "sky";
  order.settings.size = 16;
  order.settings.levels = 2;
  order.settings.irradiance_size = 4;
  order.settings.proof_directions = 0;
  return order;
}

std::set<std::string> files_of(const BakeOrder& order) {
  const TempFolder folder;
  BakeResult result = bake(order);
  write_bake_files(folder.path(), result);
  std::set<std::string> names;
  for (const auto& file : std::filesystem::directory_iterator(folder.path())) {
    names.insert(file.path().filename().string());
  }
  return names;
}

TEST(unit_candela_bake, an_order_follows_its_engine_but_keeps_what_is_given) {
  BakeOrder order = sky();
  order.profile = &ibl::find_profile("filament");
  follow_profile({}, {}, order);
  EXPECT_EQ(order.settings.size, order.profile->size);
  EXPECT_EQ(order.settings.levels, order.profile->levels);
  follow_profile(32, 3, order);
  EXPECT_EQ(order.settings.size, 32);
  ASSERT_EQ(order.settings.roughness.size(), 3u);
  for (int level = 0; level < 3; ++level) {
    EXPECT_EQ(order.settings.roughness[static_cast<std::size_t>(level)],
              static_cast<double>(ibl::roughness_of_level(*order.profile, level, 3, 32)));
  }
  follow_gltf({}, {}, order);
  EXPECT_EQ(order.settings.levels, 5);
  EXPECT_EQ(order.settings.mapping, ibl::Mapping::linear);
  follow_gltf(4, ibl::Mapping::balanced, order);
  EXPECT_EQ(order.settings.levels, 4);
  EXPECT_EQ(order.settings.mapping, ibl::Mapping::balanced);
}

TEST(unit_candela_bake, an_order_that_cannot_be_made_says_which_option_is_wrong) {
  const auto where = [](const std::function<void(BakeOrder&)>& change) {
    BakeOrder order = sky();
    change(order);
    try {
      bake(order);
    } catch (const Error& error) {
      return error.where();
    }
    return std::string("nothing");
  };
  const auto gltf = [](BakeOrder& order) {
    order.format.kind = BakeFormat::Kind::gltf;
    order.settings.mapping = ibl::Mapping::linear;
  };
  EXPECT_EQ(where([](BakeOrder& o) { o.settings.levels = 6; }), "--levels");
  EXPECT_EQ(where([](BakeOrder& o) { o.settings.error = 0.01; }), "--error");
  EXPECT_EQ(where([](BakeOrder& o) {
              o.settings.size = 12;
              o.settings.specular.method = ibl::Method::fis;
            }),
            "--method");
  EXPECT_EQ(where([&](BakeOrder& o) { gltf(o), o.settings.mapping = ibl::Mapping::balanced; }), "--mapping");
  EXPECT_EQ(where([&](BakeOrder& o) { gltf(o), o.settings.size = 12; }), "--size");
  EXPECT_EQ(where([&](BakeOrder& o) { gltf(o), o.settings.sh_order = 1; }), "--sh-order");
  EXPECT_EQ(where([&](BakeOrder& o) { gltf(o), o.settings.sheen = true; }), "--sheen");
  EXPECT_EQ(where([](BakeOrder& o) { o.profile = &ibl::find_profile("three"), o.settings.sheen = true; }), "--sheen");
  EXPECT_EQ(where(gltf), "nothing");
}

TEST(unit_candela_bake, each_format_has_its_files_and_suns_and_tables_theirs) {
  const std::set<std::string> common = {"sh.json", "sh.h"};
  const auto with = [](std::set<std::string> names, const std::set<std::string>& more) {
    names.insert(more.begin(), more.end());
    return names;
  };
  BakeOrder order = sky();
  order.format = {BakeFormat::Kind::texture, "", {.container = TextureContainer::ktx2, .format = TexelFormat::rgba16f}};
  EXPECT_EQ(files_of(order), with(common, {"specular.ktx2", "irradiance.ktx2"}));
  order.format = {BakeFormat::Kind::panorama, "", {}};
  order.extracts_suns = true;
  EXPECT_EQ(files_of(order),
            with(common, {"specular_m0.exr", "specular_m1.exr", "irradiance.exr", "suns.json", "without_suns.exr"}));
  order = {};
  order.table_size = 4;
  std::set<std::string> tables;
  for (const char* stem : {"dfg", "dfg_k_ibl"}) {
    for (const char* extension : {".exr", ".ktx2", ".json", ".h"}) tables.insert(std::string(stem) + extension);
  }
  EXPECT_EQ(files_of(order), tables);
  order = sky();
  order.format.kind = BakeFormat::Kind::gltf;
  follow_gltf(2, {}, order);
  const std::set<std::string> gltf = files_of(order);
  EXPECT_EQ(gltf.size(), 13u) << "two levels of six faces, and the document";
  EXPECT_TRUE(gltf.contains("environment.gltf"));
}

TEST(unit_candela_bake, the_report_is_a_value_with_the_order_and_the_warnings) {
  Diagnostics diagnostics;
  BakeOrder order = sky();
  order.table_size = 4;
  const BakeResult result = bake(order, {.diagnostics = &diagnostics});
  EXPECT_EQ(result.name, "sky");
  EXPECT_EQ(result.order.settings.size, 16);
  ASSERT_TRUE(result.bake.has_value());
  EXPECT_EQ(result.bake->levels.size(), 2u);
  EXPECT_EQ(result.tables->dfg.width, 4);
  EXPECT_EQ(result.warnings.size(), diagnostics.warnings().size());
}

}  // namespace
}  // namespace candela
