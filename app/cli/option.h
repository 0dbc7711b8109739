#pragma once

#include <filesystem>
#include <iterator>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "cli/command_line.h"
#include "cli/values.h"
#include "content/demo.h"
#include "content/make_environment.h"
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

/// The first of each pair, or the names of a table's rows.
template <class T, std::size_t n>
std::vector<std::string> names_of(const Words<T, n>& words) {
  std::vector<std::string> names;
  names.reserve(n);
  for (const auto& [word, value] : words) names.emplace_back(word);
  return names;
}
template <class Rows>
std::vector<std::string> names_of_rows(const Rows& rows) {
  std::vector<std::string> names;
  names.reserve(std::size(rows));
  for (const auto& row : rows) names.emplace_back(row.name);
  return names;
}

/// What a scene or an environment may be besides a file.
inline std::vector<std::string> demo_words() {
  std::vector<std::string> words;
  for (const content::DemoInfo& demo : content::demos()) words.push_back("demo:" + demo.name);
  return words;
}
inline std::vector<std::string> environment_words() {
  const std::span<const std::string> names = built_in_environments();
  return {names.begin(), names.end()};
}

/// An option that takes one of some words.
template <class T, class V, std::size_t n>
Option add_choice(Command& command, const std::string& name, const std::string& type, T& into, const Words<V, n>& words,
                  const std::string& help) {
  const auto parse = [words](const std::string& text) { return one_of(text, words); };
  return add_value(command, name, type, into, parse, help).choices(names_of(words));
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
