#include "candela/part.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "base/error.h"
#include "candela/shot.h"

namespace candela {
namespace {

PicturePart part_of_a_picture() {
  Shot shot;
  shot.scene = "demo:spheres";
  shot.size = ivec2(6, 4);
  shot.environment = "furnace";
  shot.traced.samples = 32;
  shot.layers = {Layer::albedo, Layer::depth, Layer::camera_normal};
  shot.mattes = {MatteKind::object};
  shot.denoiser = denoise::Method::regression;
  shot.exposure = 1.0f;
  shot.part = PartRange{1, 2};
  PicturePart part;
  Take(shot).render([&](const TakenPicture& picture) { part = *picture.part; });
  return part;
}

/// An Error, or a picture without numbers that are none.
void expect_refused_or_right(const PicturePart& part) {
  MergedPicture merged;
  try {
    merged.add(part_of_bytes(bytes_of_part(part), "mutant"), "mutant");
  } catch (const Error&) {
    return;
  }
  for (const float v : merged.film().beauty.pixels) ASSERT_TRUE(std::isfinite(v));
}

TEST(unit_candela_part, comes_back_from_its_bytes) {
  const PicturePart part = part_of_a_picture();
  const PicturePart back = part_of_bytes(bytes_of_part(part), "part");
  EXPECT_EQ(back.key, part.key);
  EXPECT_EQ(back.end_sample, 16);
  EXPECT_EQ(back.layers, part.layers);
  EXPECT_EQ(back.sums, part.sums);
  EXPECT_EQ(back.names, part.names);
  EXPECT_EQ(back.centres.at(Layer::depth).pixels, part.centres.at(Layer::depth).pixels);
  EXPECT_EQ(back.develop.exposure, part.develop.exposure);
  EXPECT_EQ(back.denoiser, part.denoiser);
}

TEST(unit_candela_part, sums_of_strangers_are_refused_or_make_a_picture) {
  const PicturePart part = part_of_a_picture();
  std::mt19937 random(1);
  for (int i = 0; i < 3000; ++i) {
    PicturePart mutant = part;
    const std::size_t bytes = 1 + random() % 8;
    for (std::size_t k = 0; k < bytes; ++k) {
      // The pixels' own sums and the mattes behind them more often than their number deserves.
      const std::size_t size =
          random() % 2 == 0 ? std::min<std::size_t>(mutant.sums.size(), 24 * 56) : mutant.sums.size();
      mutant.sums[random() % 3 == 0 ? mutant.sums.size() - 1 - random() % 400 : random() % size] =
          static_cast<std::byte>(random() % 4 == 0 ? 0xff : random());
    }
    if (random() % 8 == 0) mutant.sums.resize(random() % mutant.sums.size());
    expect_refused_or_right(mutant);
  }
}

TEST(unit_candela_part, claims_of_strangers_are_refused) {
  const PicturePart part = part_of_a_picture();
  PicturePart huge = part;  // no memory is taken for what is not there
  huge.size = ivec2(65536);
  huge.layers.erase(Layer::depth);
  huge.centres.clear();
  MergedPicture merged;
  EXPECT_THROW(merged.add(part_of_bytes(bytes_of_part(huge), "huge"), "huge"), Error);
  PicturePart other = part;
  other.has_features = false;
  EXPECT_THROW(merged.add(part_of_bytes(bytes_of_part(other), "other"), "other"), Error);
  other = part;
  other.names.clear();  // mattes without a name
  merged.add(part_of_bytes(bytes_of_part(other), "other"), "other");
  EXPECT_EQ(merged.film().mattes.size(), 1u);
  for (int i = 0; i < 4; ++i) {
    other = part;
    if (i == 0) other.first_sample = 16;
    if (i == 1) other.end_sample = 33;
    if (i == 2) other.size.y = 0;
    if (i == 3) other.camera_from_world[1][1] = HUGE_VALF;
    EXPECT_THROW(part_of_bytes(bytes_of_part(other), "other"), Error) << i;
  }
}

TEST(unit_candela_part, headers_of_strangers_are_refused_or_make_a_picture) {
  const std::vector<std::byte> good = bytes_of_part(part_of_a_picture());
  const auto* text = reinterpret_cast<const char*>(good.data());
  const auto end = static_cast<std::size_t>(std::strchr(text + 24, '\n') - text);
  std::mt19937 random(1);
  const std::string_view marks = "0123456789{}[]\",:-+.eE nulltrfas\\";
  for (int i = 0; i < 5000; ++i) {
    std::vector<std::byte> mutant = good;
    for (std::size_t k = 0; k < 1 + random() % 3; ++k) {
      mutant[24 + random() % (end - 24)] = static_cast<std::byte>(marks[random() % marks.size()]);
    }
    try {
      MergedPicture merged;
      merged.add(part_of_bytes(mutant, "mutant"), "mutant");
      merged.film();
    } catch (const Error&) {
    }
  }
}

}  // namespace
}  // namespace candela
