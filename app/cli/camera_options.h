#pragma once

#include "cli/command_line.h"
#include "cli/render_options.h"

/// The options of `candela render` that say from where its pictures are taken.
namespace candela::cli {

void add_camera_options(Command& command, RenderOptions& options);

/// Reads the list of cameras, and with it the size of the pictures where that is not given. Throws Error for the list,
/// UsageError for what does not go together.
void finish_camera_options(const Command& command, RenderOptions& options);

}  // namespace candela::cli
