#include <iostream>

#include "base/error.h"
#include "base/file.h"
#include "unit/image/texture_seeds.h"

/// Writes the textures that fuzzing starts from into the folder given.
int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: make_texture_corpus FOLDER\n";
    return 2;
  }
  try {
    const std::filesystem::path folder = argv[1];
    std::filesystem::create_directories(folder);
    int i = 0;
    for (const auto& seed : candela::test::texture_seeds())
      candela::write_file(folder / ("seed_" + std::to_string(i++)), seed);
    for (const auto& seed : candela::test::block_seeds())
      candela::write_file(folder / ("seed_" + std::to_string(i++)), seed);
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
  return 0;
}
