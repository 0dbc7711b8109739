#pragma once

#include <filesystem>

#include "cli/render_options.h"

/// A window that shows a scene while one works on it.
namespace candela::viewer {

struct ViewOptions {
  cli::RenderOptions render;     ///< the shot: scene, camera, light, how it is drawn and exposed
  bool is_watching = false;      ///< reads files again when they change
  bool is_split = false;         ///< shows the path traced picture beside the drawn one
  int samples = 1024;            ///< of that
  int frames = 0;                ///< draws so many, says how long they took and closes; 0: until it is closed
  std::filesystem::path script;  ///< input to play; empty = none
};

/// Shows it, until it is closed. Throws Error where this build has no windows, where there is no display, and for a
/// script that cannot be played.
void show(const ViewOptions& options);

}  // namespace candela::viewer
