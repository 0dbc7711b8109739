#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "image/basis_etc1s.h"
#include "image/texture_file.h"

// What texture_file.cpp dispatches to, one file per container. Private to this folder. All throw Error(…, where).
namespace candela::codec {

enum class Packing { none, zstd, zlib, basis_lz, unknown };

/// A level as it lies in the file.
struct StoredLevel {
  int width = 0;
  int height = 0;
  std::vector<std::span<const std::byte>> faces;  ///< one per face; empty where the level is packed
  std::span<const std::byte> packed;              ///< the faces in a row, supercompressed
};

/// A file taken apart: every number in it has been looked at, nothing has been decoded. Where the format is unknown or
/// the kind is not read, `levels` is empty.
struct StoredTexture {
  TextureInfo info;
  Packing packing = Packing::none;
  std::size_t row_alignment = 1;
  std::vector<StoredLevel> levels;
  std::span<const std::byte> global_data;  ///< BasisLZ: what the images share
  std::vector<Etc1sImage> images;          ///< BasisLZ: level by level, face by face
};

/// By the container that its first bytes name.
StoredTexture parse_texture(std::span<const std::byte> bytes, const std::string& where);
StoredTexture parse_ktx2(std::span<const std::byte> bytes, const std::string& where);
StoredTexture parse_ktx1(std::span<const std::byte> bytes, const std::string& where);
StoredTexture parse_dds(std::span<const std::byte> bytes, const std::string& where);

/// A texture in texels, ready to be put into a container.
struct EncodedTexture {
  TexelFormat format = TexelFormat::rgba16f;
  int width = 0;
  int height = 0;
  int faces = 1;
  std::vector<std::vector<std::vector<std::byte>>> levels;  ///< texels by level and face, rows without padding
  std::map<std::string, std::string> key_values;
};

std::vector<std::byte> pack_ktx2(const EncodedTexture& texture, bool zstd, int zstd_level);
std::vector<std::byte> pack_ktx1(const EncodedTexture& texture, bool has_filament_type);
std::vector<std::byte> pack_dds(const EncodedTexture& texture, const std::string& where);

// ----- helpers that the containers share

inline constexpr int kMaxLevels = 15;  // of 16384 texels

/// Side of a level.
inline int level_size(int size, std::size_t level) { return std::max(1, size >> level); }

/// Numbers of a header, the small end first. Throws where the bytes end.
class ByteReader {
 public:
  ByteReader(std::span<const std::byte> bytes, const std::string& where) : bytes_(bytes), where_(where) {}

  std::uint32_t u32() { return number<std::uint32_t>(); }
  std::uint64_t u64() { return number<std::uint64_t>(); }
  void seek(std::size_t offset) { offset_ = offset; }
  std::size_t offset() const { return offset_; }
  /// The next `count` bytes.
  std::span<const std::byte> take(std::uint64_t count) {
    const std::span<const std::byte> result = part(offset_, count);
    offset_ += static_cast<std::size_t>(count);
    return result;
  }
  /// Any part of the file.
  std::span<const std::byte> part(std::uint64_t offset, std::uint64_t count) const {
    if (offset > bytes_.size() || count > bytes_.size() - offset) throw Error("the file is truncated", where_);
    return bytes_.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(count));
  }

 private:
  template <class T>
  T number() {
    T value;
    std::memcpy(&value, take(sizeof(T)).data(), sizeof(T));
    return value;
  }

  std::span<const std::byte> bytes_;
  const std::string& where_;
  std::size_t offset_ = 0;
};

class ByteWriter {
 public:
  void u32(std::uint32_t value) { number(value); }
  void u64(std::uint64_t value) { number(value); }
  void text(std::string_view value) { append(std::as_bytes(std::span(value.data(), value.size()))); }
  void append(std::span<const std::byte> value) { bytes.insert(bytes.end(), value.begin(), value.end()); }
  void zeros(std::size_t count) { bytes.resize(bytes.size() + count); }
  void align(std::size_t alignment) { zeros((alignment - bytes.size() % alignment) % alignment); }
  /// Overwrites eight bytes that were written before.
  void put_u64(std::size_t offset, std::uint64_t value) { std::memcpy(bytes.data() + offset, &value, sizeof value); }

  std::vector<std::byte> bytes;

 private:
  template <class T>
  void number(T value) {
    append(std::as_bytes(std::span(&value, 1)));
  }
};

/// Sizes that a file may have: 2-D or cube, at most kMaxTextureSize, no more levels than halvings.
void check_shape(const TextureInfo& info, std::uint32_t width, std::uint32_t height, std::uint32_t faces,
                 std::uint32_t levels, const std::string& where);

/// Throws where format, packing or kind of the texture are not read.
void check_kind(const StoredTexture& stored, const std::string& where);
/// Throws where `pixels` of `pixel_bytes` each are more than `max_bytes`.
void check_pixels(const TextureInfo& info, std::uint64_t pixels, std::uint64_t pixel_bytes, std::uint64_t max_bytes,
                  const std::string& where);

/// A level's faces as bytes; those of a packed level are kept in `storage`.
std::vector<std::span<const std::byte>> unpacked_faces(const StoredTexture& stored, const StoredLevel& level,
                                                       std::vector<std::byte>& storage, const std::string& where);

/// Bytes of one face of a level in blocks.
std::uint64_t block_bytes(const BlockFormat& format, int width, int height);

/// Blocks to RGBA texels. What the images of a file share is read once.
class BlockReader {
 public:
  BlockReader(const StoredTexture& stored, const std::string& where);
  ~BlockReader();
  BlockReader(const BlockReader&) = delete;
  BlockReader& operator=(const BlockReader&) = delete;

  /// One image of `level`, as `face` of unpacked_faces has it (BasisLZ: the whole level). 8 bits as coded.
  std::vector<std::uint8_t> codes(std::size_t level, std::size_t face, std::span<const std::byte> bytes);
  /// Of a format with a high dynamic range.
  std::vector<float> numbers(std::size_t level, std::span<const std::byte> bytes);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// Bytes of one face of a level, rows padded to `row_alignment`.
std::uint64_t face_bytes(const TexelLayout& layout, int width, int height, std::size_t row_alignment);

/// Adds the entries of a KTX key/value block; both versions store them alike.
void parse_key_values(std::span<const std::byte> block, TextureInfo& info, const std::string& where);
/// KTXwriter and KTXorientation are added where `key_values` does not have them.
void pack_key_values(ByteWriter& out, const std::string& orientation,
                     const std::map<std::string, std::string>& key_values);

}  // namespace candela::codec
