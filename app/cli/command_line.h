#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): CLI11's own
class App;
class Option;
}  // namespace CLI

namespace candela::cli {

/// Words that an option takes, or some of them.
struct Choices {
  std::vector<std::string> words;
  bool is_list = false;  ///< several may be given, separated by commas
};

/// What --help shows of a verb with many options.
struct ShortHelp {
  std::vector<std::string> names;
  std::string footer;
};

/// What CLI11 does not keep of a verb.
struct CommandNotes {
  ShortHelp short_help;
  std::map<const CLI::Option*, Choices> choices;
};

/// An option of a verb while it is declared. CLI11 behind it is compiled by command_line.cpp alone.
class Option {
 public:
  Option(CLI::Option* option, CommandNotes* notes) : option_(option), notes_(notes) {}

  Option& type(const std::string& text);  ///< what its value is, for --help; empty = its name says it
  Option& group(const std::string& name);
  Option& required();
  Option& values(int count);  ///< so many, one after the other
  Option& repeated();         ///< may be given more than once, with one value each
  Option& needs(const Option& other);
  Option& excludes(const Option& other);
  Option& choices(const std::vector<std::string>& words);          ///< for completion
  Option& choices_of_list(const std::vector<std::string>& words);  ///< likewise

 private:
  CLI::Option* option_;
  CommandNotes* notes_;
};

/// A verb and its options; what they fill must outlive the parsing. A name without dashes is a positional.
class Command {
 public:
  Command(CLI::App* app, CommandNotes* notes) : app_(app), notes_(notes) {}

  Option text(const std::string& name, std::string& into, const std::string& help);
  Option texts(const std::string& name, std::vector<std::string>& into, const std::string& help);
  Option flag(const std::string& name, bool& into, const std::string& help);
  /// A flag that may have a value after an equals sign; `into` is "true" without one.
  Option flag_or_value(const std::string& name, const std::string& type, std::string& into, const std::string& help);
  /// `store` is called with the text, and may throw.
  Option value(const std::string& name, const std::string& type, const std::function<void(const std::string&)>& store,
               const std::string& help);
  /// --help, in a group of its own choice.
  Option help();
  /// What follows the options in --help, and in `--help all` where short_help() gives another.
  void footer(const std::string& text);
  /// The names ("--size") of the options that --help shows, and what follows them; `--help all` shows all options.
  void short_help(const std::vector<std::string>& names, const std::string& text);

  // ----- after parsing
  bool has(const std::string& name) const;
  /// The names of all options that were given.
  std::vector<std::string> given() const;

 private:
  CLI::App* app_;
  CommandNotes* notes_;
};

/// An option as it was declared, or an input, which has no names.
struct OptionInfo {
  std::vector<std::string> names;  ///< "-o", "--output"
  std::string input;               ///< "SCENE"
  std::string type, help, group;
  Choices choices;
  int values = 0;               ///< so many follow it, of a flag none; of an input how many may be given
  bool may_have_value = false;  ///< behind an equals sign
  bool is_repeated = false;
  bool is_required = false;
};

/// A verb with all its options; the program itself is one without inputs.
struct CommandInfo {
  std::string name, what, footer;
  std::vector<OptionInfo> options;
};

/// The program's verbs and what of them the user has named. `help VERB` is the same as `VERB --help`.
class CommandLine {
 public:
  CommandLine(const std::string& name, const std::string& what, const std::string& version);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  Command add_verb(const std::string& name, const std::string& what);
  /// Of the program and of every verb that has none.
  void footer(const std::string& text);
  /// What `help NAME` and `--help NAME` print.
  void add_topic(const std::string& name, const std::function<std::string()>& text);

  struct Asked {
    std::string verb;  ///< empty = none
    std::string text;  ///< what to print in its place, of --help and --version
  };
  /// Throws UsageError, which names the option that was meant where one was mistyped.
  Asked parse(const std::vector<std::string>& arguments);

  /// The program itself, then its verbs.
  std::vector<CommandInfo> commands() const;

 private:
  std::string help_text(const std::string& topic) const;

  std::unique_ptr<CLI::App> app_;
  std::map<std::string, std::function<std::string()>> topics_;
  std::map<const CLI::App*, CommandNotes> notes_;
};

}  // namespace candela::cli
