#include <cstdint>

#include "base/error.h"
#include "io/draco_mesh.h"

/// Any bytes: an Error, or a mesh no larger than it claimed to be, whose attributes can be had.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace candela::io;
  constexpr std::uint64_t kMost = 1 << 18;
  constexpr int kFloat = 5126, kUnsignedShort = 5123;
  const auto packed = std::as_bytes(std::span(data, size));
  try {
    const DracoMesh::Claim claim = DracoMesh::claim(packed);
    if (claim.faces > kMost || claim.vertices > kMost) return 0;
    const DracoMesh mesh(packed);
    if (mesh.face_count() > claim.faces || mesh.vertex_count() > claim.vertices) std::abort();
    if (mesh.indices().size() != mesh.face_count() * 12) std::abort();
    for (std::uint32_t id = 0; id < 4; ++id) {
      for (const std::size_t components : {1u, 2u, 3u, 4u}) {
        for (const int type : {kFloat, kUnsignedShort}) {
          try {
            mesh.attribute(id, type, components);
          } catch (const candela::Error&) {
          }
        }
      }
    }
  } catch (const candela::Error&) {
  }
  return 0;
}
