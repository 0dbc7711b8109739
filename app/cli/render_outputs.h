#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "cli/inputs.h"
#include "cli/render_options.h"

/// Where the pictures of `candela render` go, and where not.
namespace candela::cli {

/// The files of each picture of a shot, in the order of `labels`. A number in a name counts the pictures that have the
/// rest of it in common.
using PictureNames = std::vector<std::vector<std::filesystem::path>>;
PictureNames name_pictures(const RenderOptions& options, const std::vector<PictureLabel>& labels);

/// `name` with each {view} and the like so that it is one in the name of a picture: {{view}.
std::string without_placeholders(const std::string& name);

/// What is known of the labels before the file is open: all of them, or of its variants and animations none.
std::vector<PictureLabel> labels_before_loading(const Shot& shot);

/// Whether several pictures of a shot have the same name, but for its number.
bool shares_names(const RenderOptions& options, const std::string& output);

/// Refuses names that have no place for what distinguishes the pictures of a shot (UsageError).
void check_patterns(const RenderOptions& options);

/// What is known to be read before a scene is opened.
Inputs inputs_of_options(const RenderOptions& options);
/// All that the scenes name, too; of one that cannot be read its own name. `root` is LoadOptions::root.
void add_scene_files(const std::vector<std::string>& scenes, const std::filesystem::path& root, Inputs& inputs);

/// Finds out about an unwritable path before hours of work. Throws Error.
void check_paths(const RenderOptions& options);
/// Nothing that is read is written, and nothing is written twice. Throws Error.
void check_overwriting(const RenderOptions& options, const PictureNames& names, const Inputs& inputs);
/// What is there after a command: those of its pictures that were asked for, and what tells of them.
std::vector<std::filesystem::path> written_files(const RenderOptions& options, const PictureNames& names);

/// Where nobody gave a name: the first that is no input.
void choose_default_name(RenderOptions& options, const std::vector<PictureLabel>& labels, const Inputs& inputs);

/// The pictures of several scenes in one folder, by their stems: NAME.png. What comes later of that name, or would
/// overwrite an input, has NAME-2.png, NAME-3.png, …: the first that no other scene has, ignoring case. What the folder
/// holds already does not count, so that the same command gives the same names again.
std::vector<std::filesystem::path> batch_outputs(const std::vector<std::string>& stems,
                                                 const std::filesystem::path& folder, const Inputs& inputs);

/// The pattern of one scene's pictures from the name that batch_outputs() gives it.
std::string batch_pattern(const RenderOptions& options, const std::filesystem::path& output);

/// A name in that folder that no input has: of one scene, as above.
std::filesystem::path free_name(const std::filesystem::path& folder, const std::string& stem, const Inputs& inputs);

}  // namespace candela::cli
