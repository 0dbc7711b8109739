#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "image/cube_layout.h"
#include "image/image.h"
#include "image/texture_file.h"

// What each engine expects of baked light, as a table. docs/ibl-profiles.md says where each choice comes from.
namespace candela::ibl {

/// The mip level that an engine looks at for a roughness r, of levels 0 to n - 1.
enum class RoughnessCurve {
  linear,       ///< r (n - 1)
  quadratic,    ///< r (2 - r) (n - 1)
  unity,        ///< 6 r (1.7 - 0.7 r), whatever n is
  square_root,  ///< √r (n - 1)
  alpha_log2,   ///< 0.8 log2(size r²), whatever n is; level 0 is not filtered
  log2          ///< n - 2 + 1.2 log2 r: the level of 2 × 2 texels is fully rough; level 0 is not filtered
};

/// What a coefficient or a texel of diffuse light is.
enum class DiffuseUnit {
  none,                ///< the engine makes its own
  radiance,            ///< projected radiance; the engine convolves it with the cosine
  irradiance_over_pi,  ///< what a white Lambertian surface sends back
  polynomial_over_pi,  ///< the same, as factors of 1, y, z, x, xy, yz, 3z² - 1, zx, x² - y²
  powers_over_pi       ///< the same, as factors of x, y, z, x², y², z², yz, zx, xy
};

/// What a texture of the split sum's table holds, as r and g.
enum class TableChannels {
  scale_and_bias,  ///< F0 r + g
  mix              ///< mix(r, g, F0): g is the sum of both above
};

/// How a table is laid out; `column` and `row` count texels, row 0 first in the file.
struct TableAxes {
  bool roughness_in_rows = true;  ///< else roughness runs along columns and NoV along rows
  bool last_row_is_zero = false;  ///< rows run downwards: the first is 1
  TableChannels channels = TableChannels::scale_and_bias;
};

enum class ProfileContainer { ktx2, ktx1, dds, hdr_faces, exr_panorama };

struct Profile {
  std::string_view name;
  std::string_view engine;
  CubeAxes axes;        ///< by which the specular (and diffuse) cube is looked up
  CubeAxes sh_axes;     ///< by which the harmonics are evaluated
  float panorama_turn;  ///< of a turn, added to the u of an Environment
  RoughnessCurve curve;
  int size;          ///< of level 0, unless asked otherwise
  int levels;        ///< unless asked otherwise
  bool is_filtered;  ///< the engine takes our levels; else it filters level 0 itself
  ProfileContainer container;
  TexelFormat format;
  bool has_zstd;
  DiffuseUnit diffuse_map;         ///< of a cube of diffuse light
  DiffuseUnit diffuse_sh;          ///< of harmonics
  std::optional<TableAxes> table;  ///< empty: the engine has its own and takes none
};

std::span<const Profile> profiles();
/// Throws Error for an unknown name, listing the known ones.
const Profile& find_profile(std::string_view name);

/// Mip level (not rounded, 0 to levels - 1) that the engine reads for `roughness`, and the roughness that it means by a
/// level: 0 for level 0, and 1 for every level at or beyond that of roughness 1. `size` is that of level 0 in texels.
float level_of_roughness(const Profile& profile, float roughness, int levels, int size);
float roughness_of_level(const Profile& profile, int level, int levels, int size);

/// A cube of the world as the engine looks it up.
CubeFaces orient(const Profile& profile, const CubeFaces& world);
Cubemap orient(const Profile& profile, const Cubemap& world);
/// A panorama of the world as the engine looks it up: columns are moved, so that nothing is filtered. Throws Error
/// where the turn is no whole number of columns.
Image orient_panorama(const Profile& profile, const Image& world);

/// How a cube is written for the engine. Throws Error for profiles of pictures (hdr_faces, exr_panorama).
TextureOptions texture_options(const Profile& profile);

/// Harmonics of radiance (orthonormal, real, without the Condon-Shortley sign, (l, m) at l (l + 1) + m) in another
/// unit. The cosine's factors: Ramamoorthi & Hanrahan 2001, "An Efficient Representation for Irradiance Environment
/// Maps", eq. 8. Polynomials have the nine coefficients of three bands. Throws Error for fewer, or for no square.
std::vector<dvec3> convert_sh(DiffuseUnit unit, std::span<const dvec3> radiance);

/// A table in the engine's layout from one with F0 r + g, NoV along columns and roughness along rows from 0 on, all
/// sampled in the middle of texels. A third channel is kept.
Image arrange_table(const TableAxes& axes, const Image& table);

/// "r g b" per line: the value of the key "sh" in a Filament KTX file.
std::string sh_lines(std::span<const dvec3> coefficients);

/// "radiance", "irradiance / pi" …
std::string_view unit_name(DiffuseUnit unit);

}  // namespace candela::ibl
