#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "cli/inputs.h"
#include "cli/render_options.h"

/// Where the pictures of `candela render` go, and where not.
namespace candela::cli {

/// The files of picture `index`.
std::vector<std::filesystem::path> outputs_of(const RenderOptions& options, std::size_t index);

/// What is known to be read before a scene is opened.
Inputs inputs_of_options(const RenderOptions& options);
/// All that the scenes name, too; of one that cannot be read its own name. `root` is LoadOptions::root.
void add_scene_files(const std::vector<std::string>& scenes, const std::filesystem::path& root, Inputs& inputs);

/// Finds out about an unwritable path before hours of work. Throws Error.
void check_paths(const RenderOptions& options);
/// Nothing that is read is written, and nothing is written twice. Throws Error.
void check_overwriting(const RenderOptions& options, const Inputs& inputs);

/// Where nobody gave a name: the first that is no input.
void choose_default_name(RenderOptions& options, const Inputs& inputs);

/// The pictures of several scenes in one folder, by their stems: NAME.png. What comes later of that name, or would
/// overwrite an input, has NAME-2.png, NAME-3.png, …: the first that no other scene has, ignoring case. What the folder
/// holds already does not count, so that the same command gives the same names again.
std::vector<std::filesystem::path> batch_outputs(const std::vector<std::string>& stems,
                                                 const std::filesystem::path& folder, const Inputs& inputs);

/// A name in that folder that no input has: of one scene, as above.
std::filesystem::path free_name(const std::filesystem::path& folder, const std::string& stem, const Inputs& inputs);

}  // namespace candela::cli
