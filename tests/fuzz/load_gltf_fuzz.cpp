#include <string>

#include "base/error.h"
#include "io/gltf.h"
#include "scene/material_table.h"

/// Any bytes: the loader gives an Error or a scene that keeps its promises. Images are measured, not decoded: their
/// decoders have tests of their own, and a bomb of a gigabyte is allowed there.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace candela;
  Diagnostics diagnostics;
  try {
    const auto bytes = std::as_bytes(std::span(data, size));
    io::LoadOptions options{.decode_images = false};
    io::FileInfo info;
    Scene scene = io::load_gltf(bytes, {}, diagnostics, options, &info);
    if (!info.variants.empty()) {
      options.variant = info.variants.front();
      scene = io::load_gltf(bytes, {}, diagnostics, options);
    }
    if (!info.animations.empty()) {
      io::GltfFile file({bytes.begin(), bytes.end()}, {}, "fuzz", diagnostics, options);
      scene = file.scene(diagnostics, io::Pose{"all", 0.4});
    }
    // Pixels are all that validate() may miss.
    scene.images.clear();
    scene.textures.clear();
    for (Material& m : scene.materials) {
      for (TextureSlot* slot : texture_slots(m)) *slot = {};
    }
    validate(scene);
    world_bounds(scene);
  } catch (const Error&) {
  }
  return 0;
}
