#include <gtest/gtest.h>

#include <random>

#include "io/gltf_survey.h"
#include "unit/io/gltf_seeds.h"

namespace candela::io::test {
namespace {

constexpr int kMutantsPerSeed = 1500;

/// Loads, once for each of the first few variants that the file has, with every kind of result allowed but a crash, a
/// hang or an exception other than Error.
bool loads(std::span<const std::byte> bytes) {
  Diagnostics diagnostics;
  try {
    FileInfo info;
    const Scene scene = load_gltf(bytes, {}, diagnostics, LoadOptions(), &info);
    validate(scene);
    world_bounds(scene);
    survey_gltf(bytes, {}, {.decode_images = true});
    for (std::size_t i = 0; i < std::min<std::size_t>(info.variants.size(), 2); ++i) {
      validate(load_gltf(bytes, {}, diagnostics, LoadOptions{.variant = info.variants[i]}));
    }
    if (!info.animations.empty()) {
      GltfFile file({bytes.begin(), bytes.end()}, {}, "mutant", diagnostics);
      for (const double moment : {0.0, 0.4}) validate(file.scene(diagnostics, Pose{"all", moment}));
    }
    return true;
  } catch (const Error& error) {
    EXPECT_FALSE(error.message().empty());
    return false;
  }
}

/// A number from the places where loaders break.
json hostile_value(std::mt19937& random) {
  static const std::vector<json> values{0,
                                        1,
                                        -1,
                                        2,
                                        3,
                                        255,
                                        65535,
                                        2147483647,
                                        4294967295u,
                                        1e9,
                                        9007199254740991,
                                        18446744073709551615u,
                                        1e39,
                                        -0.5,
                                        1e-45,
                                        0.001,
                                        5120,
                                        5121,
                                        5125,
                                        5126,
                                        "",
                                        "VEC3",
                                        "SCALAR",
                                        "MAT4",
                                        nullptr,
                                        true,
                                        json::array(),
                                        json::object(),
                                        json::array({0, 0, 0}),
                                        json::array({json::array()})};
  return values[random() % values.size()];
}

/// Every value of the document that has no members, and every container.
void collect(json& value, std::vector<json*>& out) {
  out.push_back(&value);
  if (value.is_structured()) {
    for (json& child : value) collect(child, out);
  }
}

TEST(unit_io_gltf_mutation, replaced_json_values_give_an_error_or_a_valid_scene) {
  std::mt19937 random(1);
  int good = 0, bad = 0;
  for (const Builder& seed : seed_files()) {
    ASSERT_TRUE(loads(seed.glb()));
    for (int i = 0; i < kMutantsPerSeed; ++i) {
      Builder mutant = seed;
      for (unsigned k = 0; k < 1 + random() % 2; ++k) {
        std::vector<json*> places;
        collect(mutant.root, places);
        json& place = *places[random() % places.size()];
        if (place.is_object() && !place.empty() && random() % 2 == 0) {
          auto it = place.begin();
          std::advance(it, static_cast<std::ptrdiff_t>(random() % place.size()));
          place.erase(it);
        } else {
          place = hostile_value(random);
        }
      }
      if (!mutant.root.is_object()) continue;
      (loads(mutant.glb()) ? good : bad) += 1;
    }
  }
  // Both outcomes are common, else the mutator would be idle or too blunt.
  EXPECT_GT(good, 500);
  EXPECT_GT(bad, 2000);
}

TEST(unit_io_gltf_mutation, flipped_bytes_and_truncations_give_an_error_or_a_valid_scene) {
  std::mt19937 random(2);
  int good = 0, bad = 0;
  for (const Builder& seed : seed_files()) {
    const std::vector<std::byte> glb = seed.glb();
    const std::string text = seed.gltf();
    const std::vector<std::byte> plain(as_bytes(text).begin(), as_bytes(text).end());
    for (int i = 0; i < kMutantsPerSeed; ++i) {
      std::vector<std::byte> mutant = i % 3 == 0 ? plain : glb;
      switch (random() % 4) {
        case 0:
          mutant.resize(random() % mutant.size());
          break;
        case 1:
          mutant.erase(mutant.begin() + static_cast<std::ptrdiff_t>(random() % mutant.size()));
          break;
        default:
          for (unsigned k = 0; k < 1 + random() % 4; ++k)
            mutant[random() % mutant.size()] = static_cast<std::byte>(random());
      }
      (loads(mutant) ? good : bad) += 1;
    }
  }
  EXPECT_GT(good, 200);
  EXPECT_GT(bad, 2000);
}

TEST(unit_io_gltf_mutation, replaced_buffer_words_give_an_error_or_a_valid_scene) {
  std::mt19937 random(3);
  static constexpr std::uint32_t words[] = {0,          1,          0xFFFFFFFF, 0x7F800000, 0xFF800000,
                                            0x7FC00000, 0x7F7FFFFF, 0x00000001, 0x80000000, 0x0000FFFF};
  int good = 0;
  for (const Builder& seed : seed_files()) {
    for (int i = 0; i < kMutantsPerSeed; ++i) {
      Builder mutant = seed;
      for (unsigned k = 0; k < 1 + random() % 3; ++k) {
        const std::uint32_t word = words[random() % std::size(words)];
        const std::size_t offset = random() % (mutant.binary.size() / 4) * 4;
        std::memcpy(mutant.binary.data() + offset, &word, sizeof word);
      }
      good += loads(mutant.glb());
    }
  }
  EXPECT_GT(good, 1000);
}

}  // namespace
}  // namespace candela::io::test
