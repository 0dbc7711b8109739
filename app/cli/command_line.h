#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): CLI11's own
class App;
class Option;
}  // namespace CLI

namespace candela::cli {

/// An option of a verb while it is declared. CLI11 behind it is compiled by command_line.cpp alone.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  Option& type(const std::string& text);  ///< what its value is, for --help; empty = its name says it
  Option& group(const std::string& name);
  Option& required();
  Option& values(int count);  ///< so many, one after the other
  Option& repeated();         ///< may be given more than once, with one value each
  Option& needs(const Option& other);
  Option& excludes(const Option& other);

 private:
  CLI::Option* option_;
};

/// A verb and its options; what they fill must outlive the parsing. A name without dashes is a positional.
class Command {
 public:
  explicit Command(CLI::App* app) : app_(app) {}

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
  /// What follows the options in --help.
  void footer(const std::string& text);

  // ----- after parsing
  bool has(const std::string& name) const;
  /// The names of all options that were given.
  std::vector<std::string> given() const;

 private:
  CLI::App* app_;
};

/// The program's verbs and what of them the user has named.
class CommandLine {
 public:
  CommandLine(const std::string& name, const std::string& what, const std::string& version);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  Command add_verb(const std::string& name, const std::string& what);
  /// Of the program and of every verb that has none.
  void footer(const std::string& text);

  struct Asked {
    std::string verb;  ///< empty = none
    std::string text;  ///< what to print in its place, of --help and --version
  };
  /// Throws UsageError.
  Asked parse(int argc, char** argv);

 private:
  std::unique_ptr<CLI::App> app_;
};

}  // namespace candela::cli
