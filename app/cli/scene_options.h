#pragma once

#include "cli/command_line.h"
#include "cli/inputs.h"
#include "cli/render_options.h"

/// What verbs have in common that show one scene by both engines.
namespace candela::cli {

/// SCENE.
void add_scene_argument(Command& command, RenderOptions& options);
/// Which look and which moment of it.
void add_scene_options(Command& command, RenderOptions& options);
/// What follows from these, from add_camera_options, add_light_options and add_drawing_options. Throws as the finish_
/// functions of these.
void finish_scene_options(const Command& command, RenderOptions& options);

/// All that is read for a picture of it, which no output may overwrite.
Inputs scene_inputs(const RenderOptions& options);

}  // namespace candela::cli
