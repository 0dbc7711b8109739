#pragma once

#include <string_view>

#include "scene/scene.h"

namespace candela::content {

/// Clear sky with the sun `elevation_deg` above the horizon, in [-5, 90]; see make_environment.
Environment make_sky(float elevation_deg);

/// Softboxes in a light grey room, or of another kind: "dark", "three-point"; see make_environment.
Environment make_studio(std::string_view kind = {});

}  // namespace candela::content
