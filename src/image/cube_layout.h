#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "image/cubemap.h"

// The geometry of a cube map in files: which axes its addresses follow, and how six faces lie in one picture. Nothing
// here filters: texels are moved, and keep their bits.
namespace candela {

/// Names of the faces in files, in the order of CubeFaces: px nx py ny pz nz.
inline constexpr std::array<std::string_view, 6> kFaceNames{"px", "nx", "py", "ny", "pz", "nz"};

/// Which vector an engine looks up for a direction of the world: each component is one of the world's, perhaps
/// negated. The default is a cube map as it is in memory: looked up by the direction itself.
///
/// The addresses of a face form a left-handed system (KTX 2.0, "faceCount"), so a cube map whose faces are pictures as
/// someone inside sees them has one axis negated: "-x+y+z" here, in a world that is right-handed.
struct CubeAxes {
  std::array<int, 3> axis{0, 1, 2};  ///< a permutation
  std::array<int, 3> sign{1, 1, 1};

  bool operator==(const CubeAxes&) const = default;
  vec3 lookup_from_world(vec3 world) const;
  vec3 world_from_lookup(vec3 lookup) const;
  /// Whether faces are pictures as seen from inside, and not their mirror images.
  bool is_picture() const;
};
inline constexpr CubeAxes kPictureAxes{{0, 1, 2}, {-1, 1, 1}};

/// "-x+y+z": the lookup vector in terms of the world's x, y and z.
std::string axes_text(const CubeAxes& axes);
/// Empty where the text is no such thing.
std::optional<CubeAxes> parse_axes(std::string_view text);

/// A cube of the world to the texels of one that is looked up by `axes`, and back.
CubeFaces file_from_world(const CubeFaces& world, const CubeAxes& axes);
CubeFaces world_from_file(const CubeFaces& file, const CubeAxes& axes);
Cubemap file_from_world(const Cubemap& world, const CubeAxes& axes);
Cubemap world_from_file(const Cubemap& file, const CubeAxes& axes);

/// Six faces in one picture. The crosses have +z in the middle, -x and +x beside it, +y above and -y below; -z is at
/// the right end of the wide cross, and upside down at the bottom of the tall one. Strips are in the order of the
/// faces.
enum class CubeLayout { cross_4x3, cross_3x4, strip_6x1, strip_1x6 };

/// "cross-4x3", "cross-3x4", "strip-6x1" or "strip-1x6".
std::string_view layout_name(CubeLayout layout);
/// Throws Error for an unknown name, listing the known ones.
CubeLayout parse_layout(std::string_view name);
/// What a picture of this size must be; empty for any other shape.
std::optional<CubeLayout> detect_layout(int width, int height);

/// Texels as they lie; alpha is dropped, grey repeats. `image` has the shape of the layout.
CubeFaces faces_from_layout(const Image& image, CubeLayout layout);
/// What a cross leaves open is black.
Image layout_from_faces(const CubeFaces& faces, CubeLayout layout);

/// Solid angle (sr) of texel (x, y) of a face of `size` texels; the 6 · size² of a cube add up to 4π.
double cube_texel_solid_angle(int size, int x, int y);

}  // namespace candela
