#include "candela/difference.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "base/error.h"
#include "base/file.h"
#include "unit/base/temp_folder.h"
#include "unit/io/gltf_builder.h"

namespace candela {
namespace {

using test::TempFolder;

Film grey(float value, float alpha = 1.0f) {
  Film film;
  film.beauty = Image(8, 6, 4);
  for (std::size_t i = 0; i < film.beauty.pixels.size(); ++i) {
    film.beauty.pixels[i] = i % 4 == 3 ? alpha : value * alpha;
  }
  return film;
}

Film with_depth(Film film, float depth) {
  Image& layer = film.layers[Layer::depth] = Image(8, 6, 1);
  for (float& metres : layer.pixels) metres = depth;
  return film;
}

/// Writes both and compares them.
PictureDifference difference(const TempFolder& folder, const Film& first, const Film& second,
                             const std::string& extension, const DifferenceSettings& settings = {}) {
  const std::filesystem::path a = folder.path() / ("a" + extension);
  const std::filesystem::path b = folder.path() / ("b" + extension);
  const DevelopSettings develop{.exposure = 1.0f, .tone_curve = ToneCurve::linear, .dither = false};
  write_film(a, first, develop);
  write_film(b, second, develop);
  return compare_pictures({a, {}}, {b, {}}, settings);
}

TEST(unit_candela_difference, equal_pictures_have_none_and_a_pixel_counts_once) {
  const TempFolder folder;
  Film changed = with_depth(grey(0.5f), 2.0f);
  EXPECT_EQ(difference(folder, changed, changed, ".exr").flip, 0.0);
  changed.beauty.at(3, 2)[1] = 0.75f;
  const PictureDifference d = difference(folder, with_depth(grey(0.5f), 2.0f), changed, ".exr");
  EXPECT_GT(d.flip, 0.0);
  EXPECT_EQ(d.layers.at(0).changed, 1u);
  EXPECT_FLOAT_EQ(static_cast<float>(d.layers.at(0).max), 0.25f);
  EXPECT_NEAR(d.layers.at(0).mean, 0.25 / (8 * 6 * 3), 1e-9) << "an opaque picture has three channels";
  EXPECT_EQ(d.layers.at(1).layer, "depth");
  EXPECT_EQ(d.layers.at(1).changed, 0u);
  EXPECT_EQ(difference(folder, grey(0.5f), changed, ".exr").unmatched, std::vector<std::string>{"depth"});
}

TEST(unit_candela_difference, a_change_within_the_tolerance_is_none) {
  const TempFolder folder;
  EXPECT_EQ(difference(folder, grey(0.5f), grey(0.51f), ".exr", {.tolerance = 0.02}).layers[0].changed, 0u);
  EXPECT_EQ(difference(folder, grey(0.5f), grey(0.51f), ".exr", {.tolerance = 0.005}).layers[0].changed, 48u);
}

TEST(unit_candela_difference, values_of_a_display_are_those_that_are_shown) {
  const TempFolder folder;
  const PictureDifference d = difference(folder, grey(0.0f), grey(0.2140411f), ".png");  // sRGB: one half
  EXPECT_TRUE(d.is_display);
  EXPECT_NEAR(d.layers[0].max, 0.5, 0.5 / 255.0);
}

TEST(unit_candela_difference, what_is_infinitely_far_in_both_is_the_same_and_in_one_is_broken) {
  const TempFolder folder;
  const Film far = with_depth(grey(0.5f), kInfinity);
  EXPECT_EQ(difference(folder, far, far, ".exr").layers.at(1).changed, 0u);
  const LayerDifference d = difference(folder, far, with_depth(grey(0.5f), 3.0f), ".exr").layers.at(1);
  EXPECT_EQ(d.broken, 48u);
  EXPECT_EQ(d.changed, 48u);
  const Film nan = with_depth(grey(0.5f), std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(difference(folder, nan, nan, ".exr").layers.at(1).broken, 48u) << "never equal to anything";
}

TEST(unit_candela_difference, transparency_counts_where_it_shows) {
  const TempFolder folder;
  const PictureDifference d = difference(folder, grey(0.0f), grey(0.0f, 0.5f), ".png");
  EXPECT_GT(d.flip, 0.3) << "both are black over black, but not over white";
  EXPECT_EQ(d.layers[0].changed, 48u);
}

TEST(unit_candela_difference, linear_pictures_are_seen_with_the_exposure_of_the_first) {
  const TempFolder folder;
  EXPECT_GT(difference(folder, grey(0.01f), grey(0.02f), ".exr").flip, 0.1) << "a stop brighter, not metered away";
  const auto first_beside = [&](float first, float second) {
    return difference(folder, grey(first), grey(second), ".exr").first.rgba;
  };
  EXPECT_EQ(first_beside(0.01f, 0.02f), first_beside(0.08f, 0.02f)) << "the second has no say in it";
  const double dark = difference(folder, grey(0.01f), grey(0.02f), ".exr", {.exposure = 1.0f}).flip;
  const double bright = difference(folder, grey(0.01f), grey(0.02f), ".exr", {.exposure = 16.0f}).flip;
  EXPECT_LT(dark, 0.7 * bright);
}

TEST(unit_candela_difference, linear_pictures_are_seen_with_the_tone_curve) {
  const TempFolder folder;
  for (const ToneCurve curve : {ToneCurve::linear, ToneCurve::pbr_neutral, ToneCurve::aces}) {
    const DevelopSettings shown{.exposure = 1.0f, .tone_curve = curve, .dither = false};
    const auto d = difference(folder, grey(0.9f), grey(0.5f), ".exr", {.exposure = 1.0f, .tone_curve = curve});
    EXPECT_EQ(d.first.rgba, develop(grey(0.9f), shown).rgba);
    EXPECT_EQ(d.second.rgba, develop(grey(0.5f), shown).rgba);
  }
}

TEST(unit_candela_difference, a_picture_without_alpha_is_opaque) {
  const TempFolder folder;
  Film with_a_hole = grey(0.0f);
  with_a_hole.beauty.at(3, 2)[3] = 0.5f;
  for (const bool is_first : {true, false}) {
    const Film &first = is_first ? with_a_hole : grey(0.0f), &second = is_first ? grey(0.0f) : with_a_hole;
    EXPECT_EQ(difference(folder, first, second, ".exr").layers[0].changed, 1u);
  }
}

TEST(unit_candela_difference, sizes_that_differ_are_told_with_both) {
  const TempFolder folder;
  Film wide = grey(0.5f);
  wide.beauty = Image(9, 6, 4);
  try {
    difference(folder, grey(0.5f), wide, ".exr");
    FAIL() << "compared";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("9x6"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("8x6"), std::string::npos) << error.what();
  }
}

TEST(unit_candela_difference, folders_are_paired_by_the_names_below_them) {
  const TempFolder folder;
  std::filesystem::create_directories(folder.path() / "a/sub");
  std::filesystem::create_directories(folder.path() / "b/sub");
  for (const char* name : {"a/sub/x.png", "b/sub/x.png", "a/only.exr"})
    write_film(folder.path() / name, grey(0.5f), {});
  const std::vector<FilePair> pairs = picture_pairs(folder.path() / "a", folder.path() / "b");
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs[0].name, "only.exr");
  EXPECT_TRUE(pairs[0].second.empty());
  EXPECT_EQ(pairs[1].name, "sub/x.png");
  EXPECT_EQ(pairs[1].second, folder.path() / "b/sub/x.png");
  std::filesystem::create_directories(folder.path() / "empty");
  EXPECT_THROW(picture_pairs(folder.path() / "empty", folder.path() / "empty"), Error);
}

Shot small_shot(const std::string& scene) {
  Shot shot{.scene = scene, .size = {24, 16}, .background = Background::transparent, .views = {"front", "top"}};
  shot.environment = "studio";
  shot.traced.samples = 2;
  return shot;
}

std::vector<ShotDifference> differences(const Shot& first, const Shot& second) {
  std::vector<ShotDifference> all;
  compare_shots(first, second, {}, [&](ShotDifference d) { all.push_back(std::move(d)); });
  return all;
}

TEST(unit_candela_difference, a_scene_is_like_itself_in_the_pictures_that_a_take_makes_of_it) {
  for (const char* scene : {"demo:spheres", "demo:cornell", "demo:row-transmission-roughness"}) {
    const Shot shot = small_shot(scene);
    const std::vector<ShotDifference> all = differences(shot, shot);
    ASSERT_EQ(all.size(), 2u);
    std::vector<DisplayImage> pictures;
    Take(shot).render([&](TakenPicture p) {
      p.develop.dither = false;
      pictures.push_back(develop(p.film, p.develop));
    });
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(all[i].index, i);
      EXPECT_EQ(all[i].label.view, shot.views[i]);
      EXPECT_EQ(all[i].difference.flip, 0.0);
      EXPECT_EQ(all[i].difference.layers.at(0).changed, 0u);
      EXPECT_EQ(all[i].difference.first.rgba, pictures[i].rgba) << scene << " " << i;
    }
  }
}

TEST(unit_candela_difference, two_scenes_are_seen_from_the_same_places_that_show_both) {
  const Shot small = small_shot("demo:spheres"), large = small_shot("demo:cornell");
  Take first(small), second(large);
  second.prepare_beside(first);
  const Scene a = load(small.scene), b = load(large.scene);
  Extent both(a);
  both.add(Extent(b));
  ASSERT_EQ(first.views().size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const View expected = frame(both, {.orbit = named_orbit(small.views[i]), .aspect = 1.5f});
    EXPECT_EQ(first.views()[i].world_from_camera, expected.world_from_camera);
    EXPECT_EQ(second.views()[i].world_from_camera, expected.world_from_camera);
  }
  EXPECT_EQ(first.develop().exposure, second.develop().exposure);
  EXPECT_GT(differences(small, large).at(0).difference.flip, 0.01);
}

TEST(unit_candela_difference, glass_differs_in_the_colour_of_what_is_seen_through_it) {
  const TempFolder folder;
  const auto pane = [&](const std::string& name, const std::vector<float>& color) {
    io::test::Builder b = io::test::triangle();
    // Of index 1, so that nothing is reflected.
    io::test::json glass = {
        {"pbrMetallicRoughness", {{"baseColorFactor", color}, {"metallicFactor", 0}}},
        {"extensions",
         {{"KHR_materials_transmission", {{"transmissionFactor", 1}}}, {"KHR_materials_ior", {{"ior", 1}}}}}};
    b.root["materials"] = io::test::json::array({std::move(glass)});
    b.root["extensionsUsed"] = {"KHR_materials_transmission", "KHR_materials_ior"};
    io::test::primitive(b)["material"] = 0;
    write_file(folder.path() / name, b.gltf());
    return small_shot((folder.path() / name).string());
  };
  const Shot red = pane("red.gltf", {1.0f, 0.2f, 0.2f, 1.0f}), green = pane("green.gltf", {0.2f, 1.0f, 0.2f, 1.0f});
  EXPECT_GT(differences(red, green).at(0).difference.flip, 0.1);
  EXPECT_EQ(differences(red, red).at(0).difference.flip, 0.0);
}

TEST(unit_candela_difference, shots_of_other_pictures_are_refused) {
  Shot other = small_shot("demo:spheres");
  other.views = {"front", "left"};
  EXPECT_THROW(differences(small_shot("demo:spheres"), other), Error);
}

TEST(unit_candela_difference, the_map_grows_lighter_with_the_error) {
  Image error(256, 1, 1);
  for (int x = 0; x < 256; ++x) error.at(x, 0)[0] = static_cast<float>(x) / 255.0f;
  const DisplayImage map = error_map(error);
  double last = -1.0;
  for (std::size_t i = 0; i < map.rgba.size(); i += 4) {
    const double lightness = 0.2126 * map.rgba[i] + 0.7152 * map.rgba[i + 1] + 0.0722 * map.rgba[i + 2];
    EXPECT_GE(lightness, last) << i / 4;
    last = lightness;
  }
  EXPECT_EQ(map.rgba[0], 0);
}

}  // namespace
}  // namespace candela
