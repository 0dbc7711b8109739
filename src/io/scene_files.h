#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace candela::io {

class ZipArchive;

/// The files that a scene may read beside its own: every reader of what a scene names asks here.
class SceneFiles {
 public:
  /// None.
  SceneFiles() = default;
  /// Those that names lead to from `folder`; with a `root` only what lies inside it, all links resolved. An empty
  /// folder has none. Throws Error where `root` is no folder.
  explicit SceneFiles(std::filesystem::path folder, const std::filesystem::path& root = {});
  /// Those of an archive, named from a folder in it ("" = its top).
  SceneFiles(std::shared_ptr<const ZipArchive> archive, std::string folder);

  /// Whether there are any.
  bool empty() const { return folder_.empty() && archive_ == nullptr; }
  /// Whether some names are forbidden: there is a root, or an archive.
  bool is_confined() const { return !root_.empty() || archive_ != nullptr; }
  /// Whether a name leads out of the scene's own folder, all links resolved; never in an archive.
  bool leaves_folder(const std::string& name) const;

  /// Throws Error for a name that leads where the scene may not read. Names are relative.
  void check(const std::string& name) const;
  bool contains(const std::string& name) const;
  /// Thread-safe. Throws Error as check() does, and for what cannot be read.
  std::vector<std::byte> read(const std::string& name) const;
  /// Where it is on disk, there or not; empty in an archive.
  std::filesystem::path path(const std::string& name) const;

 private:
  std::string entry(const std::string& name) const;
  std::filesystem::path allowed_path(const std::string& name) const;

  std::filesystem::path folder_;
  std::filesystem::path root_;  ///< without links; empty = no bounds
  std::shared_ptr<const ZipArchive> archive_;
  std::string archive_folder_;
};

/// Throws Error where a file lies outside of `root`, all links resolved; an empty one has no bounds.
void check_inside(const std::filesystem::path& file, const std::filesystem::path& root);

/// A scene as it was found: in a file of its own, or alone in a .zip.
struct SceneSource {
  std::vector<std::byte> bytes;  ///< of the scene
  std::string label;             ///< names it in errors: FILE, or ARCHIVE:FILE
  std::string entry;             ///< its name in the archive; empty where there is none
  SceneFiles files;
  std::string format;                       ///< what the file is ("glTF", "OBJ"…), once open_gltf has looked
  std::size_t file_bytes = 0;               ///< of the file itself, likewise
  std::vector<std::string> read;            ///< names of other files that making a glTF of it has read
  std::vector<std::string> mentioned = {};  ///< of files that it names beside these, if not to any effect
};

/// Whether a file is a .zip with a scene in it, or several. Throws nothing.
bool is_scene_archive(const std::filesystem::path& path);

/// Opens a file by its content, never by its name. Throws Error where it lies outside of `root` (when that is not
/// empty), and for an archive with no scene or with several, which it names. Beside a glTF other formats do
/// not count; a 3MF is a .zip, but a scene.
SceneSource open_scene(const std::filesystem::path& path, const std::filesystem::path& root = {});
/// The same from memory. What is no archive reads from `folder`, nothing where that is empty.
SceneSource open_scene(std::vector<std::byte> bytes, const std::filesystem::path& folder, std::string label,
                       const std::filesystem::path& root = {});

}  // namespace candela::io
