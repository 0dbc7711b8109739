#pragma once

#include <optional>

#include "base/diagnostics.h"
#include "scene/scene.h"
#include "scene/view.h"

namespace candela {

/// Whether any triangle of the scene lies within the picture and in front of the camera, whatever stands before it and
/// whichever way it faces. Exact, so that a camera inside a room sees its walls.
bool sees_something(const Scene& scene, const View& view);

/// Why a picture of the scene shows nothing, or next to nothing when it is framed as a whole: there is no mesh, or none
/// with triangles, or a few vertices are so far out that everything else is too small to be seen, or things are so far
/// apart that a picture of `picture_size` pixels (of its shorter side, 240 at least) has no pixel for all of them
/// together.
std::optional<Diagnostic> find_emptiness(const Scene& scene, int picture_size = 720);

}  // namespace candela
