#pragma once

#include <array>
#include <functional>
#include <string>
#include <string_view>

#include "cli/command_line.h"

namespace candela::cli {

/// Each verb adds its options to its command and returns what to do when the user names it.
using Verb = std::function<void()>;
Verb add_render(Command& command);
Verb add_merge(Command& command);
Verb add_plan(Command& command);
Verb add_worker(Command& command);
Verb add_preview(Command& command);
Verb add_info(Command& command);
Verb add_furnace(Command& command);
Verb add_bake(Command& command);
Verb add_check(Command& command);
Verb add_diff(Command& command);
Verb add_compare(Command& command);
Verb add_explain(Command& command);
Verb add_view(Command& command);
Verb add_figures(Command& command);
Verb add_completion(Command& command);

struct VerbInfo {
  std::string_view name;
  std::string_view what;  ///< one line of --help
  Verb (*add)(Command& command);
};
/// What `candela` can do: a verb is a row here, and a file.
inline constexpr auto kVerbs = std::to_array<VerbInfo>({
    {"render", "Render a glTF scene to a picture", add_render},
    {"merge", "Make one picture of parts that several machines rendered", add_merge},
    {"plan", "Divide a large work into lines that machines run on their own", add_plan},
    {"worker", "Run the lines of a plan beside other workers", add_worker},
    {"preview", "Show a model at one glance: four views, size, materials, findings", add_preview},
    {"info", "Say what a scene, an image or a texture file holds", add_info},
    {"furnace", "Measure what the materials do with light", add_furnace},
    {"bake", "Image-based light for engines, with its error measured", add_bake},
    {"check", "Judge materials, textures and meshes as a physicist would", add_check},
    {"diff", "Measure how far one picture or model is from another", add_diff},
    {"compare", "Measure how far the real-time frame is from the truth, and why", add_compare},
    {"explain", "Say every term of a pixel: surface, lobes, lights, frame, paths", add_explain},
    {"view", "Show a scene in a window, drawn in real time", add_view},
    {"figures", "Make the figures of physically based shading, as pages to read", add_figures},
    {"completion", "Scripts for shells that complete what is typed, and the manual", add_completion},
});

/// Writes `text` to standard output; throws Error where that fails (a full disk behind a redirection).
void print(const std::string& text);

}  // namespace candela::cli
