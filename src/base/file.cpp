#include "base/file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "base/error.h"
#include "base/large_pages.h"
#include "base/text.h"

namespace candela {

namespace fs = std::filesystem;

namespace {

std::string reason(int error) { return std::strerror(error); }

}  // namespace

std::vector<std::byte> read_file(const fs::path& path, std::uint64_t max_bytes) {
  std::error_code code;
  const auto status = fs::status(path, code);
  if (!fs::exists(status)) throw Error("no such file", path.string());
  if (!fs::is_regular_file(status)) throw Error("not a regular file", path.string());
  const std::uint64_t size = fs::file_size(path, code);
  if (code) throw Error("cannot read: " + code.message(), path.string());
  if (size > max_bytes) throw Error("file of " + std::to_string(size) + " bytes is too large", path.string());

  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw Error("cannot open: " + reason(errno), path.string());
  std::vector<std::byte> bytes;
  resize_large(bytes, static_cast<std::size_t>(size));
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (static_cast<std::uint64_t>(stream.gcount()) != size) throw Error("cannot read the whole file", path.string());
  return bytes;
}

std::vector<std::byte> read_head(const fs::path& path, std::size_t count) {
  std::vector<std::byte> bytes(count);
  std::error_code code;
  if (!fs::is_regular_file(path, code)) return {};
  std::ifstream stream(path, std::ios::binary);
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(count));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

bool is_device(const fs::path& path) {
  std::error_code code;
  const fs::file_status status = fs::status(path, code);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

std::uint64_t fingerprint(std::span<const std::byte> bytes, std::uint64_t before) {
  // Fowler, Noll & Vo, draft-eastlake-fnv; the shift spreads what a product moves upwards only.
  constexpr std::uint64_t kPrime = 0x100000001b3ull;
  std::uint64_t h = before;
  for (; bytes.size() >= 8; bytes = bytes.subspan(8)) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data(), 8);
    h = (h ^ word) * kPrime;
    h ^= h >> 29;
  }
  for (const std::byte b : bytes) h = (h ^ static_cast<std::uint64_t>(b)) * kPrime;
  return h;
}

fs::path real_path(const fs::path& path) {
  std::error_code code;
  const fs::path absolute = fs::absolute(path, code);
  const fs::path real = fs::weakly_canonical(absolute, code);
  return real.empty() ? absolute.lexically_normal() : real;
}

std::string file_identity(const fs::path& path) {
  // A link to what is not there is made into a file at its own place, and a folder that is not there is made before
  // `..` leads out of it.
  const fs::path real = real_path(path);
  for (const fs::path& name : {path, real}) {
    struct stat status {};
    if (stat(name.c_str(), &status) == 0) {
      return '#' + std::to_string(status.st_dev) + ':' + std::to_string(status.st_ino);
    }
  }
  return lower_case(real.string());
}

AtomicFile::AtomicFile(fs::path target) : target_(std::move(target)) {
  std::error_code ignored;
  // A link stays a link: what it names is replaced. A device or a pipe cannot be replaced, only written to.
  if (const fs::path real = fs::weakly_canonical(target_, ignored); fs::is_symlink(target_, ignored) && !real.empty())
    target_ = real;
  if (is_device(target_)) {
    temp_ = target_;
    committed_ = true;
    return;
  }
  // The extension stays last, because image writers choose their format by it.
  const std::string name = "." + target_.stem().string() + ".XXXXXX" + target_.extension().string();
  std::string pattern = (target_.parent_path() / name).string();
  std::error_code code;
  if (fs::is_directory(target_, code)) throw Error("is a folder, not a file", target_.string());
  const int file = mkstemps(pattern.data(), static_cast<int>(target_.extension().string().size()));
  if (file < 0) throw Error("cannot write: " + reason(errno), target_.string());
  // mkstemps makes the file private; an output picture should follow the user's umask.
  const mode_t mask = umask(0);
  umask(mask);
  (void)fchmod(file, 0666 & ~mask);
  ::close(file);
  temp_ = pattern;
}

AtomicFile::~AtomicFile() {
  std::error_code code;
  if (!committed_) fs::remove(temp_, code);
}

void AtomicFile::commit() {
  if (committed_) return;
  std::error_code code;
  fs::rename(temp_, target_, code);
  if (code) throw Error("cannot write: " + code.message(), target_.string());
  committed_ = true;
}

void write_file(const fs::path& path, std::span<const std::byte> bytes) {
  AtomicFile file(path);
  std::ofstream stream(file.temp_path(), std::ios::binary | std::ios::trunc);
  stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (!stream) throw Error("cannot write (is the disk full?)", path.string());
  file.commit();
}

void write_file(const fs::path& path, const std::string& text) {
  write_file(path, std::as_bytes(std::span(text.data(), text.size())));
}

}  // namespace candela
