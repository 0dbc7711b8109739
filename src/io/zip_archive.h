#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace candela::io {

/// Whether a file begins as a .zip does.
bool is_zip(std::span<const std::byte> head);
bool is_zip(const std::filesystem::path& path);

/// A .zip whose files are read without being laid on disk. PKWARE, "APPNOTE.TXT - .ZIP File Format Specification".
///
/// Names are paths below the archive's top, parted by '/', whatever the writer took for that. What macOS adds
/// (`__MACOSX/`, `._NAME`), folders and links are no files. Of two files of one name it is the last, as unpacking would
/// leave it.
class ZipArchive {
 public:
  /// Throws Error for damage, and where a name would leave the folder that the archive is unpacked to.
  explicit ZipArchive(const std::filesystem::path& path);
  ZipArchive(std::vector<std::byte> bytes, std::string label);
  ~ZipArchive();
  ZipArchive(const ZipArchive&) = delete;
  ZipArchive& operator=(const ZipArchive&) = delete;

  const std::string& label() const { return label_; }
  /// Sorted.
  std::vector<std::string> names() const;
  bool contains(const std::string& name) const { return index_of_name_.contains(name); }
  /// Thread-safe. Throws Error for what is not there, encrypted, packed in an unknown way, not what the archive says of
  /// it, or more than all its files together may unpack to: a hundred times the archive's size and 64 MiB.
  std::vector<std::byte> read(const std::string& name) const;
  /// The first bytes of a file, fewer of a short one.
  std::vector<std::byte> read_head(const std::string& name, std::size_t count) const;

 private:
  struct Handle;
  void list();
  std::uint64_t index_of(const std::string& name) const;
  std::vector<std::byte> unpack(const std::string& name, std::uint64_t index, std::uint64_t most) const;
  void charge(const std::string& name, std::uint64_t index, std::uint64_t bytes) const;
  std::string place(const std::string& name) const { return label_ + ":" + name; }

  std::string label_;
  std::unique_ptr<Handle> handle_;
  std::uint64_t most_unpacked_ = 0;
  std::map<std::string, std::uint64_t> index_of_name_;
  mutable std::mutex mutex_;
  mutable std::map<std::uint64_t, std::uint64_t> unpacked_;  ///< bytes by index
  mutable std::uint64_t total_unpacked_ = 0;
};

}  // namespace candela::io
