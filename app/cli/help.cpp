#include "cli/help.h"

#include <fmt/format.h>

#include <filesystem>
#include <vector>

#include "base/text.h"
#include "cli/verbs.h"
#include "content/demo.h"
#include "io/foreign_scene.h"

namespace candela::cli {

namespace {

bool is_scene_name(const std::string& word) {
  const std::string extension = lower_extension(word);
  return word.starts_with("demo:") || extension == ".glb" || extension == ".gltf" || extension == ".zip" ||
         io::has_foreign_extension(word);
}

}  // namespace

std::string demos_text() {
  std::string text = "Built-in scenes:\n";
  for (const content::DemoInfo& demo : content::demos()) {
    text += fmt::format("  {:<32} {}\n", "demo:" + demo.name, demo.description);
  }
  return text +
         "\nThe rows are framed for pictures six times as wide as high:\n"
         "  candela render demo:row-ior -o ior.png --size 1200x200\n";
}

std::string unknown_verb_text(const std::string& word) {
  const std::string start = "'" + word + "' is no verb";
  if (is_scene_name(word)) return start + ": did you mean candela render " + word + "?";
  std::error_code ignored;
  if (std::filesystem::exists(word, ignored)) return start + ": did you mean candela info " + word + "?";
  std::vector<std::string> names{"help"};
  std::string known;
  for (const VerbInfo& verb : kVerbs) {
    names.emplace_back(verb.name);
    known += (known.empty() ? "" : ", ") + std::string(verb.name);
  }
  const std::string meant = did_you_mean(word, names);
  return start + (meant.empty() ? "; there are " + known + " and help" : meant);
}

}  // namespace candela::cli
