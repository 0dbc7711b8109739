#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/large_pages.h"
#include "io/gltf_document.h"
#include "io/gltf_warnings.h"
#include "math/types.h"

namespace candela::io {

/// Component types: glTF 2.0 §3.6.2.2, and KHR_accessor_float16 and KHR_accessor_float64 (drafts).
inline constexpr int kI8 = 5120, kU8 = 5121, kI16 = 5122, kU16 = 5123, kU32 = 5125, kF32 = 5126, kF64 = 5130,
                     kF16 = 5131;

/// What stands among indices where a strip or fan ends and the next begins.
inline constexpr std::uint32_t kPrimitiveRestart = 0xFFFFFFFF;

/// One accessor whose every byte is known to lie inside its buffer.
struct Accessor {
  JsonView json;
  std::size_t count = 0;
  int component_type = 0;
  std::size_t components = 0;  ///< floats per element
  bool normalized = false;
  std::span<const std::byte> bytes = {};  ///< from the first element on; empty = all zeros
  std::size_t stride = 0;

  std::vector<std::uint32_t> sparse_elements = {};  ///< strictly ascending
  std::span<const std::byte> sparse_values = {};    ///< tightly packed
};

/// Which elements to read: ascending indices, or all.
using Selection = std::optional<std::span<const std::uint32_t>>;

/// Reads accessors. Decoded data is counted: a small file that refers to the same bytes again and again, or to none,
/// cannot make the loader allocate without bound. Not thread-safe.
class AccessorReader {
 public:
  AccessorReader(const JsonView& root, GltfBuffers& buffers, std::uint64_t file_bytes, Warnings& warnings);
  /// A reader for another thread, which counts with this one; all that both may read has been prepared.
  AccessorReader(const AccessorReader& other, Warnings& warnings);
  AccessorReader(const AccessorReader&) = delete;
  AccessorReader& operator=(const AccessorReader&) = delete;

  /// Reads and unpacks the buffer views of a primitive's accessors, so that several threads may look into them. Throws
  /// Error as reading them would.
  void prepare(const JsonView& primitive);

  /// From here on accessors are those of `primitive`: where it has KHR_draco_mesh_compression they hold what the Draco
  /// data says, whatever its fallback does.
  void begin_primitive(const JsonView& primitive);

  /// The accessor that the JSON number `reference` points at. `types`: what may stand there, e.g. {"VEC3", "VEC4"}. Of
  /// a primitive with KHR_draco_mesh_compression it holds what the Draco data says.
  Accessor open(const JsonView& reference, std::initializer_list<const char*> types);

  /// Elements as vectors or matrices of exactly as many floats as the type has; normalised integers as glTF 2.0
  /// §3.6.2.2 defines. Throws Error on a NaN or an infinity.
  template <class V>
  std::vector<V> read_as(const Accessor& accessor, const Selection& selection = std::nullopt) {
    const std::size_t count = selection ? selection->size() : accessor.count;
    charge(std::uint64_t{count} * sizeof(V), accessor.json);
    std::vector<V> result;
    resize_large(result, count);
    read(accessor, selection, reinterpret_cast<float*>(result.data()));
    return result;
  }

  /// Vertex indices below `vertex_count`. The primitive-restart value of their type is kPrimitiveRestart where the file
  /// has EXT_mesh_primitive_restart or KHR_mesh_primitive_restart, else an Error.
  std::vector<std::uint32_t> read_indices(const Accessor& accessor, std::size_t vertex_count);

  /// Counts `bytes` of memory on behalf of `cause`; throws Error when the file asks for more than its size can explain.
  void charge(std::uint64_t bytes, const JsonView& cause);
  std::uint64_t charged() const { return *charged_; }
  void set_charged(std::uint64_t bytes) { *charged_ = bytes; }

 private:
  void read(const Accessor& accessor, const Selection& selection, float* out) const;
  void prepare_accessor(const JsonView& reference);
  void open_sparse(Accessor& accessor, const JsonView& sparse);
  bool open_draco(std::size_t index, Accessor& accessor);

  /// Where the values of an accessor are in Draco data.
  struct DracoSource {
    JsonView view;
    std::optional<std::uint32_t> attribute;  ///< none: the indices
    std::vector<std::byte> values = {};      ///< once they were asked for
  };

  JsonView root_;
  GltfBuffers& buffers_;
  std::uint64_t file_bytes_;
  Warnings& warnings_;
  std::shared_ptr<std::atomic<std::uint64_t>> charged_;
  std::map<std::size_t, DracoSource> draco_;  ///< of the primitive, by accessor
  bool has_restarts_ = false;
};

}  // namespace candela::io
