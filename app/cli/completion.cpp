#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "base/error.h"
#include "base/file.h"
#include "candela/candela.h"
#include "cli/completion_scripts.h"
#include "cli/man_pages.h"
#include "cli/option.h"
#include "cli/output.h"
#include "cli/program.h"
#include "cli/verbs.h"

namespace candela::cli {

namespace fs = std::filesystem;

namespace {

struct CompletionOptions {
  std::string kind;
  std::string output;
};

const std::vector<std::string> kKinds = {"bash", "zsh", "man"};

void write_man_pages(const fs::path& folder) {
  const std::map<std::string, std::string> pages = man_pages(all_commands(), version());
  for (const auto& [name, text] : pages) check_writable(folder / name);
  for (const auto& [name, text] : pages) {
    const FolderFor made(folder / name);
    write_file(folder / name, text);
  }
}

void run_completion(const CompletionOptions& o) {
  const bool is_manual = o.kind == "man";
  if (!is_manual && !completion_scripts().contains(o.kind)) {
    throw UsageError("KIND: '" + o.kind + "' is none of bash, zsh, man");
  }
  if (is_manual && o.output.empty()) throw UsageError("--output: where the pages go is missing: -o DIR");
  if (!is_manual && !o.output.empty()) throw UsageError("--output: only of man; a script goes to standard output");
  if (is_manual) return write_man_pages(o.output);
  print(completion_scripts().find(o.kind)->second);
}

}  // namespace

Verb add_completion(Command& command) {
  const auto options = std::make_shared<CompletionOptions>();
  command.text("KIND", options->kind, "bash or zsh: a script that completes what is typed; man: the manual")
      .choices(kKinds)
      .required();
  command.text("-o,--output", options->output, "Of man, the folder that the pages are written to").type("DIR");
  command.help();
  command.footer(
      "The scripts ask the program: `candela completion words WORD...` prints what the last word may become.\n"
      "Packages install the scripts and the manual.\n\n"
      "Examples:\n"
      "  source <(candela completion bash)\n"
      "  candela completion zsh > ~/.zfunc/_candela\n"
      "  candela completion man -o ~/.local/share/man/man1\n");
  return [options] { run_completion(*options); };
}

}  // namespace candela::cli
