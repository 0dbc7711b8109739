#include "cli/man_pages.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <string_view>

namespace candela::cli {

namespace {

constexpr std::string_view kExamples = "Examples:";
constexpr std::string_view kExitCodes = "Exit codes:";

/// The code point that begins at `at`, which is then behind it. The program's texts are valid UTF-8.
unsigned take_code_point(const std::string& text, std::size_t& at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned>(static_cast<unsigned char>(text[i])); };
  const unsigned first = byte(at++);
  if (first < 0x80) return first;
  const std::size_t more = first >= 0xf0 ? 3 : first >= 0xe0 ? 2 : 1;
  unsigned code = first & (0x3fu >> more);
  for (std::size_t i = 0; i < more && at < text.size(); ++i) code = (code << 6) | (byte(at++) & 0x3f);
  return code;
}

/// Text as roff means it literally: hyphens that can be copied into a shell, no escape, no request by accident.
std::string literal(const std::string& text) {
  std::string result = text.starts_with('.') || text.starts_with('\'') ? "\\&" : "";
  for (std::size_t at = 0; at < text.size();) {
    const unsigned code = take_code_point(text, at);
    if (code >= 0x80) {
      result += fmt::format("\\[u{:04X}]", code);
    } else if (code == '\\') {
      result += "\\e";
    } else if (code == '-') {
      result += "\\-";
    } else if (code == '\'') {
      result += "\\(aq";
    } else if (code == '`') {
      result += "\\(ga";
    } else if (code == '^') {
      result += "\\(ha";
    } else if (code == '~') {
      result += "\\(ti";
    } else {
      result += static_cast<char>(code);
    }
  }
  return result;
}

std::string bold(const std::string& text) { return "\\fB" + literal(text) + "\\fR"; }
std::string italic(const std::string& text) { return "\\fI" + literal(text) + "\\fR"; }

/// The lines of a footer, sorted by where a manual has them.
struct Footer {
  std::vector<std::string> text, examples, exit_codes;
};

Footer read_footer(const std::string& footer) {
  Footer result;
  std::vector<std::string>* part = &result.text;
  std::istringstream lines(footer);
  for (std::string line; std::getline(lines, line);) {
    if (line == kExamples) {
      part = &result.examples;
      continue;
    }
    if (line.starts_with(kExitCodes)) {
      part = &result.exit_codes;
      line = line.substr(kExitCodes.size() + 1);
    } else if (part != &result.text && line.empty()) {
      part = &result.text;
    }
    part->push_back(line);
  }
  return result;
}

/// Paragraphs; lines that are indented keep their form.
std::string paragraphs(const std::vector<std::string>& lines) {
  std::string text;
  bool is_example = false, is_new = false;
  for (const std::string& line : lines) {
    const bool is_indented = line.starts_with("  ");
    if (line.empty()) {
      is_new = true;
      continue;
    }
    if (is_example && !is_indented) text += ".EE\n";
    if (!text.empty() && (is_new || is_indented != is_example)) text += ".PP\n";
    if (is_indented && !is_example) text += ".EX\n";
    text += literal(is_indented ? line.substr(2) : line) + "\n";
    is_example = is_indented;
    is_new = false;
  }
  return text + (is_example ? ".EE\n" : "");
}

std::string head(const std::string& name, const std::string& what, const std::string& version) {
  std::string title = name;
  std::transform(title.begin(), title.end(), title.begin(),
                 [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
  return fmt::format(".\\\" Made by `candela completion man`.\n.TH {} 1 \"\" \"candela {}\" \"User Commands\"\n", title,
                     version) +
         fmt::format(".SH NAME\n{} \\- {}\n", literal(name), literal(what));
}

std::string option_text(const OptionInfo& option) {
  std::string names;
  for (const std::string& name : option.names) names += (names.empty() ? "" : ", ") + bold(name);
  if (option.names.empty()) names = italic(option.input);
  const std::string gap = option.may_have_value || option.type.empty() ? "" : " ";
  return ".TP\n" + names + gap + (option.type.empty() ? "" : italic(option.type)) + "\n" + literal(option.help) + "\n";
}

std::string options_text(const CommandInfo& command) {
  std::vector<std::string> groups;
  for (const OptionInfo& option : command.options) {
    const bool is_new = std::find(groups.begin(), groups.end(), option.group) == groups.end();
    if (!option.names.empty() && is_new) groups.push_back(option.group);
  }
  std::string inputs, text;
  for (const OptionInfo& option : command.options) {
    if (option.names.empty()) inputs += option_text(option);
  }
  for (const std::string& group : groups) {
    if (groups.size() > 1) text += ".SS " + literal(group) + "\n";
    for (const OptionInfo& option : command.options) {
      if (!option.names.empty() && option.group == group) text += option_text(option);
    }
  }
  return (inputs.empty() ? "" : ".SH INPUT\n" + inputs) + ".SH OPTIONS\n" + text;
}

std::string synopsis(const std::string& command, const std::vector<OptionInfo>& options) {
  std::string text = ".SH SYNOPSIS\n" + bold(command) + " [" + italic("options") + "]";
  for (const OptionInfo& option : options) {
    if (!option.names.empty()) continue;
    const std::string input = italic(option.input) + (option.values > 1 ? "..." : "");
    text += option.is_required ? " " + input : " [" + input + "]";
  }
  return text + "\n";
}

std::string see_also(const std::vector<std::string>& pages) {
  std::string text = ".SH SEE ALSO\n";
  for (const std::string& page : pages) {
    text += ".BR " + literal(page) + " (1)" + (&page == &pages.back() ? "" : ",") + "\n";
  }
  return text;
}

std::string section(const std::string& name, const std::string& text) {
  return text.empty() ? "" : ".SH " + name + "\n" + text;
}

std::string verb_page(const CommandInfo& program, const CommandInfo& verb, const std::string& version) {
  const Footer footer = read_footer(verb.footer), common = read_footer(program.footer);
  // A verb without a footer of its own has the program's.
  const bool has_own = verb.footer != program.footer;
  return head(program.name + "-" + verb.name, verb.what, version) +
         synopsis(program.name + " " + verb.name, verb.options) +
         section("DESCRIPTION", has_own ? paragraphs(footer.text) : "") + options_text(verb) +
         section("EXAMPLES", paragraphs(footer.examples)) + section("EXIT STATUS", paragraphs(common.exit_codes)) +
         see_also({program.name});
}

std::string program_page(const std::vector<CommandInfo>& commands, const std::string& version) {
  const CommandInfo& program = commands[0];
  const Footer footer = read_footer(program.footer);
  std::string verbs = ".SH VERBS\n";
  std::vector<std::string> pages;
  for (std::size_t i = 1; i < commands.size(); ++i) {
    const CommandInfo& verb = commands[i];
    verbs += ".TP\n" + bold(verb.name) + "\n" + literal(verb.what) + "\n";
    pages.push_back(program.name + "-" + verb.name);
  }
  // "Candela: physically based pictures": a manual has the name on its own.
  const std::string what = program.what.substr(program.what.find(": ") + 2);
  return head(program.name, what, version) + ".SH SYNOPSIS\n" + bold(program.name) + " " + italic("VERB") + " [" +
         italic("options") + "]\n" + section("DESCRIPTION", paragraphs(footer.text)) + verbs + options_text(program) +
         section("EXIT STATUS", paragraphs(footer.exit_codes)) + see_also(pages);
}

}  // namespace

std::map<std::string, std::string> man_pages(const std::vector<CommandInfo>& commands, const std::string& version) {
  std::map<std::string, std::string> pages;
  pages[commands[0].name + ".1"] = program_page(commands, version);
  for (std::size_t i = 1; i < commands.size(); ++i) {
    pages[commands[0].name + "-" + commands[i].name + ".1"] = verb_page(commands[0], commands[i], version);
  }
  return pages;
}

}  // namespace candela::cli
