#pragma once

#include <ImfIO.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/error.h"

// OpenEXR's streams in memory, and its exceptions as ours. Private to this folder.
namespace candela::codec {

class MemoryInput final : public Imf::IStream {
 public:
  MemoryInput(std::span<const std::byte> bytes, const std::string& where) : IStream(where.c_str()), bytes_(bytes) {}

  bool read(char out[], int count) override {
    const auto n = static_cast<std::uint64_t>(count);
    if (count < 0 || offset_ > bytes_.size() || n > bytes_.size() - offset_)
      throw std::runtime_error("the file is truncated");
    std::memcpy(out, bytes_.data() + offset_, n);
    offset_ += n;
    return offset_ < bytes_.size();
  }
  std::uint64_t tellg() override { return offset_; }
  void seekg(std::uint64_t position) override { offset_ = position; }

 private:
  std::span<const std::byte> bytes_;
  std::uint64_t offset_ = 0;
};

class MemoryOutput final : public Imf::OStream {
 public:
  explicit MemoryOutput(const std::string& where) : OStream(where.c_str()) {}

  void write(const char data[], int count) override {
    const auto n = static_cast<std::size_t>(count);
    if (bytes.size() < offset_ + n) bytes.resize(offset_ + n);
    std::memcpy(bytes.data() + offset_, data, n);
    offset_ += n;
  }
  std::uint64_t tellp() override { return offset_; }
  void seekp(std::uint64_t position) override { offset_ = position; }

  std::vector<std::byte> bytes;

 private:
  std::size_t offset_ = 0;
};

/// Runs `body`, turning whatever OpenEXR throws into an Error.
template <class Body>
auto converting_errors(const char* what, const std::string& where, Body body) {
  try {
    return body();
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    throw Error(std::string(what) + e.what(), where);
  }
}

}  // namespace candela::codec
