#pragma once

#include <random>
#include <vector>

#include "image/texture_file.h"
#include "unit/image/basis_files.h"
#include "unit/image/ktx2_builder.h"

namespace candela::test {

/// A cube whose texels all differ; `levels` of them.
inline Cubemap numbered_cube(int size, int levels, unsigned seed = 1) {
  Cubemap cube;
  std::mt19937 random(seed);
  for (int level = 0; level < levels; ++level) {
    cube.levels.push_back(make_cube_faces(std::max(size >> level, 1)));
    for (Image& face : cube.levels.back())
      for (float& v : face.pixels) v = std::exp2(static_cast<float>(random() % 1024) / 128.0f - 4.0f);
  }
  return cube;
}

/// Small files of every container: what mutation and fuzzing start from.
inline std::vector<std::vector<std::byte>> texture_seeds() {
  std::vector<std::vector<std::byte>> seeds;
  EncodingLoss loss;
  const Cubemap cube = numbered_cube(4, 3);
  const auto add = [&](TextureContainer container, TexelFormat format, bool zstd) {
    TextureOptions options{.container = container, .format = format, .zstd = zstd, .key_values = {{"sh", "1 2 3"}}};
    seeds.push_back(encode_texture(cube, options, loss, "seed"));
  };
  add(TextureContainer::ktx2, TexelFormat::rgba16f, false);
  add(TextureContainer::ktx2, TexelFormat::rgb9e5, true);
  add(TextureContainer::ktx2, TexelFormat::rgb16f, true);
  add(TextureContainer::ktx1, TexelFormat::r11g11b10f, false);
  add(TextureContainer::ktx1, TexelFormat::rgb16f, false);
  add(TextureContainer::dds, TexelFormat::rgba16f, false);
  Image table(5, 3, 3);
  for (std::size_t i = 0; i < table.pixels.size(); ++i) table.pixels[i] = static_cast<float>(i) / 8.0f;
  TextureOptions options{.format = TexelFormat::rg32f, .zstd = false};
  seeds.push_back(encode_texture(table, options, loss, "seed"));
  options.container = TextureContainer::dds;
  seeds.push_back(encode_texture(table, options, loss, "seed"));
  return seeds;
}

/// The same with texels in blocks: universal formats and ASTC.
inline std::vector<std::vector<std::byte>> block_seeds() {
  std::vector<std::vector<std::byte>> seeds;
  seeds.reserve(std::size(kBasisFiles));
  for (const char* name : kBasisFiles) seeds.push_back(basis_file(name));
  // ASTC of plain colours needs no encoder.
  for (const std::uint32_t vk_format : {157u, 184u, 1000066000u}) {
    Ktx2 file{.vk_format = vk_format, .width = 9, .height = 3, .model = 162, .channels = {0}};
    const std::size_t blocks = vk_format == 184u ? 1 : 3;
    file.levels = {std::vector<std::byte>(16 * blocks, std::byte{0xff})};
    for (std::size_t i = 0; i < blocks; ++i) {
      file.levels[0][16 * i] = std::byte{0xfc};
      file.levels[0][16 * i + 1] = vk_format == 1000066000u ? std::byte{0xff} : std::byte{0xfd};
    }
    seeds.push_back(file.bytes());
  }
  return seeds;
}

}  // namespace candela::test
