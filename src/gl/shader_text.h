#pragma once

#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace candela::gl {

/// GLSL text with every include expanded once, where it stands, and where each line came from. (#line would say it to
/// the compiler, but Mesa's loses the source number within expressions.)
class ShaderText {
 public:
  /// Gives the text of a file by the name that stands in an include. Throws Error for one that is not there.
  using Reader = std::function<std::string(const std::string& name)>;
  explicit ShaderText(Reader reader);

  void add_header(const std::string& name);
  /// `name` stands in messages; lines count from 1.
  void add_text(const std::string& name, const std::string& text);
  /// The text may be altered, in one place: `from` must occur exactly once, or Error.
  void replace(const std::string& from, const std::string& to);

  const std::string& text() const { return text_; }
  /// A compiler's log with "0:345(5): …" turned into "shade/x.glsl.h:12: …".
  std::string explain(const std::string& log) const;

 private:
  struct Origin {
    std::string name;
    int line = 0;
  };

  void add_line(const std::string& name, int number, const std::string& line);

  Reader reader_;
  std::string text_;
  std::set<std::string> headers_;
  std::vector<Origin> origins_;  ///< of each line of the text
};

/// Reads includes from a folder.
ShaderText::Reader read_from_folder(std::string root);

}  // namespace candela::gl
