#include "cli/completion_words.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <iterator>
#include <set>
#include <string_view>

#include "cli/values.h"

namespace candela::cli {

namespace {

struct Candidates {
  struct Word {
    std::string text, what;
  };
  std::vector<Word> words;
  bool files = false, folders = false, is_open = false;
};

constexpr std::array<std::string_view, 8> kFiles = {"FILE", "SCENE", "PART",   "ENV",
                                                    "JOB",  "FIRST", "SECOND", "OLD NEW"};

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(at, begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

/// "FILE.{png,jpg}|DIR" as FILE.{png,jpg} and DIR; "[=regression|none]" as regression and none.
std::vector<std::string> alternatives(const std::string& type) {
  return split(type.starts_with("[=") ? type.substr(2, type.size() - 3) : type, '|');
}

/// What of a word is meant literally: "sky:" of sky:DEG, nothing of NAME or 8%.
std::string literal_start(const std::string& word) {
  if (word.empty() || (std::islower(static_cast<unsigned char>(word[0])) == 0 && word != "-")) return {};
  const auto is_literal = [](char c) {
    return std::islower(static_cast<unsigned char>(c)) != 0 || std::isdigit(static_cast<unsigned char>(c)) != 0 ||
           std::string_view("-:=/.").find(c) != std::string_view::npos;
  };
  return {word.begin(), std::find_if_not(word.begin(), word.end(), is_literal)};
}

/// Whether a placeholder stands for files, as FILE and FILE.json do.
bool means_file(const std::string& word) {
  return std::any_of(kFiles.begin(), kFiles.end(), [&](std::string_view name) {
    return word.starts_with(name) && (word.size() == name.size() || word[name.size()] == '.');
  });
}

bool means_folder(const std::string& word) { return word == "DIR" || word == "DIR/"; }

void add_word(Candidates& to, const std::string& text, const std::string& typed, const std::string& what = {}) {
  const auto is_it = [&](const Candidates::Word& word) { return word.text == text; };
  if (!text.starts_with(typed) || std::any_of(to.words.begin(), to.words.end(), is_it)) return;
  to.words.push_back({text, what});
}

/// What may stand for `typed` as a value of the option, each after `before`, which is typed too.
void add_values(Candidates& to, const OptionInfo& option, const std::string& typed, const std::string& before) {
  const std::vector<std::string> types = alternatives(option.names.empty() ? option.input : option.type);
  // Of a list the words before the last comma are there already.
  const std::size_t comma = option.choices.is_list ? typed.rfind(',') : std::string::npos;
  const std::string first = comma == std::string::npos ? "" : typed.substr(0, comma + 1);
  const std::vector<std::string> given = split(first, ',');
  const auto add = [&](const std::string& word, bool is_in_list) {
    const std::string text = literal_start(word);
    if (text.empty() || std::find(given.begin(), given.end(), text) != given.end()) return;
    add_word(to, before + (is_in_list ? first : "") + text, before + typed);
  };
  if (types.size() > 1 || option.may_have_value) {
    for (const std::string& word : types) add(word, false);
  }
  for (const std::string& word : option.choices.words) add(word, true);
  to.is_open = option.choices.is_list;
  const bool has_folder = std::any_of(types.begin(), types.end(), means_folder);
  // The folder that is an input may be meant by a file in it.
  to.files = std::any_of(types.begin(), types.end(), means_file) || (has_folder && option.names.empty());
  to.folders = !to.files && has_folder;
}

const OptionInfo* find_option(const CommandInfo& command, const std::string& name) {
  for (const OptionInfo& option : command.options) {
    if (std::find(option.names.begin(), option.names.end(), name) != option.names.end()) return &option;
  }
  return nullptr;
}

/// What the words of a verb before the last one mean.
struct Read {
  std::set<const OptionInfo*> given;
  const OptionInfo* waiting = nullptr;  ///< for the last word
  int inputs = 0;
  bool only_inputs = false;  ///< after --
};

Read read_words(const CommandInfo& command, const std::vector<std::string>& words) {
  Read read;
  int wanted = 0;
  for (auto word = words.begin(); word != std::prev(words.end()); ++word) {
    if (wanted > 0) {
      --wanted;
    } else if (read.only_inputs || !word->starts_with('-') || *word == "-") {
      ++read.inputs;
    } else if (*word == "--") {
      read.only_inputs = true;
    } else {
      read.waiting = find_option(command, word->substr(0, word->find('=')));
      const bool has_value = word->find('=') != std::string::npos;
      if (read.waiting != nullptr) read.given.insert(read.waiting);
      wanted = read.waiting == nullptr || has_value ? 0 : read.waiting->values;
    }
  }
  if (wanted == 0) read.waiting = nullptr;
  return read;
}

void add_options(Candidates& to, const CommandInfo& command, const std::string& typed,
                 const std::set<const OptionInfo*>& given) {
  for (const OptionInfo& option : command.options) {
    if (given.contains(&option) && !option.is_repeated) continue;
    // The long name, unless the short one is typed already.
    for (const std::string& name : option.names) {
      const bool is_shown = name.size() > 2 || name == typed || option.names.size() == 1;
      if (is_shown) add_word(to, name, typed, option.help);
    }
  }
}

void add_input(Candidates& to, const CommandInfo& command, int place, const std::string& typed) {
  for (const OptionInfo& option : command.options) {
    if (!option.names.empty()) continue;
    if (place < option.values) return add_values(to, option, typed, "");
    place -= option.values;
  }
}

void add_of_verb(Candidates& to, const CommandInfo& command, const std::vector<std::string>& words) {
  const std::string& typed = words.back();
  const Read read = read_words(command, words);
  if (read.waiting != nullptr) return add_values(to, *read.waiting, typed, "");
  if (read.only_inputs || !typed.starts_with('-') || typed == "-") {
    add_input(to, command, read.inputs, typed);
    const bool asks_help = words.size() > 1 && (words.end()[-2] == "--help" || words.end()[-2] == "-h");
    if (asks_help) add_word(to, "all", typed, "Every option");
    const bool has_more = !to.words.empty() || to.files || to.folders;
    if (!read.only_inputs && !has_more && typed.empty()) add_options(to, command, typed, read.given);
    return;
  }
  const std::size_t equals = typed.find('=');
  if (equals == std::string::npos) return add_options(to, command, typed, read.given);
  const OptionInfo* option = find_option(command, typed.substr(0, equals));
  if (option != nullptr) add_values(to, *option, typed.substr(equals + 1), typed.substr(0, equals + 1));
}

void add_verbs(Candidates& to, const std::vector<CommandInfo>& commands, const std::string& typed) {
  for (std::size_t i = 1; i < commands.size(); ++i) add_word(to, commands[i].name, typed, commands[i].what);
}

Candidates candidates_of(const std::vector<CommandInfo>& commands, const std::vector<std::string>& words) {
  Candidates to;
  const std::string& typed = words.back();
  if (words.size() == 1) {
    if (typed.starts_with('-')) {
      add_options(to, commands[0], typed, {});
    } else {
      add_verbs(to, commands, typed);
      add_word(to, "help", typed, "Help on a verb, or all the demos there are");
    }
    return to;
  }
  const bool is_help = words[0] == "help" || words[0] == "--help" || words[0] == "-h";
  if (is_help && words.size() == 2) {
    add_verbs(to, commands, typed);
    add_word(to, "demos", typed, "The built-in scenes");
    add_word(to, "all", typed, "Every option");
    return to;
  }
  const auto named = [&](const std::string& name) {
    return std::find_if(commands.begin() + 1, commands.end(), [&](const CommandInfo& c) { return c.name == name; });
  };
  auto command = named(words[0]);
  if (is_help || command == commands.end()) return to;
  std::vector<std::string> rest(words.begin() + 1, words.end());
  const auto dashes = std::find(rest.begin(), rest.end() - 1, "--");
  if (command->name == "plan" && dashes != rest.end() - 1) {  // a command of render follows
    command = named("render");
    rest.erase(rest.begin(), dashes + 1);
  }
  add_of_verb(to, *command, rest);
  return to;
}

}  // namespace

std::string completion_text(const std::vector<CommandInfo>& commands, const std::vector<std::string>& words) {
  const Candidates candidates = candidates_of(commands, words.empty() ? std::vector<std::string>{""} : words);
  std::string text = candidates.is_open ? "open " : "";
  text += candidates.files ? "files\n" : candidates.folders ? "folders\n" : "words\n";
  for (const auto& [word, what] : candidates.words) text += word + "\t" + one_line(what) + "\n";
  return text;
}

}  // namespace candela::cli
