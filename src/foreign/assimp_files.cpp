#include "foreign/assimp_files.h"

#include <algorithm>
#include <cstring>
#include <span>
#include <string_view>

#include "base/error.h"

namespace candela::foreign {

namespace {

/// Bytes in memory, its own or another's.
class MemoryStream : public Assimp::IOStream {
 public:
  explicit MemoryStream(std::span<const std::byte> bytes) : bytes_(bytes) {}
  explicit MemoryStream(std::vector<std::byte> bytes) : owned_(std::move(bytes)), bytes_(owned_) {}

  std::size_t Read(void* out, std::size_t size, std::size_t count) override {
    if (size == 0 || count == 0) return 0;
    const std::size_t items = std::min(count, (bytes_.size() - at_) / size);
    std::memcpy(out, bytes_.data() + at_, items * size);
    at_ += items * size;
    return items;
  }
  std::size_t Write(const void*, std::size_t, std::size_t) override { return 0; }
  aiReturn Seek(std::size_t offset, aiOrigin origin) override {
    const std::size_t from = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? at_ : bytes_.size();
    const std::size_t to = from + offset;  // a step back wraps around
    if (to > bytes_.size()) return aiReturn_FAILURE;
    at_ = to;
    return aiReturn_SUCCESS;
  }
  std::size_t Tell() const override { return at_; }
  std::size_t FileSize() const override { return bytes_.size(); }
  void Flush() override {}

 private:
  std::vector<std::byte> owned_;
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
};

std::string plain(std::string_view name) {
  while (name.starts_with("./")) name.remove_prefix(2);
  return std::string(name);
}

bool is_material_library(std::string_view name) { return name.ends_with(".mtl") || name.ends_with(".MTL"); }

}  // namespace

bool AssimpFiles::Exists(const char* name) const {
  const std::string asked = plain(name);
  return asked == main_name_ || (!is_material_library(asked) && around_.has(asked));
}

Assimp::IOStream* AssimpFiles::Open(const char* name, const char* mode) {
  if (std::strpbrk(mode, "wa+") != nullptr) return nullptr;
  const std::string asked = plain(name);
  if (asked == main_name_) return new MemoryStream(main_);
  if (is_material_library(asked)) return nullptr;
  const std::string found = find_reference(around_, asked);
  if (!around_.has(found)) return nullptr;
  try {
    std::vector<std::byte> bytes = around_.read(found);
    opened_.push_back(found);
    return new MemoryStream(std::move(bytes));
  } catch (const Error&) {
    return nullptr;  // as one that is not there
  }
}

}  // namespace candela::foreign
