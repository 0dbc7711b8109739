#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "candela/shot.h"
#include "cli/command_line.h"

/// What of `candela diff` is about scenes: how their pictures are made that are compared.
namespace candela::cli {

struct SceneRecipe {
  Shot shot;                   ///< of either, but for the file
  std::optional<int> samples;  ///< or frames
  std::optional<std::filesystem::path> camera_file;
  int threads = 0;
};

/// Adds the options for scenes. They fill `recipe`, which must outlive the parsing.
void add_scene_recipe(Command& command, SceneRecipe& recipe);
/// Fills what follows from several of them, and reads the list of cameras. Throws UsageError, Error.
void finish_scene_recipe(const Command& command, SceneRecipe& recipe);
/// Throws UsageError for the first of them that is given.
void refuse_scene_recipe(const Command& command);

/// What is taken of two scenes.
std::pair<Shot, Shot> shots_of(const SceneRecipe& recipe, const std::string& first, const std::string& second);

/// Throws Error where the pictures cannot be held.
void check_memory(const SceneRecipe& recipe);

}  // namespace candela::cli
