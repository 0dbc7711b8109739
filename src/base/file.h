#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace candela {

/// Whole content of a file. Throws Error for a file that is missing, not regular, unreadable or above `max_bytes`.
std::vector<std::byte> read_file(const std::filesystem::path& path, std::uint64_t max_bytes = std::uint64_t{1} << 32);

/// The first `count` bytes, fewer of a shorter file; none of what cannot be read or is no regular file.
std::vector<std::byte> read_head(const std::filesystem::path& path, std::size_t count);

/// Whether `path` exists and is neither a file nor a folder: a device or a pipe (links are followed).
bool is_device(const std::filesystem::path& path);

/// A number that tells whether bytes have changed by accident: FNV-1a over eight at a time, the last ones singly, each
/// step mixed by a shift. No defence against malice.
std::uint64_t fingerprint(std::span<const std::byte> bytes, std::uint64_t before = 0xcbf29ce484222325ull);

/// Absolute, without links and `..`; from where nothing is on, as the name says.
std::filesystem::path real_path(const std::filesystem::path& path);

/// Equal for two names of one file: through links, hard links and different spellings. Of what is not there yet the
/// name itself, without regard to case.
std::string file_identity(const std::filesystem::path& path);

/// A file that appears whole or not at all: write to `temp_path()` (beside the target), then `commit()` renames it.
/// Without commit the temporary file is removed. Throws Error where the folder cannot be written. A device or a pipe
/// (/dev/stdout) is written to directly: temp_path() is the target itself.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  const std::filesystem::path& temp_path() const { return temp_; }
  void commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path temp_;
  bool committed_ = false;
};

/// Writes `bytes` to `path` through an AtomicFile. A full disk is an Error and leaves no file.
void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes);
void write_file(const std::filesystem::path& path, const std::string& text);

}  // namespace candela
