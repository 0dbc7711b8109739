#include "cli/program.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <iostream>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "candela/candela.h"
#include "cli/completion_words.h"
#include "cli/help.h"
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

bool is_verb(const std::string& word) {
  return std::any_of(kVerbs.begin(), kVerbs.end(), [&](const VerbInfo& v) { return v.name == word; });
}

std::string usage_hint(const std::vector<std::string>& arguments) {
  const bool has_verb = !arguments.empty() && is_verb(arguments[0]);
  return std::string("Try 'candela ") + (has_verb ? arguments[0] + " " : "") + "--help'.\n";
}

std::string verb_names() {
  std::string text;
  for (const VerbInfo& verb : kVerbs) {
    const bool is_last = &verb == &kVerbs.back();
    text += (text.empty() ? "" : is_last ? " or " : ", ") + std::string(verb.name);
  }
  return text;
}

/// `help` and what follows it may name a topic in place of a verb.
void check_verb(const std::vector<std::string>& arguments, const std::string& topic) {
  const std::size_t at = !arguments.empty() && arguments[0] == "help" ? 1 : 0;
  if (at >= arguments.size() || arguments[at].starts_with('-') || is_verb(arguments[at])) return;
  if (at == 1 && (arguments[at] == "all" || arguments[at] == topic)) return;
  throw UsageError(unknown_verb_text(arguments[at]));
}

constexpr const char* kDemos = "demos";

/// The command line with all that it may hold.
class Declared {
 public:
  Declared() {
    commands_.reserve(kVerbs.size());  // what a verb does refers to its command
    verbs_.reserve(kVerbs.size());
    for (const VerbInfo& verb : kVerbs) {
      commands_.push_back(line.add_verb(std::string(verb.name), std::string(verb.what)));
      verbs_.push_back(verb.add(commands_.back()));
    }
    line.add_topic(kDemos, demos_text);
    line.footer(
        "`candela VERB --help` tells more, with examples; `candela help demos` lists the built-in scenes.\n"
        "Exit codes: 0 done, 1 bad input or failed work, 2 wrong usage, 130 stopped by Ctrl-C or SIGTERM with work "
        "left.");  // last, because verbs inherit it
  }

  /// Null where there is none of that name.
  const Verb* verb(const std::string& name) const {
    for (std::size_t i = 0; i < kVerbs.size(); ++i) {
      if (kVerbs[i].name == name) return &verbs_[i];
    }
    return nullptr;
  }

  CommandLine line{"candela", "Candela: physically based pictures of glTF scenes", version()};

 private:
  std::vector<Command> commands_;
  std::vector<Verb> verbs_;
};

/// `completion words WORD…`: words of a command line that is not done, of which none is an option of this one.
bool asks_for_words(const std::vector<std::string>& arguments) {
  return arguments.size() > 1 && arguments[0] == "completion" && arguments[1] == "words";
}

int run(const std::vector<std::string>& arguments) {
  Declared declared;
  if (asks_for_words(arguments)) {
    return print(completion_text(declared.line.commands(), {arguments.begin() + 2, arguments.end()})), kDone;
  }
  try {
    check_verb(arguments, kDemos);
    const CommandLine::Asked asked = declared.line.parse(arguments);
    if (!asked.text.empty()) return print(asked.text), kDone;
    if (const Verb* verb = declared.verb(asked.verb)) return (*verb)(), kDone;
    throw UsageError("no verb given: " + verb_names());
  } catch (const UsageError& error) {
    return fail(kWrongUsage, error.what(), usage_hint(arguments));
  }
}

}  // namespace

std::vector<CommandInfo> all_commands() { return Declared().line.commands(); }

int run_program(const std::vector<std::string>& arguments) {
  try {
    return run(arguments);
  } catch (const Interrupted& stop) {
    return fail(kInterrupted, std::string("interrupted: ") + stop.what());
  } catch (const std::bad_alloc&) {
    return fail(kFailed, "out of memory");
  } catch (const std::exception& error) {
    return fail(kFailed, error.what());
  }
}

}  // namespace candela::cli
