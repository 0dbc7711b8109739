#include "cli/command_line.h"

#include <CLI/CLI.hpp>
#include <utility>

#include "cli/values.h"

namespace candela::cli {

namespace {

/// Options as NAME VALUE, without remarks on what they exclude; groups one blank line apart.
class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter() {
    constexpr std::size_t kNameColumns = 40;
    column_width(kNameColumns);
    label("SUBCOMMAND", "VERB");
    label("OPTIONS", "options");
    label("Positionals", "Input");
  }

  std::string make_option_opts(const CLI::Option* option) const override {
    return option->get_type_name().empty() ? "" : " " + option->get_type_name();
  }
  /// Without the {false} that CLI11 adds to a flag that negates.
  std::string make_option_name(const CLI::Option* option, bool is_positional) const override {
    const std::string name = CLI::Formatter::make_option_name(option, is_positional);
    return name.substr(0, name.find('{'));
  }
  std::string make_usage(const CLI::App* app, std::string name) const override {
    return CLI::Formatter::make_usage(app, std::move(name)) + "\n";
  }
  std::string make_group(std::string group, bool is_positional,
                         std::vector<const CLI::Option*> options) const override {
    const std::string text = CLI::Formatter::make_group(std::move(group), is_positional, std::move(options));
    return text.substr(1) + (is_positional ? "\n" : "");
  }
};

constexpr const char* kHelpFlag = "-h,--help";
constexpr const char* kHelpText = "This text";

}  // namespace

Option& Option::type(const std::string& text) { return option_->type_name(text), *this; }
Option& Option::group(const std::string& name) { return option_->group(name), *this; }
Option& Option::required() { return option_->required(), *this; }
Option& Option::values(int count) { return option_->expected(count), *this; }
Option& Option::repeated() {
  option_->expected(1)->allow_extra_args(false)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  return *this;
}
Option& Option::needs(const Option& other) { return option_->needs(other.option_), *this; }
Option& Option::excludes(const Option& other) { return option_->excludes(other.option_), *this; }

Option Command::text(const std::string& name, std::string& into, const std::string& help) {
  return Option(app_->add_option(name, into, help)).type("");
}
Option Command::texts(const std::string& name, std::vector<std::string>& into, const std::string& help) {
  return Option(app_->add_option(name, into, help)).type("");
}
Option Command::flag(const std::string& name, bool& into, const std::string& help) {
  return Option(app_->add_flag(name, into, help));
}
Option Command::flag_or_value(const std::string& name, const std::string& type, std::string& into,
                              const std::string& help) {
  return Option(app_->add_flag(name, into, help)).type(type);
}
Option Command::value(const std::string& name, const std::string& type,
                      const std::function<void(const std::string&)>& store, const std::string& help) {
  return Option(app_->add_option_function<std::string>(name, store, help)).type(type);
}
Option Command::help() { return Option(app_->set_help_flag(kHelpFlag, kHelpText)); }
void Command::footer(const std::string& text) { app_->footer(text); }

bool Command::has(const std::string& name) const { return app_->count(name) > 0; }
std::vector<std::string> Command::given() const {
  std::vector<std::string> names;
  for (const CLI::Option* option : std::as_const(*app_).get_options()) {
    if (option->count() > 0) names.push_back(option->get_name());
  }
  return names;
}

CommandLine::CommandLine(const std::string& name, const std::string& what, const std::string& version)
    : app_(std::make_unique<CLI::App>(what)) {
  app_->name(name);
  app_->set_version_flag("--version", name + " " + version, "The version");
  app_->set_help_flag(kHelpFlag, kHelpText);
  app_->require_subcommand(0, 1);
  app_->formatter(std::make_shared<HelpFormatter>());
}
CommandLine::~CommandLine() = default;

Command CommandLine::add_verb(const std::string& name, const std::string& what) {
  return Command(app_->add_subcommand(name, what)->group("Verbs"));
}
void CommandLine::footer(const std::string& text) { app_->footer(text); }

CommandLine::Asked CommandLine::parse(int argc, char** argv) {
  try {
    app_->parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    return {.verb = {}, .text = app_->help()};
  } catch (const CLI::CallForVersion& call) {
    return {.verb = {}, .text = std::string(call.what()) + "\n"};
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what());
  }
  const std::vector<CLI::App*> verbs = app_->get_subcommands();
  return {.verb = verbs.empty() ? std::string() : verbs[0]->get_name(), .text = {}};
}

}  // namespace candela::cli
