#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstring>
#include <new>
#include <string>
#include <string_view>

#include "base/error.h"
#include "candela/candela.h"
#include "cli/values.h"
#include "cli/verbs.h"

namespace candela::cli {

void print(const std::string& text) {
  // write(2) rather than a stream: the error is known here, not when the process ends.
  std::string_view rest = text;
  while (!rest.empty()) {
    const ssize_t count = ::write(STDOUT_FILENO, rest.data(), rest.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw Error(std::string("cannot write: ") + std::strerror(errno), "standard output");
    rest.remove_prefix(static_cast<std::size_t>(count));
  }
}

namespace {

constexpr int kDone = 0;
constexpr int kFailed = 1;
constexpr int kWrongUsage = 2;
constexpr int kInterrupted = 130;  // as shells report SIGINT; of SIGTERM too, which is handled alike

int fail(int code, const std::string& message, const std::string& hint = {}) {
  std::cerr << "candela: " << one_line(message) << '\n' << hint;
  return code;
}

std::string usage_hint(int argc, char** argv) {
  const std::string_view verb = argc > 1 ? argv[1] : "";
  const bool known = verb == "render" || verb == "info" || verb == "furnace" || verb == "bake" || verb == "check" ||
                     verb == "figures" || verb == "view";
  return std::string("Try 'candela ") + (known ? std::string(verb) + " " : "") + "--help'.\n";
}

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
  std::string make_usage(const CLI::App* app, std::string name) const override {
    return CLI::Formatter::make_usage(app, std::move(name)) + "\n";
  }
  std::string make_group(std::string group, bool is_positional,
                         std::vector<const CLI::Option*> options) const override {
    const std::string text = CLI::Formatter::make_group(std::move(group), is_positional, std::move(options));
    return text.substr(1) + (is_positional ? "\n" : "");
  }
};

int run(int argc, char** argv) {
  CLI::App app{"Candela: physically based pictures of glTF scenes"};
  app.name("candela");
  app.set_version_flag("--version", std::string("candela ") + version(), "The version");
  app.set_help_flag("-h,--help", "This text");
  app.require_subcommand(0, 1);
  app.formatter(std::make_shared<HelpFormatter>());
  const Verb render = add_render(app);
  const Verb info = add_info(app);
  const Verb furnace = add_furnace(app);
  const Verb bake = add_bake(app);
  const Verb check = add_check(app);
  const Verb view = add_view(app);
  const Verb figures = add_figures(app);
  app.footer(
      "`candela VERB --help` tells more, with examples.\n"
      "Exit codes: 0 done, 1 bad input or failed work, 2 wrong usage, 130 stopped by Ctrl-C or SIGTERM with work "
      "left.");  // last, because verbs inherit it

  try {
    app.parse(argc, argv);
    if (app.got_subcommand("render")) return render(), kDone;
    if (app.got_subcommand("info")) return info(), kDone;
    if (app.got_subcommand("furnace")) return furnace(), kDone;
    if (app.got_subcommand("bake")) return bake(), kDone;
    if (app.got_subcommand("check")) return check(), kDone;
    if (app.got_subcommand("figures")) return figures(), kDone;
    if (app.got_subcommand("view")) return view(), kDone;
    throw UsageError("no verb given: render, view, info, check, furnace, bake or figures");
  } catch (const CLI::CallForHelp&) {
    print(app.help());
    return kDone;
  } catch (const CLI::CallForVersion& call) {
    print(std::string(call.what()) + "\n");
    return kDone;
  } catch (const CLI::ParseError& error) {
    return fail(kWrongUsage, error.what(), usage_hint(argc, argv));
  } catch (const UsageError& error) {
    return fail(kWrongUsage, error.what(), usage_hint(argc, argv));
  }
}

}  // namespace

}  // namespace candela::cli

int main(int argc, char** argv) {
  using namespace candela::cli;
  try {
    return run(argc, argv);
  } catch (const candela::Interrupted& stop) {
    return fail(kInterrupted, std::string("interrupted: ") + stop.what());
  } catch (const std::bad_alloc&) {
    return fail(kFailed, "out of memory");
  } catch (const std::exception& error) {
    return fail(kFailed, error.what());
  }
}
