#include "ibl/profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"

namespace candela::ibl {

namespace {

constexpr CubeAxes kWorld{};
constexpr CubeAxes kMirroredZ{{0, 1, 2}, {1, 1, -1}};
constexpr CubeAxes kSwappedYz{{0, 2, 1}, {1, 1, 1}};  // a left-handed world with z upwards

constexpr TableAxes kPlainTable{};
constexpr TableAxes kMixTable{.channels = TableChannels::mix};

constexpr Profile kProfiles[] = {
    {.name = "filament",
     .engine = "Filament",
     .axes = kWorld,
     .sh_axes = kWorld,
     .panorama_turn = -0.25f,
     .curve = RoughnessCurve::quadratic,
     .size = 256,
     .levels = 5,
     .is_filtered = true,
     .container = ProfileContainer::ktx1,
     .format = TexelFormat::r11g11b10f,
     .has_zstd = false,
     .diffuse_map = DiffuseUnit::none,
     .diffuse_sh = DiffuseUnit::polynomial_over_pi,
     .table = TableAxes{.last_row_is_zero = true, .channels = TableChannels::mix}},
    {.name = "three",
     .engine = "three.js",
     .axes = kPictureAxes,
     .sh_axes = kWorld,
     .panorama_turn = 0.0f,
     .curve = RoughnessCurve::linear,
     .size = 512,
     .levels = 1,
     .is_filtered = false,
     .container = ProfileContainer::hdr_faces,
     .format = TexelFormat::rgba16f,
     .has_zstd = false,
     .diffuse_map = DiffuseUnit::none,
     .diffuse_sh = DiffuseUnit::radiance,
     .table = TableAxes{.roughness_in_rows = false}},
    {.name = "babylon",
     .engine = "Babylon.js",
     .axes = kPictureAxes,
     .sh_axes = kPictureAxes,
     .panorama_turn = 0.0f,
     .curve = RoughnessCurve::alpha_log2,
     .size = 256,
     .levels = 9,
     .is_filtered = true,
     .container = ProfileContainer::dds,
     .format = TexelFormat::rgba16f,
     .has_zstd = false,
     .diffuse_map = DiffuseUnit::none,
     .diffuse_sh = DiffuseUnit::powers_over_pi,
     .table = kMixTable},
    {.name = "khronos",
     .engine = "Khronos glTF Sample Renderer",
     .axes = kWorld,
     .sh_axes = kWorld,
     .panorama_turn = 0.0f,
     .curve = RoughnessCurve::linear,
     .size = 256,
     .levels = 6,
     .is_filtered = true,
     .container = ProfileContainer::ktx2,
     .format = TexelFormat::rgba16f,
     .has_zstd = false,
     .diffuse_map = DiffuseUnit::irradiance_over_pi,
     .diffuse_sh = DiffuseUnit::none,
     .table = kPlainTable},
    {.name = "bevy",
     .engine = "Bevy",
     .axes = kMirroredZ,
     .sh_axes = kWorld,
     .panorama_turn = 0.0f,
     .curve = RoughnessCurve::linear,
     .size = 256,
     .levels = 6,
     .is_filtered = true,
     .container = ProfileContainer::ktx2,
     .format = TexelFormat::rgb9e5,
     .has_zstd = true,
     .diffuse_map = DiffuseUnit::irradiance_over_pi,
     .diffuse_sh = DiffuseUnit::none,
     .table = std::nullopt},
    {.name = "godot",
     .engine = "Godot",
     .axes = kWorld,
     .sh_axes = kWorld,
     .panorama_turn = -0.25f,
     .curve = RoughnessCurve::square_root,
     .size = 256,
     .levels = 8,
     .is_filtered = false,
     .container = ProfileContainer::exr_panorama,
     .format = TexelFormat::rgba16f,
     .has_zstd = false,
     .diffuse_map = DiffuseUnit::none,
     .diffuse_sh = DiffuseUnit::none,
     .table = std::nullopt},
    {.name = "unreal",
     .engine = "Unreal Engine",
     .axes = kSwappedYz,
     .sh_axes = kSwappedYz,
     .panorama_turn = 0.0f,
     .curve = RoughnessCurve::log2,
     .size = 256,
     .levels = 9,
     .is_filtered = false,
     .container = ProfileContainer::dds,
     .format = TexelFormat::rgba16f,
     .has_zstd = false,
     .diffuse_map = DiffuseUnit::none,
     .diffuse_sh = DiffuseUnit::none,
     .table = std::nullopt},
    {.name = "unity",
     .engine = "Unity",
     .axes = kPictureAxes,
     .sh_axes = kPictureAxes,
     .panorama_turn = -0.25f,
     .curve = RoughnessCurve::unity,
     .size = 256,
     .levels = 9,
     .is_filtered = true,
     .container = ProfileContainer::dds,
     .format = TexelFormat::rgba16f,
     .has_zstd = false,
     .diffuse_map = DiffuseUnit::none,
     .diffuse_sh = DiffuseUnit::none,
     .table = std::nullopt},
};

// Lengths of the curves that do not follow the number of levels.
constexpr float kUnityLevels = 6.0f;
constexpr float kBabylonScale = 0.8f;
constexpr float kUnrealScale = 1.2f;

/// Square of the number of bands; throws for a count that is none.
std::size_t bands_of(std::size_t count) {
  const auto bands = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(count))));
  if (bands < 1 || bands * bands != count)
    throw Error(std::to_string(count) + " coefficients are no whole number of bands");
  return bands;
}

/// The cosine lobe's factor of degree l over π: 1, 2/3, 1/4, 0, -1/24, …
double cosine_over_pi(std::size_t l) {
  if (l == 1) return 2.0 / 3.0;
  if (l % 2 == 1) return 0.0;
  // (-1)^(l/2 - 1) / ((l + 2)(l - 1)) · 2 · l! / (2^l (l/2)!²), the last factor by its recurrence
  double factor = 1.0;
  for (std::size_t k = 1; k <= l / 2; ++k)
    factor *= (2.0 * static_cast<double>(k) - 1.0) / (2.0 * static_cast<double>(k));
  const double sign = l % 4 == 2 ? 1.0 : -1.0;
  return 2.0 * sign * factor / ((static_cast<double>(l) + 2.0) * (static_cast<double>(l) - 1.0));
}

/// Factors of 1, y, z, x, xy, yz, 3z² - 1, zx, x² - y² in the orthonormal basis of three bands.
std::vector<dvec3> polynomial(std::span<const dvec3> c) {
  const double root = std::sqrt(std::numbers::inv_pi);
  const double k0 = 0.5 * root, k1 = 0.5 * std::sqrt(3.0) * root, k2 = 0.5 * std::sqrt(15.0) * root;
  const double k20 = 0.25 * std::sqrt(5.0) * root;
  const double factors[9] = {k0, k1, k1, k1, k2, k2, k20, k2, 0.5 * k2};
  std::vector<dvec3> result;
  result.reserve(9);
  for (std::size_t i = 0; i < 9; ++i) result.push_back(factors[i] * c[i]);
  return result;
}

/// The same as factors of x, y, z, x², y², z², yz, zx, xy: on the sphere 1 is x² + y² + z².
std::vector<dvec3> powers(const std::vector<dvec3>& p) {
  return {p[3], p[1], p[2], p[0] - p[6] + p[8], p[0] - p[6] - p[8], p[0] + 2.0 * p[6], p[5], p[7], p[4]};
}

int wrapped(int column, int width) { return ((column % width) + width) % width; }

}  // namespace

std::span<const Profile> profiles() { return kProfiles; }

const Profile& find_profile(std::string_view name) {
  std::string known;
  for (const Profile& profile : kProfiles) {
    if (profile.name == name) return profile;
    known += (known.empty() ? "" : ", ") + std::string(profile.name);
  }
  throw Error("unknown profile \"" + std::string(name) + "\"; known are " + known);
}

float level_of_roughness(const Profile& profile, float roughness, int levels, int size) {
  const float r = std::clamp(roughness, 0.0f, 1.0f);
  const auto last = static_cast<float>(levels - 1);
  float level = 0.0f;
  switch (profile.curve) {
    case RoughnessCurve::linear:
      level = r * last;
      break;
    case RoughnessCurve::quadratic:
      level = r * (2.0f - r) * last;
      break;
    case RoughnessCurve::unity:
      level = kUnityLevels * r * (1.7f - 0.7f * r);
      break;
    case RoughnessCurve::square_root:
      level = std::sqrt(r) * last;
      break;
    case RoughnessCurve::alpha_log2:
      level = r > 0.0f ? kBabylonScale * std::log2(static_cast<float>(size) * r * r) : 0.0f;
      break;
    case RoughnessCurve::log2:
      level = r > 0.0f ? last - 1.0f + kUnrealScale * std::log2(r) : 0.0f;
      break;
  }
  return std::clamp(level, 0.0f, last);
}

float roughness_of_level(const Profile& profile, int level, int levels, int size) {
  if (level <= 0 || levels < 2) return 0.0f;
  const auto l = static_cast<float>(level);
  const float part = l / static_cast<float>(levels - 1);
  float r = 0.0f;
  switch (profile.curve) {
    case RoughnessCurve::linear:
      r = part;
      break;
    case RoughnessCurve::quadratic:
      r = 1.0f - std::sqrt(std::max(1.0f - part, 0.0f));
      break;
    case RoughnessCurve::unity:
      r = (1.7f - std::sqrt(std::max(1.7f * 1.7f - 2.8f * l / kUnityLevels, 0.0f))) / 1.4f;
      break;
    case RoughnessCurve::square_root:
      r = part * part;
      break;
    case RoughnessCurve::alpha_log2:
      r = std::sqrt(std::exp2(l / kBabylonScale) / static_cast<float>(size));
      break;
    case RoughnessCurve::log2:
      r = std::exp2((l - static_cast<float>(levels - 2)) / kUnrealScale);
      break;
  }
  return std::min(r, 1.0f);
}

CubeFaces orient(const Profile& profile, const CubeFaces& world) { return file_from_world(world, profile.axes); }
Cubemap orient(const Profile& profile, const Cubemap& world) { return file_from_world(world, profile.axes); }

Image orient_panorama(const Profile& profile, const Image& world) {
  const float columns = profile.panorama_turn * static_cast<float>(world.width);
  const int turn = static_cast<int>(std::lround(columns));
  if (static_cast<float>(turn) != columns)
    throw Error("a panorama for " + std::string(profile.engine) + " needs a width that is a multiple of 4");
  Image result = world;
  for (int y = 0; y < world.height; ++y)
    for (int x = 0; x < world.width; ++x) {
      const auto from = world.at(x, y);
      std::copy(from.begin(), from.end(), result.at(wrapped(x + turn, world.width), y).begin());
    }
  return result;
}

TextureOptions texture_options(const Profile& profile) {
  TextureOptions options{.format = profile.format, .zstd = profile.has_zstd};
  switch (profile.container) {
    case ProfileContainer::ktx2:
      options.container = TextureContainer::ktx2;
      break;
    case ProfileContainer::ktx1:
      options.container = TextureContainer::ktx1;
      options.has_filament_type = true;  // Filament alone has this container
      break;
    case ProfileContainer::dds:
      options.container = TextureContainer::dds;
      return options;
    case ProfileContainer::hdr_faces:
    case ProfileContainer::exr_panorama:
      throw Error("light for " + std::string(profile.engine) + " is written as pictures");
  }
  options.key_values["CandelaAxes"] = axes_text(profile.axes);
  options.key_values["CandelaProfile"] = std::string(profile.name);
  return options;
}

std::vector<dvec3> convert_sh(DiffuseUnit unit, std::span<const dvec3> radiance) {
  const std::size_t bands = bands_of(radiance.size());
  std::vector<dvec3> result(radiance.begin(), radiance.end());
  if (unit == DiffuseUnit::radiance) return result;
  for (std::size_t l = 0; l < bands; ++l)
    for (std::size_t i = l * l; i < (l + 1) * (l + 1); ++i) result[i] *= cosine_over_pi(l);
  if (unit == DiffuseUnit::irradiance_over_pi) return result;
  if (unit == DiffuseUnit::none) throw Error("the engine makes its own diffuse light");
  if (bands < 3) throw Error("a polynomial of diffuse light needs three bands of harmonics");
  return unit == DiffuseUnit::polynomial_over_pi ? polynomial(result) : powers(polynomial(result));
}

Image arrange_table(const TableAxes& axes, const Image& table) {
  if (table.channels != 3) throw Error("a table has three channels");
  Image result(axes.roughness_in_rows ? table.width : table.height, axes.roughness_in_rows ? table.height : table.width,
               3);
  for (int y = 0; y < result.height; ++y) {
    for (int x = 0; x < result.width; ++x) {
      const int row = axes.last_row_is_zero ? result.height - 1 - y : y;
      const int nov = axes.roughness_in_rows ? x : row, roughness = axes.roughness_in_rows ? row : x;
      vec3 value = table.rgb(nov, roughness);
      if (axes.channels == TableChannels::mix) value = vec3(value.y, value.x + value.y, value.z);
      result.set_rgb(x, y, value);
    }
  }
  return result;
}

std::string sh_lines(std::span<const dvec3> coefficients) {
  std::string text;
  for (const dvec3& c : coefficients)
    text += fmt::format("{} {} {}\n", static_cast<float>(c.x), static_cast<float>(c.y), static_cast<float>(c.z));
  return text;
}

std::string_view unit_name(DiffuseUnit unit) {
  switch (unit) {
    case DiffuseUnit::none:
      break;
    case DiffuseUnit::radiance:
      return "radiance";
    case DiffuseUnit::irradiance_over_pi:
      return "irradiance / pi";
    case DiffuseUnit::polynomial_over_pi:
      return "irradiance / pi, factors of 1 y z x xy yz 3zz-1 zx xx-yy";
    case DiffuseUnit::powers_over_pi:
      return "irradiance / pi, factors of x y z xx yy zz yz zx xy";
  }
  return "none";
}

}  // namespace candela::ibl
