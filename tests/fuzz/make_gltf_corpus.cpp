#include <iostream>

#include "base/error.h"
#include "base/file.h"
#include "unit/io/gltf_seeds.h"

/// Writes the seeds that fuzzing starts from, as GLB and as JSON, into the folder given.
int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: make_gltf_corpus FOLDER\n";
    return 2;
  }
  try {
    const std::filesystem::path folder = argv[1];
    std::filesystem::create_directories(folder);
    int i = 0;
    for (const auto& seed : candela::io::test::seed_files()) {
      candela::write_file(folder / ("seed_" + std::to_string(i) + ".glb"), seed.glb());
      candela::write_file(folder / ("seed_" + std::to_string(i++) + ".gltf"), seed.gltf());
    }
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
  return 0;
}
