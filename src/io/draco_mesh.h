#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace candela::io {

/// A mesh of KHR_draco_mesh_compression. Errors are thrown without a place.
class DracoMesh {
 public:
  /// What a stream says it holds, before anything is decoded. Throws Error where the bytes are no Draco mesh.
  struct Claim {
    std::uint64_t faces = 0;
    std::uint64_t vertices = 0;  ///< at most
  };
  static Claim claim(std::span<const std::byte> packed);

  /// Decodes the stream. Throws Error where it is damaged. Several may be decoded at a time.
  explicit DracoMesh(std::span<const std::byte> packed);
  ~DracoMesh();
  DracoMesh(DracoMesh&&) noexcept;
  DracoMesh& operator=(DracoMesh&&) noexcept;

  std::size_t face_count() const;
  std::size_t vertex_count() const;
  /// Three indices of 32 bits for each face.
  std::vector<std::byte> indices() const;
  /// An attribute by its id in the stream, packed as numbers of glTF's `component_type`. Throws Error where the stream
  /// has no such attribute, of so many components.
  std::vector<std::byte> attribute(std::uint32_t id, int component_type, std::size_t components) const;

 private:
  struct Mesh;
  std::unique_ptr<Mesh> mesh_;
};

/// CPU that the streams of a file may take. libdraco believes some counts in them, of which one is 2^31 orientations in
/// 200 bytes, and reads for seconds what is not there; a file may hold thousands of these. Honest streams take a
/// hundredth of it. Threads may share one.
class DracoBudget {
 public:
  void charge(std::size_t bytes, double seconds);
  /// Throws Error once it is spent.
  void require() const;

 private:
  mutable std::mutex mutex_;
  double allowed_s_ = 20.0;
};

/// CPU that this thread has taken so far.
double thread_seconds();

}  // namespace candela::io
