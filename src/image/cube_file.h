#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "image/cube_layout.h"
#include "image/cubemap.h"
#include "image/texel.h"

// Cube maps and panoramas as files.
namespace candela {

/// Key of a KTX file that says by which axes it is looked up, as axes_text() writes it.
inline constexpr const char* kAxesKey = "CandelaAxes";

/// How a file holds a cube map.
enum class CubeSource { none, texture, layout, six_files };

/// What `path` is: a KTX or DDS file of six faces; a picture with the shape of a cross or a strip; a folder of six
/// pictures, or a pattern with "%s" for their names. Looks at headers only where the format has them. Never throws:
/// what is absent or damaged is no cube map.
CubeSource find_cube_source(const std::filesystem::path& path);
inline bool is_cubemap_file(const std::filesystem::path& path) { return find_cube_source(path) != CubeSource::none; }

/// Reads a cube map in the axes of the world. `axes` is how the file is looked up; where it is not given, KTX files may
/// say it (kAxesKey), other KTX and DDS files are taken to be looked up by the direction itself, and pictures as seen
/// from inside (kPictureAxes). The six pictures are called px nx py ny pz nz, posx negx …, or right left top bottom
/// front back, alone or at the end of a name. Throws Error.
Cubemap read_cubemap(const std::filesystem::path& path, std::optional<CubeAxes> axes = {});

/// The files that an environment is read from: the six of a folder or a pattern, else `path` itself. Never throws.
std::vector<std::filesystem::path> files_of_environment(const std::filesystem::path& path);

/// Light from everywhere, as a file has it, in the axes of the world: either of the first two is empty.
struct EnvironmentFile {
  Cubemap cube;
  Image panorama;                    ///< any shape that is no cube layout
  std::vector<Diagnostic> warnings;  ///< what of the file could not be followed
};
/// `path` may be FILE:LAYER of an OpenEXR file. Files with OpenEXR's `envmap` are read by its convention, cubes only
/// where no `axes` are given. Throws Error.
EnvironmentFile read_environment_file(const std::filesystem::path& path, std::optional<CubeAxes> axes = {});
/// The same as light to render by: every texel is finite and not negative, what was put right is told, and of a cube
/// there is the largest level alone.
EnvironmentFile read_clean_environment(const std::filesystem::path& path, std::optional<CubeAxes> axes = {});

/// Writes .exr (32-bit float) or .hdr by the extension. Throws Error for others.
void write_linear_image(const std::filesystem::path& path, const Image& image);

/// Writes each face of each level beside `path`, texels as they are: "sky.exr" becomes "sky_px.exr" …, and with more
/// than one level "sky_m0_px.exr" …. Returns the paths.
std::vector<std::filesystem::path> write_cube_faces(const std::filesystem::path& path, const Cubemap& cube);

/// How colours are kept in 8 bits with a shared multiplier in alpha: colour = rgb · a · range, or the square of that.
struct Rgbm {
  float range = 16.0f;
  bool is_squared = false;  ///< finer steps in the dark: 16 and squared is what Filament decodes
};
/// 8-bit RGBA PNG; colours above the range are clamped and counted. Throws Error unless the range is above 0.
EncodingLoss write_rgbm_png(const std::filesystem::path& path, const Image& image, const Rgbm& rgbm);

}  // namespace candela
