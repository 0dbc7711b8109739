#include "raster/image_light.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>

#include "base/file.h"
#include "ibl/cube.h"
#include "image/texture_file.h"
#include "scene/environment.h"
#include "unit/base/temp_folder.h"

namespace candela {
namespace {

namespace fs = std::filesystem;
using raster::BakedLight;

/// Brighter on one side.
Environment sloped(float strength) {
  auto map = std::make_shared<Image>(32, 16, 3);
  for (int y = 0; y < map->height; ++y) {
    for (int x = 0; x < map->width; ++x) map->set_rgb(x, y, vec3(0.2f + strength * static_cast<float>(x)));
  }
  Environment environment;
  environment.map = map;
  return environment;
}

float texel(const BakedLight& light) { return light.irradiance[0].pixels[0]; }

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(folder)) paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  return paths;
}

TEST(unit_raster_image_light, a_whole_cache_is_believed) {
  for (const bool sheen : {false, true}) {
    const test::TempFolder folder;
    const BakedLight baked = raster::bake_light(sloped(0.1f), sheen, folder.path());
    EXPECT_FALSE(baked.is_cached);
    const BakedLight cached = raster::bake_light(sloped(0.1f), sheen, folder.path());
    EXPECT_TRUE(cached.is_cached);
    EXPECT_NEAR(texel(cached), texel(baked), 1e-3f * texel(baked));
    EXPECT_EQ(cached.sheen.empty(), !sheen);
    EXPECT_EQ(files_in(folder.path()).size(), sheen ? 4u : 3u);
  }
}

TEST(unit_raster_image_light, a_cache_that_is_damaged_cut_short_or_gone_is_baked_again) {
  const test::TempFolder folder;
  const BakedLight baked = raster::bake_light(sloped(0.1f), true, folder.path());
  const std::vector<fs::path> paths = files_in(folder.path());
  ASSERT_EQ(paths.size(), 4u);
  const auto flip = [](std::vector<std::byte> bytes, std::size_t at) {
    bytes[at] ^= std::byte{4};
    return bytes;
  };
  for (const fs::path& path : paths) {
    const std::vector<std::byte> good = read_file(path);
    const std::vector<std::byte> half(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(good.size() / 2));
    for (const auto& bad : {flip(good, good.size() - 3), flip(good, good.size() / 2), flip(good, 3), half, {}}) {
      write_file(path, bad);
      const BakedLight again = raster::bake_light(sloped(0.1f), true, folder.path());
      EXPECT_FALSE(again.is_cached) << path;
      EXPECT_EQ(texel(again), texel(baked));
      EXPECT_TRUE(raster::bake_light(sloped(0.1f), true, folder.path()).is_cached) << "it is mended: " << path;
    }
    fs::remove(path);
    EXPECT_FALSE(raster::bake_light(sloped(0.1f), true, folder.path()).is_cached) << path;
    fs::remove(path);
    fs::create_directory(path);
    EXPECT_FALSE(raster::bake_light(sloped(0.1f), true, folder.path()).is_cached) << path;
    fs::remove(path);
  }
}

TEST(unit_raster_image_light, the_cache_of_another_light_is_not_believed) {
  const test::TempFolder folder;
  raster::bake_light(sloped(0.1f), false, folder.path());
  const std::string key = raster::light_key(sloped(0.1f), false), other = raster::light_key(sloped(0.7f), false);
  ASSERT_NE(key, other);
  for (const fs::path& path : files_in(folder.path())) {
    const std::string name = path.filename().string();
    ASSERT_TRUE(name.starts_with(key));
    fs::copy_file(path, folder / (other + name.substr(key.size())));
  }
  const BakedLight light = raster::bake_light(sloped(0.7f), false, folder.path());
  EXPECT_FALSE(light.is_cached);
  EXPECT_EQ(texel(light), texel(raster::bake_light(sloped(0.7f), false, {})));
}

/// Files that are whole and sealed, and hold what no bake gives.
TEST(unit_raster_image_light, sealed_nonsense_is_not_believed) {
  const test::TempFolder folder;
  raster::bake_light(sloped(0.1f), false, folder.path());
  const std::string key = raster::light_key(sloped(0.1f), false);
  // What the writer would put right is put into the file as it is.
  constexpr float kMark = 12345.0f;
  const auto write_sealed = [&](int size, float value) {
    CubeFaces faces = make_cube_faces(size);
    for (Image& face : faces) std::fill(face.pixels.begin(), face.pixels.end(), 1.0f);
    faces[3].pixels[5] = kMark;
    const TextureOptions options{.format = TexelFormat::rgba32f, .zstd = false};
    EncodingLoss loss;
    std::vector<std::byte> bytes = encode_texture(cube_of_one_level(faces), options, loss, "t");
    const auto mark = std::as_bytes(std::span(&kMark, 1)), nonsense = std::as_bytes(std::span(&value, 1));
    const auto at = std::search(bytes.begin(), bytes.end(), mark.begin(), mark.end());
    ASSERT_NE(at, bytes.end());
    std::copy(nonsense.begin(), nonsense.end(), at);
    write_file(folder / (key + ".irradiance.ktx2"), bytes);
    std::string seal = key + "\n";
    for (const char* end : {".irradiance.ktx2", ".ktx2"}) {
      seal += std::to_string(fingerprint(read_file(folder / (key + end)))) + "\n";
    }
    write_file(folder / (key + ".seal"), seal);
  };
  const auto is_believed = [&] {
    const BakedLight light = raster::bake_light(sloped(0.1f), false, folder.path());
    for (const Image& face : light.irradiance) {
      for (const float v : face.pixels) EXPECT_TRUE(std::isfinite(v) && v >= 0.0f);
    }
    return light.is_cached;
  };
  const int size = raster::bake_light(sloped(0.1f), false, {}).irradiance[0].width;
  write_sealed(size, 1.0f);
  EXPECT_TRUE(is_believed()) << "the test seals as the program does";
  for (const float value : {std::nanf(""), std::numeric_limits<float>::infinity(), -1.0f}) {
    write_sealed(size, value);
    EXPECT_FALSE(is_believed()) << value;
  }
  write_sealed(size / 2, 1.0f);
  EXPECT_FALSE(is_believed()) << "of another size";
}

}  // namespace
}  // namespace candela
