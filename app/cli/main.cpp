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
  const std::string_view first = argc > 1 ? argv[1] : "";
  const bool is_verb = std::any_of(kVerbs.begin(), kVerbs.end(), [&](const VerbInfo& v) { return v.name == first; });
  return std::string("Try 'candela ") + (is_verb ? std::string(first) + " " : "") + "--help'.\n";
}

std::string verb_names() {
  std::string text;
  for (const VerbInfo& verb : kVerbs) {
    const bool is_last = &verb == &kVerbs.back();
    text += (text.empty() ? "" : is_last ? " or " : ", ") + std::string(verb.name);
  }
  return text;
}

int run(int argc, char** argv) {
  CommandLine line("candela", "Candela: physically based pictures of glTF scenes", version());
  std::vector<Command> commands;
  commands.reserve(kVerbs.size());  // what a verb does refers to its command
  std::vector<Verb> verbs;
  verbs.reserve(kVerbs.size());
  for (const VerbInfo& verb : kVerbs) {
    commands.push_back(line.add_verb(std::string(verb.name), std::string(verb.what)));
    verbs.push_back(verb.add(commands.back()));
  }
  line.footer(
      "`candela VERB --help` tells more, with examples.\n"
      "Exit codes: 0 done, 1 bad input or failed work, 2 wrong usage, 130 stopped by Ctrl-C or SIGTERM with work "
      "left.");  // last, because verbs inherit it

  try {
    const CommandLine::Asked asked = line.parse(argc, argv);
    if (!asked.text.empty()) return print(asked.text), kDone;
    for (std::size_t i = 0; i < kVerbs.size(); ++i) {
      if (kVerbs[i].name == asked.verb) return verbs[i](), kDone;
    }
    throw UsageError("no verb given: " + verb_names());
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
