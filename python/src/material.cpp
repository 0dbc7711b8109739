#include <fmt/format.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "arrays.h"
#include "base/error.h"
#include "base/named_row.h"
#include "base/text.h"
#include "scene.h"
#include "scene/material_table.h"

namespace candela::python {

namespace {

struct AlphaModeRow {
  AlphaMode mode;
  std::string_view name;
};
constexpr auto kAlphaModes = std::to_array<AlphaModeRow>(
    {{AlphaMode::opaque, "opaque"}, {AlphaMode::mask, "mask"}, {AlphaMode::blend, "blend"}});

/// What is on or off.
struct FlagRow {
  const char* name;
  bool Material::*member;
  const char* doc;
};
constexpr auto kFlags = std::to_array<FlagRow>({
    {"double_sided", &Material::double_sided, "Whether backs are seen."},
    {"unlit", &Material::unlit, "Shows its base colour whatever the light."},
});

std::string texture_property(const TextureRow& row) { return std::string(row.name) + "_texture"; }

/// Throws Error for what is no number of the row's range.
void set_number(const MaterialProperty& row, nb::handle value, Material& material) {
  const std::string name(row.name);
  vec3 numbers(0.0f);
  if (row.member.is_color()) {
    numbers = read_color(value, name);
  } else {
    numbers.x = static_cast<float>(PyFloat_AsDouble(value.ptr()));
    if (PyErr_Occurred() != nullptr) {
      PyErr_Clear();
      throw Error("is no number", name);
    }
  }
  for (int i = 0; i < row.member.size(); ++i) {
    const bool is_color_left = row.member == NumberOrColor(&Material::attenuation_color) && !(numbers[i] > 0.0f);
    if (is_color_left) throw Error("lets nothing through at all", name);
    if (row.range.contains(numbers[i])) continue;
    throw Error(fmt::format("{} lies outside {:g} to {:g}", numbers[i], row.range.lower, row.range.upper), name);
  }
  for (int i = 0; i < row.member.size(); ++i) row.member.at(material, i) = numbers[i];
}

void set_alpha_mode(nb::handle value, Material& material) {
  if (!nb::isinstance<nb::str>(value)) throw Error("is no text", "alpha_mode");
  material.alpha_mode = row_named(kAlphaModes, nb::cast<std::string>(value), "alpha_mode: unknown").mode;
}

std::string alpha_mode_of(const Material& material) {
  for (const AlphaModeRow& row : kAlphaModes) {
    if (row.mode == material.alpha_mode) return std::string(row.name);
  }
  return {};
}

void set_flag(const FlagRow& row, nb::handle value, Material& material) {
  if (!nb::isinstance<nb::bool_>(value)) throw Error("is neither True nor False", row.name);
  material.*row.member = nb::cast<bool>(value);
}

void set_texture(const SharedScene& scene, const TextureRow& row, nb::handle source, Material& material) {
  TextureSlot& slot = material.*row.slot;
  if (source.is_none()) {
    slot = {};
  } else {
    slot.texture = texture_of(scene, source, texture_property(row));
  }
}

std::vector<std::string> property_names() {
  std::vector<std::string> names;
  names.reserve(kMaterialProperties.size() + kTextureRows.size() + kFlags.size() + 1);
  for (const MaterialProperty& row : kMaterialProperties) names.emplace_back(row.name);
  for (const TextureRow& row : kTextureRows) names.push_back(texture_property(row));
  for (const FlagRow& row : kFlags) names.emplace_back(row.name);
  names.emplace_back("alpha_mode");
  return names;
}

/// Sets one property; false where there is none of that name.
bool set_property(const SharedScene& scene, const std::string& name, nb::handle value, Material& material) {
  for (const MaterialProperty& row : kMaterialProperties) {
    if (row.name == name) return set_number(row, value, material), true;
  }
  for (const TextureRow& row : kTextureRows) {
    if (texture_property(row) == name) return set_texture(scene, row, value, material), true;
  }
  for (const FlagRow& row : kFlags) {
    if (row.name == name) return set_flag(row, value, material), true;
  }
  if (name != "alpha_mode") return false;
  set_alpha_mode(value, material);
  return true;
}

std::string doc_of(const MaterialProperty& row) {
  constexpr float kMost = 3e38f;
  std::string range;
  if (row.range.lower > -kMost || row.range.upper < kMost) {
    const std::string upper = row.range.upper >= kMost ? "" : fmt::format("{:g}", row.range.upper);
    range = upper.empty() ? fmt::format("; {:g} or more", row.range.lower)
                          : fmt::format("; {:g} to {}", row.range.lower, upper);
    if (row.range.has_zero) range += ", or 0";
  }
  return (row.member.is_color() ? "Colour, linear: " : "") + std::string(row.doc) + range + ".";
}

}  // namespace

void set_properties(const SharedScene& scene, Material& material, const nb::kwargs& properties) {
  for (const auto& [key, value] : properties) {
    const std::string name = nb::cast<std::string>(key);
    if (set_property(scene, name, value, material)) continue;
    throw Error("no material has a property of this name" + did_you_mean(name, property_names()), name);
  }
}

void bind_material(nb::class_<MaterialRef>& type) {
  // NOLINTNEXTLINE(modernize-loop-convert): the functions keep the place
  for (std::size_t i = 0; i < kMaterialProperties.size(); ++i) {
    const MaterialProperty& row = kMaterialProperties[i];
    const std::string name(row.name);
    const std::string doc = doc_of(row);
    const auto set = [i](const MaterialRef& ref, const nb::object& value) {
      Material changed = get(ref);
      set_number(kMaterialProperties[i], value, changed);
      edit(ref) = changed;
    };
    if (row.member.is_color()) {
      const std::string getter = "def " + name + "(self) -> tuple[float, float, float]";
      const std::string setter = "def " + name + "(self, value: numpy.typing.ArrayLike) -> None";
      type.def_prop_rw(
          name.c_str(),
          [i](const MaterialRef& ref) {
            const auto& member = kMaterialProperties[i].member;
            const Material& m = get(ref);
            return nb::make_tuple(member.at(m, 0), member.at(m, 1), member.at(m, 2));
          },
          set, nb::for_getter(nb::sig(getter.c_str())), nb::for_setter(nb::sig(setter.c_str())), doc.c_str());
    } else {
      const std::string setter = "def " + name + "(self, value: float) -> None";
      type.def_prop_rw(
          name.c_str(), [i](const MaterialRef& ref) { return kMaterialProperties[i].member.at(get(ref), 0); }, set,
          nb::for_setter(nb::sig(setter.c_str())), doc.c_str());
    }
  }
  // NOLINTNEXTLINE(modernize-loop-convert): the functions keep the place
  for (std::size_t i = 0; i < kTextureRows.size(); ++i) {
    const std::string name = texture_property(kTextureRows[i]);
    const std::string setter =
        "def " + name + "(self, value: Texture | str | os.PathLike[str] | numpy.typing.ArrayLike | None) -> None";
    type.def_prop_rw(
        name.c_str(),
        [i](const MaterialRef& ref) -> std::optional<TextureRef> {
          const TextureSlot& slot = get(ref).*kTextureRows[i].slot;
          if (!slot) return std::nullopt;
          return TextureRef{ref.scene, static_cast<std::size_t>(slot.texture)};
        },
        [i](const MaterialRef& ref, const nb::object& source) {
          Material changed = get(ref);
          set_texture(ref.scene, kTextureRows[i], source, changed);
          edit(ref) = changed;
        },
        nb::arg("value").none(), nb::for_setter(nb::sig(setter.c_str())),
        kTextureRows[i].is_srgb() ? "sRGB encoded, as image files are." : "Data, not encoded.");
  }
  // NOLINTNEXTLINE(modernize-loop-convert): the functions keep the place
  for (std::size_t i = 0; i < kFlags.size(); ++i) {
    const std::string setter = std::string("def ") + kFlags[i].name + "(self, value: bool) -> None";
    type.def_prop_rw(
        kFlags[i].name, [i](const MaterialRef& ref) { return get(ref).*kFlags[i].member; },
        [i](const MaterialRef& ref, const nb::object& value) {
          Material changed = get(ref);
          set_flag(kFlags[i], value, changed);
          edit(ref) = changed;
        },
        nb::for_setter(nb::sig(setter.c_str())), kFlags[i].doc);
  }
  type.def_prop_rw(
      "alpha_mode", [](const MaterialRef& ref) { return alpha_mode_of(get(ref)); },
      [](const MaterialRef& ref, const nb::object& value) {
        Material changed = get(ref);
        set_alpha_mode(value, changed);
        edit(ref) = changed;
      },
      nb::for_setter(nb::sig("def alpha_mode(self, value: str) -> None")), "\"opaque\", \"mask\" or \"blend\".");
  type.def(
      "set",
      [](const MaterialRef& ref, const nb::kwargs& properties) {
        Material changed = get(ref);
        set_properties(ref.scene, changed, properties);
        edit(ref) = changed;
      },
      nb::sig("def set(self, **properties: object) -> None"),
      "Sets several properties by their names, all or none. Raises Error.");
}

}  // namespace candela::python
