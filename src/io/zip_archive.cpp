#include "io/zip_archive.h"

#include <fmt/format.h>
#include <zip.h>

#include <algorithm>
#include <cstring>
#include <string_view>
#include <utility>

#include "base/error.h"
#include "base/file.h"

namespace candela::io {

namespace fs = std::filesystem;

namespace {

// Pictures, numbers and text get several times smaller; a thousand times, which Deflate can, is made to harm.
constexpr std::uint64_t kMostRatio = 100;
constexpr std::uint64_t kFreeBytes = std::uint64_t{64} << 20;
// As the files of a folder.
constexpr std::uint64_t kLargestFile = std::uint64_t{1} << 32;

std::string text_of(int code) {
  zip_error_t error;
  zip_error_init_with_code(&error, code);
  std::string text = zip_error_strerror(&error);
  zip_error_fini(&error);
  return text;
}

/// Whether unpacking it would write outside of the folder it is meant for.
bool leaves(const std::string& name) {
  if (name.starts_with('/') || (name.size() > 1 && name[1] == ':')) return true;
  for (const fs::path& part : fs::path(name)) {
    if (part == "..") return true;
  }
  return false;
}

bool is_of_macos(const std::string& name) {
  for (const fs::path& part : fs::path(name)) {
    if (part == "__MACOSX" || part.native().starts_with("._")) return true;
  }
  return false;
}

/// APPNOTE 4.4.15; the upper half is st_mode where the writer was a Unix.
bool is_link(zip_t* archive, zip_uint64_t index) {
  constexpr std::uint32_t kTypeMask = 0170000, kLink = 0120000;
  zip_uint8_t system = 0;
  zip_uint32_t attributes = 0;
  if (zip_file_get_external_attributes(archive, index, 0, &system, &attributes) != 0) return false;
  return system == ZIP_OPSYS_UNIX && (attributes >> 16 & kTypeMask) == kLink;
}

struct CloseFile {
  void operator()(zip_file_t* file) const { zip_fclose(file); }
};

}  // namespace

struct ZipArchive::Handle {
  std::vector<std::byte> bytes;  ///< of an archive in memory
  zip_t* archive = nullptr;

  ~Handle() {
    if (archive != nullptr) zip_discard(archive);
  }
};

bool is_zip(std::span<const std::byte> head) {
  constexpr std::string_view kFile = "PK\3\4", kEmpty = "PK\5\6";
  const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
  return text.starts_with(kFile) || text.starts_with(kEmpty);
}

bool is_zip(const fs::path& path) { return is_zip(candela::read_head(path, 4)); }

ZipArchive::ZipArchive(const fs::path& path) : label_(path.string()), handle_(std::make_unique<Handle>()) {
  int code = 0;
  handle_->archive = zip_open(path.c_str(), ZIP_RDONLY, &code);
  if (handle_->archive == nullptr) throw Error("not a readable .zip: " + text_of(code), label_);
  std::error_code ignored;
  most_unpacked_ = kFreeBytes + kMostRatio * fs::file_size(path, ignored);
  list();
}

ZipArchive::ZipArchive(std::vector<std::byte> data, std::string label)
    : label_(std::move(label)), handle_(std::make_unique<Handle>()) {
  const std::vector<std::byte>& bytes = handle_->bytes = std::move(data);
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
  if (source != nullptr) handle_->archive = zip_open_from_source(source, ZIP_RDONLY, &error);
  const std::string text = zip_error_strerror(&error);
  zip_error_fini(&error);
  if (handle_->archive == nullptr) {
    if (source != nullptr) zip_source_free(source);
    throw Error("not a readable .zip: " + text, label_);
  }
  most_unpacked_ = kFreeBytes + kMostRatio * bytes.size();
  list();
}

ZipArchive::~ZipArchive() = default;

void ZipArchive::list() {
  const zip_int64_t count = zip_get_num_entries(handle_->archive, 0);
  for (zip_uint64_t i = 0; i < static_cast<zip_uint64_t>(std::max<zip_int64_t>(count, 0)); ++i) {
    const char* text = zip_get_name(handle_->archive, i, ZIP_FL_ENC_GUESS);
    if (text == nullptr) throw Error("a name in it cannot be read", label_);
    std::string name = text;
    std::replace(name.begin(), name.end(), '\\', '/');
    if (leaves(name)) throw Error(fmt::format("the name '{}' in it leads out of the archive", name), label_);
    while (name.starts_with("./")) name.erase(0, 2);
    if (name.empty() || name.ends_with('/') || is_of_macos(name) || is_link(handle_->archive, i)) continue;
    index_of_name_.insert_or_assign(std::move(name), i);
  }
}

std::vector<std::string> ZipArchive::names() const {
  std::vector<std::string> result;
  result.reserve(index_of_name_.size());
  for (const auto& entry : index_of_name_) result.push_back(entry.first);
  return result;
}

std::uint64_t ZipArchive::index_of(const std::string& name) const {
  const auto found = index_of_name_.find(name);
  if (found == index_of_name_.end()) throw Error("no such file in the archive", place(name));
  return found->second;
}

/// What is read again is unpacked again, but takes no more memory at a time than it did before.
void ZipArchive::charge(const std::string& name, std::uint64_t index, std::uint64_t bytes) const {
  std::uint64_t& known = unpacked_[index];
  const std::uint64_t before = std::exchange(known, std::max(known, bytes));
  total_unpacked_ += known - before;
  if (total_unpacked_ > most_unpacked_ || bytes > kLargestFile) {
    throw Error(fmt::format("the archive unpacks to more than {} MiB: it is made to fill memory",
                            std::min(most_unpacked_, kLargestFile) >> 20),
                place(name));
  }
}

/// At most so many bytes. The archive's word for a size is checked before and after, and never believed in between.
std::vector<std::byte> ZipArchive::unpack(const std::string& name, std::uint64_t index, std::uint64_t most) const {
  constexpr std::size_t kPiece = std::size_t{1} << 20;
  zip_stat_t stat;
  zip_stat_init(&stat);
  if (zip_stat_index(handle_->archive, index, 0, &stat) != 0 || (stat.valid & ZIP_STAT_SIZE) == 0) {
    throw Error("the archive does not say what it is", place(name));
  }
  if ((stat.valid & ZIP_STAT_ENCRYPTION_METHOD) != 0 && stat.encryption_method != ZIP_EM_NONE) {
    throw Error("is encrypted", place(name));
  }
  const std::uint64_t size = std::min<std::uint64_t>(stat.size, most);
  charge(name, index, size);
  const std::unique_ptr<zip_file_t, CloseFile> file(zip_fopen_index(handle_->archive, index, 0));
  if (file == nullptr) throw Error(zip_error_strerror(zip_get_error(handle_->archive)), place(name));
  std::vector<std::byte> bytes;
  while (bytes.size() < size) {
    const std::size_t at = bytes.size();
    bytes.resize(static_cast<std::size_t>(std::min<std::uint64_t>(size, at + kPiece)));
    const zip_int64_t got = zip_fread(file.get(), bytes.data() + at, bytes.size() - at);
    if (got < 0) throw Error(zip_error_strerror(zip_file_get_error(file.get())), place(name));
    if (got == 0) throw Error("is shorter than the archive says", place(name));
    bytes.resize(at + static_cast<std::size_t>(got));
  }
  if (size < stat.size) return bytes;
  // The check sum is compared where the data ends.
  std::byte beyond{};
  const zip_int64_t got = zip_fread(file.get(), &beyond, 1);
  if (got < 0) throw Error(zip_error_strerror(zip_file_get_error(file.get())), place(name));
  if (got > 0) throw Error("is longer than the archive says", place(name));
  return bytes;
}

std::vector<std::byte> ZipArchive::read(const std::string& name) const {
  const std::uint64_t index = index_of(name);
  const std::lock_guard lock(mutex_);
  return unpack(name, index, kLargestFile + 1);
}

std::vector<std::byte> ZipArchive::read_head(const std::string& name, std::size_t count) const {
  const std::uint64_t index = index_of(name);
  const std::lock_guard lock(mutex_);
  return unpack(name, index, count);
}

}  // namespace candela::io
