#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/diagnostics.h"
#include "io/draco_mesh.h"
#include "io/json_view.h"
#include "io/meshopt.h"
#include "io/scene_files.h"

namespace candela::io {

/// A parsed .gltf or .glb: the JSON and, for a GLB, its binary chunk. `bytes` must outlive the document.
class GltfDocument {
 public:
  /// Throws Error for anything that is no glTF 2.0 container or no JSON (with line and column). `file` names it in
  /// errors. Of a key that an object has twice the last counts, with a warning.
  GltfDocument(std::span<const std::byte> bytes, std::string file, Diagnostics& diagnostics);
  ~GltfDocument();
  GltfDocument(const GltfDocument&) = delete;
  GltfDocument& operator=(const GltfDocument&) = delete;

  JsonView root() const;
  const nlohmann::json& json() const { return *json_; }
  nlohmann::json& json() { return *json_; }
  std::span<const std::byte> binary_chunk() const { return binary_chunk_; }
  bool is_glb() const { return is_glb_; }

  /// Below which members of the root each extension stands ("materials", "asset"…); "extensions" is the root's own.
  std::map<std::string, std::set<std::string>> extension_places() const;

 private:
  std::string file_;
  std::unique_ptr<nlohmann::json> json_;
  std::span<const std::byte> binary_chunk_;
  bool is_glb_ = false;
};

/// Bytes behind URIs: data URIs and files relative to the glTF.
class UriReader {
 public:
  explicit UriReader(SceneFiles files) : files_(std::move(files)) {}

  /// The files on disk that a URI may stand for: escapes decoded, and, where it has any, as it is written. None of data
  /// URIs, absolute names and other schemes, and none in an archive.
  std::vector<std::filesystem::path> files(const std::string& uri) const;
  /// Why a URI must not be read; empty where it may, or where nothing is forbidden.
  std::string fault(const std::string& uri) const;
  /// Whether it leads to a file outside of the scene's own folder.
  bool leaves_folder(const std::string& uri) const;

  /// Thread-safe. Throws Error at `uri` for absolute paths, other schemes, broken data URIs and unreadable files.
  std::vector<std::byte> read(const JsonView& uri) const;

 private:
  SceneFiles files_;
};

struct BufferView {
  std::span<const std::byte> bytes;
  std::size_t stride = 0;  ///< 0 = tightly packed
};

/// The document's buffers, each read on first use and kept, and what is packed in them. Not thread-safe.
class GltfBuffers {
 public:
  GltfBuffers(const GltfDocument& document, const UriReader& uris);

  /// The buffer view that the JSON number `reference` points at, checked to lie inside its buffer; unpacked where it
  /// has KHR_meshopt_compression or EXT_meshopt_compression, whatever its fallback says.
  BufferView view(const JsonView& reference);

  /// Whether meshopt packs a view. Throws Error where it does and what is packed is not there, or too short.
  bool is_packed(const JsonView& reference);

  /// The buffer of a view, where it has no uri and is no GLB's binary chunk either: glTF 2.0 §5.10.1 leaves it to
  /// others to say what it holds.
  std::optional<JsonView> find_undefined(const JsonView& reference) const;

  /// The Draco mesh in the buffer view that `reference` points at.
  const DracoMesh& draco(const JsonView& reference);
  /// What the Draco data there says it holds.
  DracoMesh::Claim claim_draco(const JsonView& reference);
  /// Decodes many of them on all cores, for draco().
  void decode_draco(const std::vector<JsonView>& references);

  /// Bytes read so far from outside the document, and unpacked.
  std::uint64_t loaded_bytes() const { return loaded_bytes_; }

 private:
  std::span<const std::byte> buffer(std::size_t index);
  std::span<const std::byte> slice(const JsonView& json);
  std::pair<MeshoptLayout, std::span<const std::byte>> packed(const JsonView& extension, std::uint64_t length);
  std::span<const std::byte> unpacked(std::size_t view, const JsonView& extension, std::uint64_t length);
  void charge(std::uint64_t bytes, const JsonView& cause);

  JsonView root_;
  std::span<const std::byte> binary_chunk_;
  bool is_glb_;
  const UriReader& uris_;
  std::vector<std::vector<std::byte>> loaded_;
  std::map<std::size_t, std::unique_ptr<std::byte[]>> unpacked_;  ///< by buffer view
  std::map<std::size_t, DracoMesh> draco_;                        ///< likewise
  DracoBudget draco_budget_;
  std::uint64_t loaded_bytes_ = 0;
  std::uint64_t unpacked_bytes_ = 0;
};

}  // namespace candela::io
