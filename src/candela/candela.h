#pragma once

#include <filesystem>
#include <string>

#include "base/diagnostics.h"
#include "base/error.h"
#include "image/develop.h"
#include "image/film.h"
#include "path/render.h"
#include "scene/environment.h"
#include "scene/scene.h"
#include "scene/view.h"

/// The library in three calls:
///
///     candela::Scene scene = candela::load("helmet.glb");
///     candela::Film film = candela::render(scene, {.width = 1280, .height = 720, .samples = 64});
///     candela::write_film("helmet.png", film, {});
namespace candela {

/// Loads a .gltf/.glb, or a built-in scene by "demo:NAME". Throws Error. Warnings go to `diagnostics` when given.
Scene load(const std::string& path_or_demo, Diagnostics* diagnostics = nullptr);

/// The view a user would expect without saying more: the file's first camera, else the whole subject in three-quarter view.
View default_view(const Scene& scene, float aspect);

/// Renders with the scene's own wish for light (else "studio") and default_view.
Film render(const Scene& scene, const path::Settings& settings = {});
using path::render;

/// "0.1.0"
const char* version();

}  // namespace candela
