#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "base/file.h"
#include "unit/io/gltf_builder.h"

namespace candela::io::test {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> gltf_files(const fs::path& folder) {
  std::vector<fs::path> files;
  if (!fs::exists(folder)) return files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const auto extension = entry.path().extension();
    if (entry.is_regular_file() && (extension == ".gltf" || extension == ".glb")) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

const fs::path kAssets = CANDELA_ASSETS;

#define SKIP_WITHOUT_ASSETS() \
  if (!fs::exists(kAssets / "models")) GTEST_SKIP() << "no assets in " << kAssets

TEST(unit_io_gltf_assets, every_model_loads_or_names_the_extension_it_requires) {
  SKIP_WITHOUT_ASSETS();
  std::set<std::string> refused;
  int loaded = 0;
  std::vector<fs::path> files = gltf_files(kAssets / "models");
  for (const char* folder : {"asset-generator", "compression"}) {
    for (const fs::path& file : gltf_files(kAssets / folder)) files.push_back(file);
  }
  for (const fs::path& file : files) {
    Diagnostics diagnostics;
    try {
      const Scene scene = load_gltf(file, diagnostics, LoadOptions{.decode_images = false});
      ++loaded;
      EXPECT_FALSE(scene.nodes.empty()) << file;
      for (const auto& warning : diagnostics.warnings()) {
        const std::string& text = warning.message;
        EXPECT_THAT(text, ::testing::ContainsRegex("(KHR_draco_mesh_compression|(EXT|KHR)_meshopt_compression|"
                                                   "KHR_texture_basisu|KTX2 images) "
                                                   "(is|are) not supported|points or lines|no such file"))
            << file << ": " << text;
      }
    } catch (const Error& error) {
      EXPECT_THAT(error.message(), ::testing::ContainsRegex("(requires .* is|KTX2 images are) not supported"))
          << file << ": " << error.what();
      refused.insert(error.message());
    }
  }
  RecordProperty("loaded", loaded);
  EXPECT_GT(loaded, 100);
  EXPECT_LE(refused.size(), 6u) << ::testing::PrintToString(refused);
}

TEST(unit_io_gltf_assets, the_helmet_is_what_it_is) {
  SKIP_WITHOUT_ASSETS();
  Diagnostics diagnostics;
  const Scene scene = load_gltf(kAssets / "models/DamagedHelmet/glTF-Binary/DamagedHelmet.glb", diagnostics);
  EXPECT_TRUE(diagnostics.warnings().empty());
  ASSERT_EQ(scene.meshes.size(), 1u);
  const Primitive& p = scene.meshes[0].primitives.at(0);
  // The file lists 15452 triangles and no tangents.
  EXPECT_GT(p.triangles.size(), 15400u);
  EXPECT_LE(p.triangles.size(), 15452u);
  EXPECT_EQ(p.tangents.size(), p.positions.size());
  EXPECT_EQ(scene.images.size(), 5u);
  const Box3 box = world_bounds(scene);
  EXPECT_GT(box.size().x, 1.8f);
  EXPECT_LT(box.size().x, 2.0f);
}

/// All lobes of all materials.
std::set<std::string_view> lobes_of(const Scene& scene) {
  std::set<std::string_view> lobes;
  for (const Material& m : scene.materials) {
    for (const std::string_view lobe : material_lobes(m)) lobes.insert(lobe);
  }
  return lobes;
}

TEST(unit_io_gltf_assets, models_have_the_lobes_that_they_are_made_to_show) {
  SKIP_WITHOUT_ASSETS();
  const std::vector<std::pair<std::string, std::set<std::string_view>>> files{
      {"ClearCoatTest/glTF-Binary/ClearCoatTest.glb", {"clearcoat", "metallic-roughness"}},
      {"SheenCloth/glTF/SheenCloth.gltf", {"metallic-roughness", "sheen"}},
      {"AnisotropyDiscTest/glTF-Binary/AnisotropyDiscTest.glb", {"anisotropy", "metallic-roughness"}},
      {"IridescenceSuzanne/glTF-Binary/IridescenceSuzanne.glb",
       {"iridescence", "metallic-roughness", "transmission", "volume"}},
      {"DispersionTest/glTF-Binary/DispersionTest.glb", {"dispersion", "metallic-roughness", "transmission", "volume"}},
      {"SpecGlossVsMetalRough/glTF/SpecGlossVsMetalRough.gltf", {"metallic-roughness", "specular-glossiness"}}};
  for (const auto& [name, lobes] : files) {
    const fs::path file = kAssets / "models" / name;
    if (!fs::exists(file)) continue;
    Diagnostics diagnostics;
    const Scene scene = load_gltf(file, diagnostics, LoadOptions{.decode_images = false});
    EXPECT_TRUE(diagnostics.warnings().empty()) << file;
    EXPECT_EQ(lobes_of(scene), lobes) << file;
    for (const Mesh& mesh : scene.meshes) {
      for (const Primitive& p : mesh.primitives) {
        const Material& m = scene.materials.at(static_cast<std::size_t>(p.material));
        EXPECT_TRUE(m.anisotropy == 0.0f || p.tangents.size() == p.positions.size()) << file;
      }
    }
  }
}

TEST(unit_io_gltf_assets, the_shoe_wears_its_variants) {
  SKIP_WITHOUT_ASSETS();
  const fs::path file = kAssets / "models/MaterialsVariantsShoe/glTF/MaterialsVariantsShoe.gltf";
  if (!fs::exists(file)) GTEST_SKIP() << "no " << file;
  Diagnostics diagnostics;
  FileInfo info;
  load_gltf(file, diagnostics, LoadOptions{.decode_images = false}, &info);
  ASSERT_EQ(info.variants, (std::vector<std::string>{"midnight", "beach", "street"}));
  std::set<std::vector<std::uint8_t>> looks;
  for (const std::string& variant : info.variants) {
    const Scene scene = load_gltf(file, diagnostics, LoadOptions{.variant = variant});
    ASSERT_EQ(scene.materials.size(), 1u) << variant;
    const TextureSlot& slot = scene.materials[0].base_color_texture;
    ASSERT_TRUE(slot) << variant;
    const int image = scene.textures.at(static_cast<std::size_t>(slot.texture)).image;
    looks.insert(scene.images.at(static_cast<std::size_t>(image))->pixels);
  }
  EXPECT_EQ(looks.size(), 3u);
}

TEST(unit_io_gltf_assets, variants_of_a_model_are_the_same_scene) {
  SKIP_WITHOUT_ASSETS();
  const fs::path base = kAssets / "models/BoxTextured";
  Diagnostics diagnostics;
  const Scene reference = load_gltf(base / "glTF/BoxTextured.gltf", diagnostics);
  for (const char* other : {"glTF-Binary/BoxTextured.glb", "glTF-Embedded/BoxTextured.gltf"}) {
    const Scene scene = load_gltf(base / other, diagnostics);
    EXPECT_EQ(scene.meshes.at(0).primitives.at(0).positions, reference.meshes.at(0).primitives.at(0).positions);
    EXPECT_EQ(scene.images.at(0)->pixels, reference.images.at(0)->pixels);
  }
}

/// The file without its TANGENT attributes.
std::vector<std::byte> without_tangents(const std::vector<std::byte>& file) {
  Builder b;
  const auto* text = reinterpret_cast<const char*>(file.data());
  const bool is_glb = text[0] == 'g';
  std::uint32_t length = static_cast<std::uint32_t>(file.size());
  if (is_glb) {
    std::memcpy(&length, file.data() + 12, 4);
    text += 20;
    b.binary.assign(file.begin() + 28 + length, file.end());
  }
  b.root = json::parse(text, text + length);
  for (json& mesh : b.root["meshes"]) {
    for (json& p : mesh["primitives"]) p["attributes"].erase("TANGENT");
  }
  return b.glb();
}

/// Share of corners whose generated tangent is within 1° of the stored one, and has its sign.
double agreement(const Scene& stored, const Scene& generated) {
  std::size_t good = 0, all = 0;
  for (std::size_t m = 0; m < stored.meshes.size(); ++m) {
    for (std::size_t k = 0; k < stored.meshes[m].primitives.size(); ++k) {
      const Primitive& a = stored.meshes[m].primitives[k];
      const Primitive& b = generated.meshes.at(m).primitives.at(k);
      if (a.tangents.empty()) continue;
      EXPECT_EQ(a.triangles.size(), b.triangles.size());
      for (std::size_t f = 0; f < a.triangles.size(); ++f) {
        for (int i = 0; i < 3; ++i) {
          const vec4 x = a.tangents[a.triangles[f][i]], y = b.tangents[b.triangles[f][i]];
          ++all;
          good += glm::dot(vec3(x), vec3(y)) > std::cos(radians(1.0f)) && x.w == y.w;
        }
      }
    }
  }
  return all == 0 ? 0.0 : static_cast<double>(good) / static_cast<double>(all);
}

TEST(unit_io_gltf_assets, generated_tangents_are_those_that_files_ship) {
  SKIP_WITHOUT_ASSETS();
  // The first three come from exporters that call MikkTSpace itself. The lamp has a few triangles with hardly any uv
  // area, and the avocado's tool averaged in its own way.
  const std::vector<std::pair<std::string, double>> files{
      {"NormalTangentMirrorTest/glTF-Binary/NormalTangentMirrorTest.glb", 0.9999},
      {"AlphaBlendModeTest/glTF-Binary/AlphaBlendModeTest.glb", 0.9999},
      {"AnisotropyRotationTest/glTF-Binary/AnisotropyRotationTest.glb", 0.9999},
      {"LightsPunctualLamp/glTF/LightsPunctualLamp.gltf", 0.995},
      {"Avocado/glTF/Avocado.gltf", 0.87}};
  for (const auto& [name, share] : files) {
    const fs::path file = kAssets / "models" / name;
    if (!fs::exists(file)) continue;
    const auto bytes = read_file(file);
    Diagnostics diagnostics;
    const LoadOptions options{.decode_images = false};
    const Scene stored = load_gltf(bytes, file.parent_path(), diagnostics, options);
    const Scene generated = load_gltf(without_tangents(bytes), file.parent_path(), diagnostics, options);
    EXPECT_GT(agreement(stored, generated), share) << file;
  }
}

}  // namespace
}  // namespace candela::io::test
