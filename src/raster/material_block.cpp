#include "raster/material_block.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <variant>

#include "raster/opacity.h"
#include "scene/cutoff.h"
#include "scene/material_table.h"
#include "scene/surface_params.h"

namespace candela::raster {

namespace {

float cutoff(const Material& m) { return drawn_cutoff(m.alpha_cutoff); }

/// The mean free path, for each colour; Christensen & Burley 2015, "Approximate Reflectance Profiles for Efficient
/// Subsurface Scattering", eq. 3 and 6, say how wide light spreads.
vec3 scattering_width(const Material& m) {
  vec3 width(0.0f);
  if (!is_scattering(m)) return width;
  const vec3 extinction = volume_extinction(m);
  for (int c = 0; c < 3; ++c) {
    const float a = m.multiscatter_color[c];
    width[c] = 1.0f / (std::max(extinction[c], 1e-6f) * (1.85f - a + 7.0f * std::pow(std::abs(a - 0.8f), 3.0f)));
  }
  return width;
}

/// What follows from properties, and is read more often than it is written.
struct Derived {
  std::string_view name;
  std::variant<float (*)(const Material&), vec3 (*)(const Material&)> value;
  std::string_view doc;
};

constexpr auto kDerived = std::to_array<Derived>({
    {"drawn_cutoff", cutoff, "alpha_cutoff, less what rounding takes"},
    {"extinction", volume_extinction, "1/m"},
    {"scatter_width", scattering_width, "how wide light spreads in a scattering body, metres"},
});

/// How a slot turns coordinates: along_u * u + along_v * v + offset of the set at place `uv_set`.
struct UvTransform {
  vec2 along_u{1, 0};
  vec2 along_v{0, 1};
  vec2 offset{0};
  float uv_set = 0.0f;
  float padding = 0.0f;
};
static_assert(offsetof(UvTransform, along_v) == 8 && offsetof(UvTransform, offset) == 16 &&
              offsetof(UvTransform, uv_set) == 24 && sizeof(UvTransform) == 32);

// The block holds the properties, what is derived of them, and cosine and sine of each direction's rotation, of which a
// driver's own have few digits.
constexpr std::size_t kFirstDerived = kMaterialProperties.size();
constexpr std::size_t kFirstDirection = kFirstDerived + kDerived.size();
constexpr std::size_t kFields = kFirstDirection + 2 * kDirectionRows.size();

constexpr bool is_color(std::size_t field) {
  if (field >= kFirstDirection) return false;
  return field < kFirstDerived ? kMaterialProperties[field].member.is_color()
                               : kDerived[field - kFirstDerived].value.index() == 1;
}

/// Of a direction, in the shaders.
std::string_view name_of(const DirectionRow& row) { return kTextureRows[texture_slot_index(row.texture)].name; }

std::string name_of(std::size_t field) {
  if (field < kFirstDirection) {
    return std::string(field < kFirstDerived ? kMaterialProperties[field].name : kDerived[field - kFirstDerived].name);
  }
  const std::size_t i = field - kFirstDirection;
  return fmt::format("{}_{}", name_of(kDirectionRows[i / 2]), i % 2 == 0 ? "cos" : "sin");
}

constexpr std::string_view doc_of(std::size_t field) {
  if (field >= kFirstDirection) return "of its rotation";
  return field < kFirstDerived ? kMaterialProperties[field].doc : kDerived[field - kFirstDerived].doc;
}

constexpr std::size_t aligned(std::size_t at, std::size_t alignment) {
  return (at + alignment - 1) / alignment * alignment;
}

/// std140: three numbers begin at a multiple of sixteen bytes, and one may follow within them (OpenGL ES 3.0,
/// §2.12.6.4). The last offset is that of the coordinates' transforms.
constexpr auto kOffsets = [] {
  std::array<std::size_t, kFields + 1> offsets{};
  std::size_t at = 0;
  for (std::size_t i = 0; i < kFields; ++i) {
    offsets[i] = aligned(at, is_color(i) ? 16 : 4);
    at = offsets[i] + (is_color(i) ? 12 : 4);
  }
  offsets[kFields] = aligned(at, 16);
  return offsets;
}();
constexpr std::size_t kSize = kOffsets[kFields] + kTextureSlots * sizeof(UvTransform);
static_assert(kSize % 16 == 0 && kSize <= 16384, "the least that OpenGL ES 3.0 promises");

/// Where the shader finds a set: 0, 1, then those of `more`.
int place_of(int set, std::span<const int> more) {
  return set < 2 ? set : 2 + static_cast<int>(std::lower_bound(more.begin(), more.end(), set) - more.begin());
}

std::string_view components_of(Texel texel) {
  constexpr std::array<std::string_view, 5> kComponents = {"r", "g", "b", "a", "rgb"};
  return kComponents[static_cast<std::size_t>(texel)];
}

std::string fetch_text(const MaterialProperty& row) {
  std::string text = fmt::format("  p.{} = material.{};\n", row.param_name, row.name);
  if (!row.texture) return text;
  text += fmt::format("#ifdef {}_factor\n", row.name);
  if (row.texture.low != nullptr) {
    text += fmt::format("  p.{0} = mix(material.{1}, material.{2}, {2}_factor());\n", row.param_name,
                        property_of(row.texture.low).name, row.name);
  } else {
    text += fmt::format("  p.{} *= {}_factor();\n", row.param_name, row.name);
  }
  return text + "#endif\n";
}

/// A direction, of the front's tangent and bitangent.
std::string direction_text(const DirectionRow& row) {
  return fmt::format(
      "vec3 {0}_direction(vec3 t, vec3 b) {{\n"
      "  vec2 turn = vec2(material.{0}_cos, material.{0}_sin);\n"
      "#ifdef HAS_{0}\n  turn = normal_turned(turn, {0}_texel().xy);\n#endif\n"
      "  return t * turn.x + b * turn.y;\n}}\n",
      name_of(row));
}

}  // namespace

bool is_scattering(const Material& m) {
  return m.has_volume() && (m.transmission > 0.0f || m.diffuse_transmission > 0.0f) && !m.unlit &&
         max_component(m.multiscatter_color) > 0.0f && max_component(volume_extinction(m)) > 0.0f;
}

std::vector<BlockField> material_block_fields() {
  std::vector<BlockField> fields;
  fields.reserve(kFields);
  for (std::size_t i = 0; i < kFields; ++i) fields.push_back({fmt::format("Material.{}", name_of(i)), kOffsets[i]});
  for (const std::size_t slot : {std::size_t{0}, kTextureSlots - 1}) {
    const std::size_t at = kOffsets[kFields] + slot * sizeof(UvTransform);
    const auto add = [&](const char* name, std::size_t offset) {
      fields.push_back({fmt::format("Material.uv[{}].{}", slot, name), at + offset});
    };
    add("along_u", offsetof(UvTransform, along_u));
    add("along_v", offsetof(UvTransform, along_v));
    add("offset", offsetof(UvTransform, offset));
    add("uv_set", offsetof(UvTransform, uv_set));
  }
  return fields;
}

std::size_t material_block_size() { return kSize; }

void write_material_block(const Material& m, std::span<const int> more_sets, std::byte* to) {
  std::memset(to, 0, kSize);
  const auto put = [to](std::size_t field, const auto& value) {
    std::memcpy(to + kOffsets[field], &value, sizeof value);
  };
  std::size_t field = 0;
  for (const MaterialProperty& row : kMaterialProperties) {
    row.member.is_color() ? put(field, m.*row.member.color) : put(field, m.*row.member.number);
    ++field;
  }
  for (const Derived& row : kDerived) {
    std::visit([&](const auto& value) { put(field, value(m)); }, row.value);
    ++field;
  }
  for (const DirectionRow& row : kDirectionRows) {
    put(field++, std::cos(m.*row.rotation));
    put(field++, std::sin(m.*row.rotation));
  }
  const auto slots = texture_slots(m);
  for (std::size_t i = 0; i < kTextureSlots; ++i) {
    const auto& t = slots[i]->transform;
    const UvTransform uv{t[0], t[1], t[2], static_cast<float>(place_of(slots[i]->uv_set, more_sets)), 0.0f};
    std::memcpy(to + kOffsets[kFields] + i * sizeof uv, &uv, sizeof uv);
  }
}

std::string material_block_text() {
  std::string text =
      "struct UvTransform {\n  vec2 along_u;\n  vec2 along_v;\n  vec2 offset;\n  float uv_set;\n};\n\n"
      "layout(std140) uniform Material {\n";
  for (std::size_t i = 0; i < kFields; ++i) {
    text += fmt::format("  {} {};  // {}\n", is_color(i) ? "vec3" : "float", name_of(i), doc_of(i));
  }
  return text + fmt::format("  UvTransform uv[{}];\n}} material;\n", kTextureSlots);
}

std::string material_fetch_text() {
  std::string base, layers, directions, turned;
  for (const DirectionRow& row : kDirectionRows) {
    directions += direction_text(row);
    if (row.param == nullptr) continue;
    turned += fmt::format("  p.{} = {}_direction(t, b) * frame;\n", row.param_name, name_of(row));
  }
  for (const MaterialProperty& row : kMaterialProperties) {
    if (row.param) (row.lobe.bit == 0 ? base : layers) += fetch_text(row);
  }
  return "void fetch_factors(inout SurfaceParams p) {\n" + base + "#ifdef HAS_LAYERS\n" + layers + "#endif\n}\n" +
         directions + "void fetch_directions(vec3 t, vec3 b, mat3 frame, inout SurfaceParams p) {\n" + turned + "}\n";
}

std::string factor_texts(std::size_t slot) {
  std::string text;
  for (const MaterialProperty& row : kMaterialProperties) {
    if (row.texture.slot != kTextureRows[slot].slot || row.texture.texel == Texel::special) continue;
    text += fmt::format("#define {}_factor() {}_texel().{}\n", row.name, kTextureRows[slot].name,
                        components_of(row.texture.texel));
  }
  return text;
}

}  // namespace candela::raster
