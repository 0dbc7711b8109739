#include "gl/shader_text.h"

#include <cstdio>
#include <fstream>
#include <iterator>
#include <sstream>

#include "base/error.h"

namespace candela::gl {

ShaderText::ShaderText(Reader reader) : reader_(std::move(reader)) {
  add_text("preamble", "#version 300 es\nprecision highp float;\nprecision highp int;\n");
}

void ShaderText::add_line(const std::string& name, int number, const std::string& line) {
  text_ += line + "\n";
  origins_.push_back({name, number});
}

void ShaderText::add_header(const std::string& name) {
  if (!headers_.insert(name).second) return;
  std::istringstream file(reader_(name));
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

void ShaderText::add_text(const std::string& name, const std::string& text) {
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) add_line(name, number, line);
}

void ShaderText::replace(const std::string& from, const std::string& to) {
  if ((from + to).find('\n') != std::string::npos) throw Error("only within a line", from);
  const std::size_t at = text_.find(from);
  if (at == std::string::npos) throw Error("is nowhere in the GLSL text", from);
  if (text_.find(from, at + 1) != std::string::npos) throw Error("is in the GLSL text more than once", from);
  text_.replace(at, from.size(), to);
}

std::string ShaderText::explain(const std::string& log) const {
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

ShaderText::Reader read_from_folder(std::string root) {
  return [root = std::move(root)](const std::string& name) {
    std::ifstream file(root + "/" + name);
    if (!file) throw Error("cannot read", root + "/" + name);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
}

}  // namespace candela::gl
