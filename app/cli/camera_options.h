#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/command_line.h"
#include "cli/render_options.h"

/// The options that say from where pictures are taken, above all those of `candela render`.
namespace candela::cli {

std::vector<std::string> parse_views(const std::string& text);  ///< some of kNamedViews, each once
/// "sphere:24" or "hemisphere:24,7"; empty for anything else, which is a file.
std::optional<CameraSphere> parse_camera_sphere(const std::string& text);
float parse_margin(const std::string& text);  ///< "0.08" or "8%"
std::string names_of_views();                 ///< "front, back, …"

/// Where the pictures through cameras go.
enum class CameraPictures {
  files,   ///< of `candela render`: named by the set, and the cameras can be written
  report,  ///< into one
  window,  ///< one at a time, onto the screen
};
void add_camera_options(Command& command, RenderOptions& options, CameraPictures pictures = CameraPictures::files);

/// Reads the list of cameras, and with it the size of the pictures where that is not given. Throws Error for the list,
/// UsageError for what does not go together.
void finish_camera_options(const Command& command, RenderOptions& options);
/// Reads a list of cameras for a shot; `keeps_size` where the size of its pictures is given. Throws Error.
void read_cameras_of_shot(const std::filesystem::path& file, bool keeps_size, Shot& shot);

}  // namespace candela::cli
