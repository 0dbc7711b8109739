#pragma once

#include <assimp/scene.h>

#include <cstddef>
#include <span>

#include "foreign/formats.h"
#include "foreign/measures.h"
#include "math/types.h"

namespace candela::foreign {

mat4 matrix_of(const aiMatrix4x4& m);

/// What a file's coordinates mean, as far as Assimp has not seen to it.
struct Units {
  mat4 metres_from_root{1.0f};  ///< to metres and +y up, right-handed
  bool replaces_root = false;   ///< it stands in place of what Assimp's root says
  float metres_per_unit = 1.0f;
  float angle_per_fov = 1.0f;  ///< a camera's whole angle from what Assimp calls its field of view
};

/// FBX says unit and axes, which Assimp 5.2 hands on; 5.4 also turns the axes itself
/// and halves the angles of cameras. COLLADA's are in Assimp's root already. A 3MF is z-up and says its
/// unit, a millimetre where it does not, which Assimp does not hand on. 3DS is z-up, which Assimp turns. The others are
/// taken as `measures` says.
Units units_of(const aiScene& scene, Format format, std::span<const std::byte> bytes, const Measures& measures);

}  // namespace candela::foreign
