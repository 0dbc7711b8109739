#include "foreign/units.h"

#include <assimp/version.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "foreign/little_endian.h"

namespace candela::foreign {

mat4 matrix_of(const aiMatrix4x4& m) {
  return {vec4(m.a1, m.b1, m.c1, m.d1), vec4(m.a2, m.b2, m.c2, m.d2), vec4(m.a3, m.b3, m.c3, m.d3),
          vec4(m.a4, m.b4, m.c4, m.d4)};
}

namespace {

template <class T>
T metadata(const aiScene& scene, const char* key, T fallback) {
  T value{};
  return scene.mMetaData != nullptr && scene.mMetaData->Get(key, value) ? value : fallback;
}

/// A row that picks one axis of three, with its sign.
vec3 axis(const aiScene& scene, const std::string& name, int fallback) {
  const int index = metadata<int>(scene, name.c_str(), fallback);
  vec3 row(0.0f);
  row[index >= 0 && index < 3 ? index : fallback] = metadata<int>(scene, (name + "Sign").c_str(), 1) < 0 ? -1.0f : 1.0f;
  return row;
}

mat4 scaled(float scale, vec3 x, vec3 y, vec3 z) {
  return glm::transpose(mat4(vec4(x * scale, 0), vec4(y * scale, 0), vec4(z * scale, 0), vec4(0, 0, 0, 1)));
}

/// +z becomes +y.
mat4 z_up(float scale) { return scaled(scale, {1, 0, 0}, {0, 0, 1}, {0, -1, 0}); }

Units units_of_fbx(const aiScene& scene) {
  constexpr float kCentimetre = 0.01f;
  Units units;
  const float factor = metadata<float>(scene, "UnitScaleFactor", 1.0f);
  if (factor > 0.0f && std::isfinite(factor)) units.metres_per_unit = factor * kCentimetre;
  vec3 x = axis(scene, "CoordAxis", 0), y = axis(scene, "UpAxis", 1), z = axis(scene, "FrontAxis", 2);
  const float handedness = glm::dot(glm::cross(x, y), z);
  if (handedness == 0.0f) {
    x = {1, 0, 0}, y = {0, 1, 0}, z = {0, 0, 1};  // two axes are the same: none can be believed
  }
  units.metres_from_root = scaled(units.metres_per_unit, x, y, z);
  units.replaces_root = true;  // in the file it is the identity
  const bool halves = aiGetVersionMajor() > 5 || (aiGetVersionMajor() == 5 && aiGetVersionMinor() > 2);
  units.angle_per_fov = halves ? 2.0f : 1.0f;
  return units;
}

/// The value of the attribute `unit` of the element <model>.
std::string unit_of_model(std::string_view xml) {
  const std::size_t element = xml.find("<model");
  if (element == xml.npos) return {};
  const std::string_view tag = xml.substr(element, xml.find('>', element) - element);
  for (const char quote : {'"', '\''}) {
    const std::string key = std::string("unit=") + quote;
    const std::size_t at = tag.find(key);
    if (at == tag.npos) continue;
    const std::string_view rest = tag.substr(at + key.size());
    return std::string(rest.substr(0, rest.find(quote)));
  }
  return {};
}

/// The first bytes of what a zip holds at `offset`, stored or deflated. PKWARE, "APPNOTE.TXT - .ZIP File Format
/// Specification", §4.3.7; RFC 1951.
std::string unpacked_head(std::string_view zip, std::size_t offset) {
  constexpr std::size_t kHeader = 30, kMethod = 8, kNameLength = 26, kExtraLength = 28, kHead = 4096;
  if (offset + kHeader > zip.size()) return {};
  const std::size_t data =
      offset + kHeader + little_endian(zip, offset + kNameLength, 2) + little_endian(zip, offset + kExtraLength, 2);
  if (data > zip.size()) return {};
  const std::string_view packed = zip.substr(data);
  const std::uint32_t method = little_endian(zip, offset + kMethod, 2);
  if (method == 0) return std::string(packed.substr(0, kHead));
  constexpr std::uint32_t kDeflated = 8;
  z_stream stream{};
  if (method != kDeflated || inflateInit2(&stream, -MAX_WBITS) != Z_OK) return {};
  std::string head(kHead, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));  // zlib does not write there
  stream.avail_in = static_cast<uInt>(std::min<std::size_t>(packed.size(), 1 << 20));
  stream.next_out = reinterpret_cast<Bytef*>(head.data());
  stream.avail_out = static_cast<uInt>(head.size());
  inflate(&stream, Z_SYNC_FLUSH);
  head.resize(head.size() - stream.avail_out);
  inflateEnd(&stream);
  return head;
}

/// What the model of a 3MF says of its unit; empty where it says nothing.
std::string unit_of_package(std::string_view zip) {
  constexpr std::string_view kEntry("PK\1\2", 4);
  constexpr std::size_t kEntrySize = 46, kNameLength = 28, kOffset = 42;
  for (std::size_t at = zip.find(kEntry); at != zip.npos && at + kEntrySize <= zip.size();
       at = zip.find(kEntry, at + kEntry.size())) {
    const std::string_view name = zip.substr(at + kEntrySize, little_endian(zip, at + kNameLength, 2));
    if (!name.ends_with(".model")) continue;
    std::string unit = unit_of_model(unpacked_head(zip, little_endian(zip, at + kOffset, 4)));
    if (!unit.empty()) return unit;
  }
  return {};
}

Units units_of_3mf(std::string_view zip) {
  constexpr std::pair<std::string_view, float> kUnits[] = {{"micron", 1e-6f},     {"millimeter", 1e-3f},
                                                           {"centimeter", 1e-2f}, {"inch", 0.0254f},
                                                           {"foot", 0.3048f},     {"meter", 1.0f}};
  const std::string unit = unit_of_package(zip);
  Units units;
  units.metres_per_unit = 1e-3f;
  for (const auto& [name, metres] : kUnits) {
    if (unit == name) units.metres_per_unit = metres;
  }
  units.metres_from_root = z_up(units.metres_per_unit);
  return units;
}

}  // namespace

Units units_of(const aiScene& scene, Format format, std::span<const std::byte> bytes, const Measures& measures) {
  if (format == Format::fbx) return units_of_fbx(scene);
  if (format == Format::three_mf) return units_of_3mf({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  Units units;
  if (format == Format::collada && scene.mRootNode != nullptr) {
    units.metres_per_unit = glm::length(vec3(matrix_of(scene.mRootNode->mTransformation)[0]));
    if (!(units.metres_per_unit > 0.0f)) units.metres_per_unit = 1.0f;
  } else if (is_silent(format)) {
    units.metres_per_unit = measures.metres_per_unit.value_or(1.0f);
    const bool is_z_up = measures.is_z_up.value_or(false);
    units.metres_from_root =
        is_z_up ? z_up(units.metres_per_unit) : scaled(units.metres_per_unit, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
  }
  return units;
}

}  // namespace candela::foreign
