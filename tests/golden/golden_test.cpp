#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <ostream>
#include <string_view>

#include "candela/candela.h"
#include "image/flip.h"
#include "image/image_file.h"
#include "raster/render.h"
#include "shade/color.glsl.h"
#include "unit/gl/gl_fixture.h"

// Pictures that somebody looked at, drawn again. After a change that is meant to show,
//
//     CANDELA_GOLDEN_UPDATE=tests/golden build/dev/tests/golden/candela_golden_tests
//
// writes them anew; look at each before it is committed.

namespace candela {
namespace {

namespace fs = std::filesystem;

/// Mean of FLIP below which a picture is the same. Mesa compiles shaders for the processor it runs on: between vectors
/// of 128 and of 256 bits the pictures here differ by up to 0.00003, and another version of it may round a texel at an
/// edge otherwise. A light that is 5 % brighter is above 0.01.
constexpr double kSame = 0.003;
/// Likewise of demo:materials, whose lamp has a mask: which samples of a pixel its coverage sets is the driver's choice
/// (OpenGL ES 3.0, §4.1.3). The llvmpipes of Mesa 22.3 and 25.0 differ there in 90 pixels, by 0.0054 of the mean.
constexpr double kSameMask = 0.007;

constexpr double kSameTile = 0.05;
/// The lamp and the gauze of demo:materials, which have masks, stand to the right of this column of pixels. Their tiles
/// differ by up to 0.18 between those two llvmpipes, and are left to the mean.
constexpr int kFirstMask = 144;

struct Case {
  const char* name;
  const char* scene;
  const char* environment;
  raster::Settings settings = {};
  shade::ShadingModel shading = shade::shading_model_candela();

  bool has_masks() const { return std::string_view(scene) == "demo:materials"; }
  double bound() const { return has_masks() ? kSameMask : kSame; }
};

// NOLINTNEXTLINE(readability-identifier-naming): as GoogleTest calls it
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

raster::Settings with(const std::function<void(raster::Settings&)>& change) {
  raster::Settings settings;
  change(settings);
  return settings;
}

std::vector<Case> cases() {
  return {{"materials", "demo:materials", "studio"},
          {"materials-sky", "demo:materials", "sky", with([](auto& s) { s.has_soft_shadows = true; })},
          {"lobes", "demo:row-lobes", "studio"},
          {"glass", "demo:row-transmission-roughness", "studio"},
          {"subsurface", "demo:row-subsurface", "sky"},
          {"panel", "demo:cornell", "none"},
          {"relief", "demo:relief", "sky:22"},
          {"occlusion", "demo:materials", "studio", with([](auto& s) { s.occlusion_radius = 0.05f; })},
          {"ue4", "demo:spheres", "studio", {}, shade::shading_model_ue4()},
          {"normals", "demo:materials", "studio", with([](auto& s) { s.quantity = raster::Quantity::normal; })}};
}

// NOLINTNEXTLINE(readability-identifier-naming): as its suite
class golden : public test::NeedsGl, public testing::WithParamInterface<Case> {};

/// What a display shows, linear.
Image shown(const DisplayImage& display) {
  Image image(display.width, display.height, 3);
  for (std::size_t i = 0; i < display.rgba.size() / 4; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      image.pixels[3 * i + c] = shade::srgb_decode_channel(static_cast<float>(display.rgba[4 * i + c]) / 255.0f);
    }
  }
  return image;
}

DisplayImage draw(const Case& c, float brightness = 1.0f) {
  constexpr ivec2 kSize{192, 128};
  const Scene scene = load(c.scene);
  const Environment environment = make_environment(c.environment);
  raster::Settings settings = c.settings;
  settings.width = kSize.x, settings.height = kSize.y;
  settings.frames = 4;
  const Film film = raster::Drawer(borrowed(scene), environment, c.shading).render(default_view(scene, 1.5f), settings);
  DevelopSettings develop_settings = default_develop(scene, environment);
  develop_settings.dither = false;
  develop_settings.background = vec3(0.0f);
  develop_settings.exposure = brightness * develop_settings.exposure.value_or(metered_exposure(film));
  return develop(film, develop_settings);
}

/// The mean of the picture, and of the worst of those tiles that are judged: what differs in one ball only is lost in
/// the mean.
struct Difference {
  double mean = 0.0;
  double worst_tile = 0.0;
};

Difference difference(const Case& c, const Image& expected, const Image& found) {
  constexpr int kTile = 16;
  const Image map = flip(expected, found);
  Difference d;
  for (int top = 0; top < map.height; top += kTile) {
    for (int left = 0; left < map.width; left += kTile) {
      double sum = 0.0;
      for (int y = top; y < top + kTile; ++y) {
        for (int x = left; x < left + kTile; ++x) sum += static_cast<double>(map.pixels[map.index(x, y)]);
      }
      d.mean += sum / static_cast<double>(map.pixels.size());
      if (!c.has_masks() || left < kFirstMask) d.worst_tile = std::max(d.worst_tile, sum / (kTile * kTile));
    }
  }
  return d;
}

TEST_P(golden, picture_is_as_it_was) {
  const DisplayImage found = draw(GetParam());
  if (const char* folder = std::getenv("CANDELA_GOLDEN_UPDATE")) {
    write_png(fs::path(folder) / (std::string(GetParam().name) + ".png"), found);
    GTEST_SKIP() << "written anew";
  }
  const Image expected = read_image(fs::path(CANDELA_GOLDEN) / (std::string(GetParam().name) + ".png"));
  const Difference d = difference(GetParam(), expected, shown(found));
  RecordProperty("flip", std::to_string(d.mean));
  RecordProperty("flip_worst_tile", std::to_string(d.worst_tile));
  EXPECT_LT(d.mean, GetParam().bound());
  EXPECT_LT(d.worst_tile, kSameTile);
}

INSTANTIATE_TEST_SUITE_P(raster, golden, testing::ValuesIn(cases()), [](const auto& test) {
  std::string name = test.param.name;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST_P(golden, five_percent_more_light_and_a_part_that_is_darker_are_seen) {
  if (std::getenv("CANDELA_GOLDEN_UPDATE") != nullptr) GTEST_SKIP();
  const Image picture = shown(draw(GetParam()));
  Image brighter = picture, patched = picture;
  for (float& channel : brighter.pixels) channel = std::min(1.05f * channel, 1.0f);
  EXPECT_GT(difference(GetParam(), picture, brighter).mean, GetParam().bound());
  // About a ball of the many, a quarter darker.
  const ivec2 from(picture.width / 2 - 12, picture.height / 2 - 12);
  for (int y = from.y; y < from.y + 24; ++y) {
    for (int x = from.x; x < from.x + 24; ++x) patched.set_rgb(x, y, 0.75f * patched.rgb(x, y));
  }
  EXPECT_GT(difference(GetParam(), picture, patched).worst_tile, kSameTile);
}

}  // namespace
}  // namespace candela
