#include "base/error.h"
#include "io/gltf.h"
#include "io/zip_archive.h"

/// Any bytes: an Error, or an archive of which every file can be read or is an Error; and as a scene.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace candela;
  const auto bytes = std::as_bytes(std::span(data, size));
  try {
    const io::ZipArchive archive({bytes.begin(), bytes.end()}, "fuzz");
    for (const std::string& name : archive.names()) {
      try {
        archive.read_head(name, 16);
        archive.read(name);
      } catch (const Error&) {
      }
    }
  } catch (const Error&) {
  }
  if (!io::is_zip(bytes)) return 0;
  try {
    Diagnostics diagnostics;
    io::load_gltf(bytes, {}, diagnostics, {.decode_images = false});
  } catch (const Error&) {
  }
  return 0;
}
