#pragma once

#include <filesystem>
#include <string>

#include "base/error.h"
#include "cli/command_line.h"
#include "cli/values.h"
#include "foreign/measures.h"

namespace candela::cli {

/// An option with one value. `parse` turns its text into `into`; what it throws names the option.
template <class T, class Parse>
Option add_value(Command& command, const std::string& name, const std::string& type, T& into, Parse parse,
                 const std::string& help) {
  const auto store = [name, &into, parse](const std::string& text) {
    try {
      into = parse(text);
    } catch (const UsageError& error) {
      throw UsageError(name + ": " + error.what());
    } catch (const Error& error) {
      throw UsageError(name + ": " + error.what());
    }
  };
  return command.value(name, type, store, help);
}

inline auto number_within(float low, float high) {
  return [low, high](const std::string& text) { return parse_number(text, low, high); };
}

inline auto count_within(int low, int high) {
  return [low, high](const std::string& text) { return parse_count(text, low, high); };
}

/// What a scene may be, for --help; `candela check` takes folders too.
inline const std::string kSceneFiles = ".glb, .gltf, .obj, .fbx, .stl, .ply, .dae, .3ds, .3mf, a .zip with one of them";

/// --root, of every verb that reads a scene.
template <class Path>
Option add_root(Command& command, Path& into) {
  const auto folder = [](const std::string& text) {
    if (text.empty() || !std::filesystem::is_directory(text)) throw UsageError("is no folder: '" + text + "'");
    return text;
  };
  return add_value(command, "--root", "DIR", into, folder,
                   "Refuse a scene that lies or reads outside of DIR, links resolved [it reads what it names]");
}

/// --texture-memory, of every verb that draws.
inline Option add_texture_memory(Command& command, std::uint64_t& into) {
  return add_value(command, "--texture-memory", "SIZE", into, parse_bytes,
                   "Halve the largest images until all fit into 512MB, 2GB… [as they are]");
}

/// --scene, of every verb that reads a scene.
inline Option add_scene_choice(Command& command, std::string& into) {
  const auto named = [](const std::string& text) {
    if (text.empty()) throw UsageError("the name is empty");
    return text;
  };
  return add_value(command, "--scene", "INDEX|NAME", into, named,
                   "Which of the scenes that a file holds, as candela info lists them [its default one]");
}

/// --unit and --up, of every verb that reads a scene.
inline void add_measures(Command& command, foreign::Measures& into, const std::string& group = "Options") {
  const auto metres = [](const std::string& text) {
    if (text == "mm") return 0.001f;
    if (text == "cm") return 0.01f;
    if (text == "m") return 1.0f;
    if (text == "in") return 0.0254f;
    throw UsageError("is none of mm, cm, m and in: '" + text + "'");
  };
  const auto is_z_up = [](const std::string& text) {
    if (text != "y" && text != "z") throw UsageError("is neither y nor z: '" + text + "'");
    return text == "z";
  };
  add_value(command, "--unit", "mm|cm|m|in", into.metres_per_unit, metres,
            "Of an .obj, .stl or .ply, which says none [m]")
      .group(group);
  add_value(command, "--up", "y|z", into.is_z_up, is_z_up, "The upward axis of an .obj, .stl or .ply, likewise [y]")
      .group(group);
}

}  // namespace candela::cli
