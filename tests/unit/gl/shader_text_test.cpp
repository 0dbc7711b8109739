#include "gl/shader_text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>

#include "base/error.h"

namespace candela {
namespace {

using gl::ShaderText;

/// Files by name; others are an Error.
ShaderText::Reader reader_of(std::map<std::string, std::string> files) {
  return [files = std::move(files)](const std::string& name) {
    const auto found = files.find(name);
    if (found == files.end()) throw Error("no such file", name);
    return found->second;
  };
}

/// Its text without the preamble that every shader has.
std::string body(const ShaderText& text) {
  const std::string empty = ShaderText(reader_of({})).text();
  EXPECT_TRUE(text.text().starts_with(empty));
  return text.text().substr(empty.size());
}

/// The line of the text on which something stands, from 1.
std::size_t line_of(const ShaderText& text, const std::string& what) {
  const std::size_t at = text.text().find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return 1 +
         static_cast<std::size_t>(std::count(text.text().begin(), text.text().begin() + static_cast<long>(at), '\n'));
}

TEST(unit_gl_shader_text, starts_as_glsl_es_3) {
  EXPECT_TRUE(ShaderText(reader_of({})).text().starts_with("#version 300 es\n"));
}

TEST(unit_gl_shader_text, includes_are_expanded_once_where_they_stand) {
  ShaderText text(reader_of({{"a", "float a;\n"},
                             {"b", "#include \"a\"\nfloat b;\n"},
                             {"main", "float first;\n#include \"b\"\n#include \"a\"\nfloat last;"}}));
  text.add_header("main");
  text.add_header("a");
  EXPECT_EQ(body(text), "float first;\nfloat a;\nfloat b;\nfloat last;\n");
}

TEST(unit_gl_shader_text, a_file_that_is_not_there_is_an_error) {
  ShaderText text(reader_of({{"main", "#include \"gone\"\n"}}));
  EXPECT_THROW(text.add_header("main"), Error);
  ShaderText of_folder(gl::read_from_folder("/nowhere"));
  try {
    of_folder.add_header("x.glsl");
    ADD_FAILURE() << "read";
  } catch (const Error& error) {
    EXPECT_EQ(error.where(), "/nowhere/x.glsl");
  }
}

TEST(unit_gl_shader_text, a_drivers_log_names_the_lines_of_files) {
  ShaderText text(reader_of({{"a", "float a;\nfloat wrong\n"}, {"main", "\n#include \"a\"\nvoid main() {}\n"}}));
  text.add_text("defines", "#define X\n");
  text.add_header("main");
  const std::string wrong = std::to_string(line_of(text, "float wrong")),
                    main = std::to_string(line_of(text, "void main"));
  EXPECT_EQ(text.explain("0:" + wrong + "(7): error: no"), "a:2: error: no\n");          // Mesa
  EXPECT_EQ(text.explain("ERROR: 0:" + main + ": no\nsecond"), "main:3: no\nsecond\n");  // most others
  EXPECT_EQ(text.explain("0:" + std::to_string(line_of(text, "#define X")) + "(1): x"), "defines:1: x\n");
}

TEST(unit_gl_shader_text, a_line_that_is_nowhere_in_the_text_stays_as_the_driver_says_it) {
  const ShaderText text(reader_of({}));
  for (const char* log : {"0:0(1): x", "0:999(1): x", "no line at all"})
    EXPECT_EQ(text.explain(log), std::string(log) + "\n");
}

TEST(unit_gl_shader_text, text_is_replaced_in_one_place_or_not_at_all) {
  ShaderText text(reader_of({}));
  text.add_text("main", "one two\ntwo three\n");
  EXPECT_THROW(text.replace("two", "2"), Error);
  EXPECT_THROW(text.replace("four", "4"), Error);
  EXPECT_THROW(text.replace("one", "1\n"), Error) << "lines would move";
  text.replace("three", "3");
  EXPECT_EQ(body(text), "one two\ntwo 3\n");
}

}  // namespace
}  // namespace candela
