#include "io/gltf.h"

#include <span>

#include "base/file.h"
#include "io/foreign_scene.h"
#include "io/gltf_animation.h"
#include "io/gltf_files.h"
#include "io/gltf_info.h"
#include "io/gltf_loader.h"
#include "io/scene_files.h"

namespace candela::io {

namespace fs = std::filesystem;

struct GltfFile::Parts {
  std::vector<std::byte> bytes;
  LoadOptions options;
  GltfDocument document;
  UriReader uris;
  GltfBuffers buffers;
  FileInfo info;
  Kept kept;
  std::string scene_name;  ///< where the file gives none

  Parts(SceneSource source, LoadOptions load_options, Diagnostics& diagnostics)
      : bytes(std::move(source.bytes)),
        options(std::move(load_options)),
        document(bytes, std::move(source.label), diagnostics),
        uris(std::move(source.files)),
        buffers(document, uris),
        info(read_info(document, bytes.size(), options.scene)) {
    check_references(document.root(), document.json(), uris);
    info.files = referenced_files(document.json(), uris);
    info.archive_entry = std::move(source.entry);
  }
};

GltfFile::GltfFile(std::vector<std::byte> bytes, const fs::path& base_folder, std::string label,
                   Diagnostics& diagnostics, const LoadOptions& options, FileInfo* info)
    : parts_(std::make_unique<Parts>(open_scene(std::move(bytes), base_folder, std::move(label), options.root), options,
                                     diagnostics)) {
  if (info) *info = parts_->info;
}

GltfFile::GltfFile(const fs::path& path, Diagnostics& diagnostics, const LoadOptions& options, FileInfo* info) {
  SceneSource source = open_gltf(path, options.root, options.measures, diagnostics);
  const std::string format = source.format;
  const std::size_t file_bytes = source.file_bytes;
  std::vector<ReferencedFile> read = files_of_source(path, source);
  parts_ = std::make_unique<Parts>(std::move(source), options, diagnostics);
  parts_->scene_name = path.stem().string();
  parts_->info.format = format;
  parts_->info.file_bytes = file_bytes;
  parts_->info.files.insert(parts_->info.files.begin(), read.begin(), read.end());
  if (info) *info = parts_->info;
}

GltfFile::~GltfFile() = default;

const FileInfo& GltfFile::info() const { return parts_->info; }

std::vector<std::size_t> GltfFile::find_animations(const std::string& name) const {
  return io::find_animations(parts_->document.root(), name);
}

Scene GltfFile::scene(Diagnostics& diagnostics, const std::optional<Pose>& pose,
                      const std::optional<std::string>& variant) {
  Parts& p = *parts_;
  if (variant) {
    p.options.variant = *variant;
    p.kept.has_variants = true;
  }
  Loader loader(p.document, p.uris, p.buffers, p.options, p.bytes.size(), diagnostics);
  Scene scene = loader.load(p.info, pose, &p.kept);
  if (scene.name.empty()) scene.name = p.scene_name;
  return scene;
}

Scene load_gltf(const fs::path& path, Diagnostics& diagnostics) { return load_gltf(path, diagnostics, LoadOptions()); }

Scene load_gltf(const fs::path& path, Diagnostics& diagnostics, const LoadOptions& options, FileInfo* info) {
  return GltfFile(path, diagnostics, options, info).scene(diagnostics);
}

Scene load_gltf(std::span<const std::byte> bytes, const fs::path& base_folder, Diagnostics& diagnostics) {
  return load_gltf(bytes, base_folder, diagnostics, LoadOptions());
}

Scene load_gltf(std::span<const std::byte> bytes, const fs::path& base_folder, Diagnostics& diagnostics,
                const LoadOptions& options, FileInfo* info) {
  return GltfFile({bytes.begin(), bytes.end()}, base_folder, "glTF in memory", diagnostics, options, info)
      .scene(diagnostics);
}

}  // namespace candela::io
