#include "cli/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <utility>

#include "base/text.h"
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
Option& Option::choices(const std::vector<std::string>& words) {
  notes_->choices[option_] = {words, false};
  return *this;
}
Option& Option::choices_of_list(const std::vector<std::string>& words) {
  notes_->choices[option_] = {words, true};
  return *this;
}

Option Command::text(const std::string& name, std::string& into, const std::string& help) {
  return Option(app_->add_option(name, into, help), notes_).type("");
}
Option Command::texts(const std::string& name, std::vector<std::string>& into, const std::string& help) {
  return Option(app_->add_option(name, into, help), notes_).type("");
}
Option Command::flag(const std::string& name, bool& into, const std::string& help) {
  return {app_->add_flag(name, into, help), notes_};
}
Option Command::flag_or_value(const std::string& name, const std::string& type, std::string& into,
                              const std::string& help) {
  return Option(app_->add_flag(name, into, help), notes_).type(type);
}
Option Command::value(const std::string& name, const std::string& type,
                      const std::function<void(const std::string&)>& store, const std::string& help) {
  return Option(app_->add_option_function<std::string>(name, store, help), notes_).type(type);
}
Option Command::help() { return {app_->set_help_flag(kHelpFlag, kHelpText), notes_}; }
void Command::footer(const std::string& text) { app_->footer(text); }
void Command::short_help(const std::vector<std::string>& names, const std::string& text) {
  notes_->short_help = {names, text};
}

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
  CLI::App* verb = app_->add_subcommand(name, what)->group("Verbs");
  return {verb, &notes_[verb]};
}
void CommandLine::footer(const std::string& text) { app_->footer(text); }
void CommandLine::add_topic(const std::string& name, const std::function<std::string()>& text) { topics_[name] = text; }

namespace {

constexpr const char* kAll = "all";

bool is_help(const std::string& text) { return text == "-h" || text == "--help"; }

/// `help VERB all` as `VERB --help all`.
template <class IsVerb>
std::vector<std::string> without_help_verb(std::vector<std::string> arguments, IsVerb is_verb) {
  if (arguments.empty() || arguments[0] != "help") return arguments;
  arguments.erase(arguments.begin());
  const bool has_verb = !arguments.empty() && is_verb(arguments[0]);
  arguments.insert(arguments.begin() + (has_verb ? 1 : 0), "--help");
  return arguments;
}

/// The names with dashes of all options that an app has.
std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

/// What CLI11 was left with: the first option that the verb has not, else the first text that it has no place for.
std::string unexpected_text(const CLI::App& app) {
  const std::vector<std::string> left = app.remaining(true);
  const auto is_option = [](const std::string& text) { return text.size() > 1 && text[0] == '-'; };
  const auto option = std::find_if(left.begin(), left.end(), is_option);
  const std::vector<CLI::App*> verbs = app.get_subcommands();
  const std::string verb = verbs.empty() ? app.get_name() : verbs[0]->get_name();
  if (option == left.end()) return fmt::format("{} takes no '{}'", verb, left.empty() ? "" : left[0]);
  const std::string name = option->substr(0, option->find('='));
  const std::vector<std::string> known = option_names(verbs.empty() ? app : *verbs[0]);
  const std::string meant = did_you_mean(name, known);
  return fmt::format("{} has no option {}{}", verb, name, meant);
}

}  // namespace

std::string CommandLine::help_text(const std::string& topic) const {
  if (const auto found = topics_.find(topic); found != topics_.end()) return found->second();
  const std::vector<CLI::App*> verbs = app_->get_subcommands();
  CLI::App& app = verbs.empty() ? *app_ : *verbs[0];
  const auto found = notes_.find(&app);
  if (topic == kAll || found == notes_.end() || found->second.short_help.names.empty()) return app_->help();
  for (CLI::Option* option : app.get_options()) {
    const std::vector<std::string>& shown = found->second.short_help.names;
    const bool is_shown = std::find(shown.begin(), shown.end(), option->get_name()) != shown.end();
    if (!option->get_positional() && !is_shown) option->group("");
  }
  app.footer(found->second.short_help.footer);
  return app_->help();
}

CommandLine::Asked CommandLine::parse(const std::vector<std::string>& given) {
  std::vector<std::string> arguments = without_help_verb(given, [this](const std::string& word) {
    return !app_->get_subcommands([&](CLI::App* verb) { return verb->get_name() == word; }).empty();
  });
  std::string topic;
  const auto help = std::find_if(arguments.begin(), arguments.end(), is_help);
  const auto next = help == arguments.end() ? help : help + 1;
  if (next != arguments.end() && (*next == kAll || topics_.contains(*next))) {
    topic = *next;
    arguments.erase(next);
  }
  std::reverse(arguments.begin(), arguments.end());  // as CLI11 wants them
  try {
    app_->parse(std::move(arguments));
  } catch (const CLI::CallForHelp&) {
    return {.verb = {}, .text = help_text(topic)};
  } catch (const CLI::CallForVersion& call) {
    return {.verb = {}, .text = std::string(call.what()) + "\n"};
  } catch (const CLI::ExtrasError&) {
    throw UsageError(unexpected_text(*app_));
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what());
  }
  const std::vector<CLI::App*> verbs = app_->get_subcommands();
  return {.verb = verbs.empty() ? std::string() : verbs[0]->get_name(), .text = {}};
}

namespace {

OptionInfo info_of(const CLI::Option& option, const CommandNotes* notes) {
  OptionInfo info;
  for (const std::string& name : option.get_snames()) info.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) info.names.push_back("--" + name);
  if (option.get_positional()) info.input = option.get_name();
  info.type = option.get_type_name();
  info.help = option.get_description();
  info.group = option.get_group();
  info.values = option.get_items_expected_max();
  info.may_have_value = info.values == 0 && !info.type.empty();
  info.is_repeated = option.get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll;
  info.is_required = option.get_required();
  if (notes == nullptr) return info;
  if (const auto found = notes->choices.find(&option); found != notes->choices.end()) info.choices = found->second;
  return info;
}

CommandInfo info_of(const CLI::App& app, const CommandNotes* notes) {
  CommandInfo info{.name = app.get_name(), .what = app.get_description(), .footer = app.get_footer(), .options = {}};
  for (const CLI::Option* option : app.get_options()) info.options.push_back(info_of(*option, notes));
  return info;
}

}  // namespace

std::vector<CommandInfo> CommandLine::commands() const {
  const CLI::App& app = *app_;
  std::vector<CommandInfo> infos{info_of(app, nullptr)};
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    const auto found = notes_.find(verb);
    infos.push_back(info_of(*verb, found == notes_.end() ? nullptr : &found->second));
  }
  return infos;
}

}  // namespace candela::cli
