#include <string>

#include "base/diagnostics.h"
#include "base/error.h"
#include "foreign/convert.h"

/// Any bytes that claim to be a scene of another format: a binary glTF, or an Error. What Assimp makes of them happens
/// in a process of its own; what is judged here are the guards before it and the writer behind it.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace candela;
  const auto bytes = std::as_bytes(std::span(data, size));
  const foreign::Surroundings alone = {
      [](const std::string&) { return false; },
      [](const std::string& name) -> std::vector<std::byte> { throw Error("nothing beside it", name); }};
  try {
    const foreign::Format format = foreign::recognise(bytes);
    if (format == foreign::Format::unknown || format == foreign::Format::gltf) return 0;
    Diagnostics ignored;
    foreign::convert(bytes, format, alone, "scene", "scene", ignored);
  } catch (const Error&) {
  }
  return 0;
}
