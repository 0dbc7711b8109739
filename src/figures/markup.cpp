#include "figures/markup.h"

#include <algorithm>
#include <cctype>

#include "base/error.h"

namespace candela::figures {

std::string escaped(std::string_view text) {
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '&':
        safe += "&amp;";
        break;
      case '"':
        safe += "&quot;";
        break;
      case '\'':
        safe += "&#39;";
        break;
      default:
        if (static_cast<unsigned char>(c) >= ' ' || c == '\t' || c == '\n') safe += c;
    }
  }
  return safe;
}

namespace {

std::string element(std::string_view name, const std::string& content) {
  std::string text = "<";
  text.append(name).append(">").append(content).append("</").append(name).append(">");
  return text;
}

/// Recursive descent over the bytes of a formula.
class FormulaReader {
 public:
  explicit FormulaReader(std::string_view formula) : formula_(formula) {}

  std::string whole() {
    std::string content = row();
    if (at_ < formula_.size()) fail(formula_[at_] == ')' ? "a ) without its (" : "a } without its {");
    return content;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw Error(what, "formula " + std::string(formula_)); }

  void skip_blanks() {
    while (at_ < formula_.size() && formula_[at_] == ' ') ++at_;
  }

  /// One character of UTF-8.
  std::string_view character() const {
    std::size_t end = at_ + 1;
    while (end < formula_.size() && (static_cast<unsigned char>(formula_[end]) & 0xc0u) == 0x80u) ++end;
    return formula_.substr(at_, end - at_);
  }

  std::string row() {
    std::string content;
    for (skip_blanks(); at_ < formula_.size() && formula_[at_] != '}' && formula_[at_] != ')'; skip_blanks())
      content += with_scripts();
    return content;
  }

  std::string with_scripts() {
    std::string base = atom();
    std::string below, above;
    for (skip_blanks(); at_ < formula_.size() && (formula_[at_] == '_' || formula_[at_] == '^'); skip_blanks()) {
      std::string& script = formula_[at_] == '_' ? below : above;
      if (!script.empty()) fail("two scripts in one place");
      ++at_;
      script = atom();
    }
    if (below.empty() && above.empty()) return base;
    if (base == "<mo>∑</mo>" && above.empty()) return element("munder", base + below);
    if (above.empty()) return element("msub", base + below);
    if (below.empty()) return element("msup", base + above);
    return element("msubsup", base + below + above);
  }

  std::string atom() {
    skip_blanks();
    if (at_ == formula_.size()) fail("something is missing at its end");
    const char c = formula_[at_];
    if (c == '{') return element("mrow", group('}'));
    // Scripts belong to the whole of what stands between parentheses.
    if (c == '(') return element("mrow", "<mo>(</mo>" + group(')') + "<mo>)</mo>");
    if (c == '\\') return command();
    if (std::isdigit(static_cast<unsigned char>(c)) != 0) return number();
    const std::string_view text = character();
    at_ += text.size();
    return element(is_variable(text) ? "mi" : "mo", escaped(text));
  }

  static bool is_variable(std::string_view text) {
    if (text.size() == 1) return std::isalpha(static_cast<unsigned char>(text[0])) != 0;
    // Greek and Coptic is U+0370 to U+03FF.
    return text.size() == 2 && (text[0] == '\xcd' || text[0] == '\xce' || text[0] == '\xcf');
  }

  std::string number() {
    const std::size_t begin = at_;
    while (at_ < formula_.size() && (std::isdigit(static_cast<unsigned char>(formula_[at_])) != 0 ||
                                     (formula_[at_] == '.' && at_ + 1 < formula_.size() &&
                                      std::isdigit(static_cast<unsigned char>(formula_[at_ + 1])) != 0))) {
      ++at_;
    }
    return element("mn", std::string(formula_.substr(begin, at_ - begin)));
  }

  std::string group(char end) {
    ++at_;
    std::string content = row();
    if (at_ == formula_.size() || formula_[at_] != end) fail(std::string("a group without its ") + end);
    ++at_;
    return content;
  }

  /// What stands between braces, as it is.
  std::string raw_group() {
    const std::size_t end = formula_.find('}', at_);
    if (at_ == formula_.size() || formula_[at_] != '{' || end == std::string_view::npos) fail("a name needs {…}");
    const std::string_view text = formula_.substr(at_ + 1, end - at_ - 1);
    at_ = end + 1;
    return escaped(text);
  }

  std::string command() {
    ++at_;
    const std::size_t begin = at_;
    while (at_ < formula_.size() && std::isalpha(static_cast<unsigned char>(formula_[at_])) != 0) ++at_;
    const std::string_view name = formula_.substr(begin, at_ - begin);
    if (name.empty() && at_ < formula_.size() && formula_[at_] == ',') {
      ++at_;
      return "<mspace width=\"0.17em\"/>";
    }
    if (name == "frac") {
      const std::string above = atom();
      return element("mfrac", above + atom());
    }
    if (name == "sqrt") return element("msqrt", atom());
    if (name == "op") return element("mi", raw_group());
    if (name == "text") {
      std::string text = raw_group();
      for (std::size_t i = text.find(' '); i != std::string::npos; i = text.find(' ', i)) text.replace(i, 1, "\u00a0");
      return element("mtext", text);
    }
    fail("no command \\" + std::string(name));
  }

  std::string_view formula_;
  std::size_t at_ = 0;
};

}  // namespace

std::string mathml(std::string_view formula) {
  return "<math display=\"block\">" + element("mrow", FormulaReader(formula).whole()) + "</math>";
}

}  // namespace candela::figures
