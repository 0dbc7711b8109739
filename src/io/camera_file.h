#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "scene/posed_camera.h"

/// Lists of cameras, as other programs read and write them.
///
/// - A scene file (.gltf, .glb, …): its cameras, in the order of their nodes.
/// - The transforms.json of NeRFs: `frames` with `transform_matrix`, world from camera with OpenGL's axes (right, up,
///   backwards); `camera_angle_x`, or `fl_x`, `fl_y`, `cx`, `cy`, `w`, `h`, of all or of a frame.
/// - A JSON array of objects with `K`, 3×3 by rows, and `world_from_camera`, 4×4 by rows, of OpenCV's axes (right,
/// down,
///   forwards) or with "axes": "opengl" of OpenGL's; `size` [w, h]; `name`. With "pixel_center": 0 the middle of the
///   first pixel is at (0, 0), as OpenCV has it, else at (½, ½).
///
/// World axes are the scene's: metres, right-handed, +y up.
namespace candela::io {

/// The cameras of a file, recognised by its content, for pictures of `size` where it names none. Throws Error for a
/// file that is damaged, that has no camera, or one that cannot be: a singular matrix, a distorting lens.
std::vector<PosedCamera> read_cameras(const std::filesystem::path& path, ivec2 size);

/// The same of the text of a .json, for tests and fuzzing; `where` is its name in errors.
std::vector<PosedCamera> parse_cameras(std::string_view text, const std::string& where, ivec2 size);

/// Writes cameras of one size: .gltf as glTF, a .json whose name begins with "transforms" as NeRFs have it, any other
/// .json as an array. PosedCamera::picture becomes the `file_path` of a transforms.json, relative to its folder. Throws
/// Error for what the format cannot say (only glTF knows orthographic cameras, and it knows none whose axis is not in
/// the middle) or another name.
void write_cameras(const std::filesystem::path& path, const std::vector<PosedCamera>& cameras, ivec2 size);

/// Whether it is a name for write_cameras(). Throws Error.
void check_camera_file_name(const std::filesystem::path& path);

}  // namespace candela::io
