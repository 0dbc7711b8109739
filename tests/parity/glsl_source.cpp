#include "parity/glsl_source.h"

#include <cstdio>
#include <fstream>
#include <sstream>

#include "base/error.h"

namespace candela::parity {

GlslSource::GlslSource(std::string root) : root_(std::move(root)) {
  add_text("preamble", "#version 300 es\nprecision highp float;\nprecision highp int;\n");
}

void GlslSource::add_line(const std::string& name, int number, const std::string& line) {
  text_ += line + "\n";
  origins_.push_back({name, number});
}

void GlslSource::add_header(const std::string& name) {
  if (!headers_.insert(name).second) return;
  std::ifstream file(root_ + "/" + name);
  if (!file) throw Error("cannot read", root_ + "/" + name);
  static const std::string kInclude = "#include \"";
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (line.starts_with(kInclude)) {
      add_header(line.substr(kInclude.size(), line.find('"', kInclude.size()) - kInclude.size()));
    } else {
      add_line(name, number, line);
    }
  }
}

void GlslSource::add_text(const std::string& name, const std::string& text) {
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) add_line(name, number, line);
}

void GlslSource::replace(const std::string& from, const std::string& to) {
  if ((from + to).find('\n') != std::string::npos) throw Error("only within a line", from);
  const std::size_t at = text_.find(from);
  if (at == std::string::npos) throw Error("is nowhere in the GLSL text", from);
  if (text_.find(from, at + 1) != std::string::npos) throw Error("is in the GLSL text more than once", from);
  text_.replace(at, from.size(), to);
}

std::string GlslSource::explain(const std::string& log) const {
  std::istringstream lines(log);
  std::ostringstream explained;
  for (std::string line; std::getline(lines, line);) {
    std::size_t number = 0;
    int end = 0;
    std::sscanf(line.c_str(), "0:%zu(%*d):%n", &number, &end);                  // Mesa
    if (end == 0) std::sscanf(line.c_str(), "ERROR: 0:%zu:%n", &number, &end);  // most others
    if (end > 0 && number > 0 && number <= origins_.size()) {
      const Origin& origin = origins_[number - 1];
      explained << origin.name << ":" << origin.line << ":" << line.substr(static_cast<std::size_t>(end)) << "\n";
    } else {
      explained << line << "\n";
    }
  }
  return explained.str();
}

}  // namespace candela::parity
