#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace candela::foreign {

/// What a scene file is, by its first bytes and never by its name.
enum class Format { unknown, gltf, obj, fbx, stl, ply, collada, max_3ds, three_mf };

/// `bytes` is the whole file. A binary STL is known by its length alone, an OBJ by its first lines being statements of
/// one. Whatever starts as JSON or as a GLB is a glTF, whole or not.
Format recognise(std::span<const std::byte> bytes);

/// "OBJ", "COLLADA"…
std::string_view format_name(Format format);

/// What an unknown file seems to be, for a message: "a PNG image", "a Blender file"…; empty where that is unknown too.
std::string_view guess_kind(std::span<const std::byte> bytes);

/// The formats that this build reads, for a message: "glTF, OBJ, FBX…".
std::string known_formats();

/// Whether the formats beside glTF are built in.
bool is_available();

}  // namespace candela::foreign
