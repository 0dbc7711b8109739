#include "cli/jobs.h"

#include <fmt/format.h>

#include <fstream>
#include <iostream>

#include "base/error.h"
#include "cli/interrupt.h"
#include "cli/values.h"

namespace candela::cli {

namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/// Appends what stands between quotation marks; `at` is behind the first one, and then behind the last.
void take_quoted(const std::string& line, char mark, std::size_t& at, std::string& word) {
  for (; at < line.size() && line[at] != mark; ++at) {
    const bool is_escape = mark == '"' && line[at] == '\\' && at + 1 < line.size();
    if (is_escape && (line[at + 1] == '"' || line[at + 1] == '\\')) ++at;
    word += line[at];
  }
  if (at == line.size()) throw UsageError(fmt::format("a {} is not closed", mark));
  ++at;
}

/// The word that begins at `at`, which is then behind it.
std::string take_word(const std::string& line, std::size_t& at) {
  std::string word;
  while (at < line.size() && !is_blank(line[at])) {
    const char c = line[at++];
    if (c == '\'' || c == '"') {
      take_quoted(line, c, at, word);
    } else if (c == '\\' && at < line.size()) {
      word += line[at++];
    } else {
      word += c;
    }
  }
  return word;
}

}  // namespace

std::vector<std::string> words_of(const std::string& line) {
  std::vector<std::string> words;
  for (std::size_t at = 0;;) {
    while (at < line.size() && is_blank(line[at])) ++at;
    if (at >= line.size() || line[at] == '#') return words;
    words.push_back(take_word(line, at));
  }
}

std::vector<std::string> without_verb(std::vector<std::string> words) {
  if (!words.empty() && words[0] == "candela") words.erase(words.begin());
  if (!words.empty() && words[0] == "render") words.erase(words.begin());
  return words;
}

void run_jobs(const std::string& file, const std::function<void(const std::vector<std::string>&)>& run,
              ProgressLine& progress) {
  const bool is_piped = file == "-";
  std::ifstream opened;
  if (!is_piped) {
    opened.open(file);
    if (!opened) throw Error("cannot be read", file);
  }
  std::istream& lines = is_piped ? std::cin : opened;
  const std::string where = is_piped ? "standard input" : file;
  std::size_t number = 0, jobs = 0, failed = 0;
  for (std::string line; !Interrupt::requested() && std::getline(lines, line);) {
    const std::string place = fmt::format("{}:{}", where, ++number);
    ++jobs;
    try {
      const std::vector<std::string> words = without_verb(words_of(line));
      if (words.empty()) {
        --jobs;
        continue;
      }
      run(words);
    } catch (const Interrupted&) {
      throw;
    } catch (const std::exception& error) {
      ++failed;
      progress.failed({error.what(), place});
    }
  }
  if (Interrupt::requested()) throw Interrupted(fmt::format("after {} jobs", jobs));
  if (failed > 0) throw Error(fmt::format("{} of {} jobs failed", failed, jobs), where);
}

}  // namespace candela::cli
