// Parity: every shared function of src/shade says the same in C++ and in GLSL.
//
//   candela_parity_tests                       the tests, one for each function
//   candela_parity_tests --report FILE.md      writes how far apart the two are

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <numeric>
#include <set>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "gl/gl.h"
#include "gl/shader_text.h"
#include "parity/compare.h"
#include "parity/domains.h"
#include "parity/evaluate.h"

namespace candela::parity {
namespace {

constexpr int kInputs = 8192;

/// A context on Mesa's software driver, unless the environment says LIBGL_ALWAYS_SOFTWARE=0. Throws Error.
std::unique_ptr<gl::Context> open_context() {
  // What the environment already says stays. The disk cache would only leave files behind.
  setenv("LIBGL_ALWAYS_SOFTWARE", "1", 0);
  setenv("MESA_SHADER_CACHE_DISABLE", "true", 0);
  // Each program runs once: code that is optimised takes longer to compile than it saves.
  setenv("GALLIVM_PERF", "nopt", 0);
  // Vertices are shaded on this thread; the idle threads of the rasterizer only alarm ThreadSanitizer.
  setenv("LP_NUM_THREADS", "0", 0);
  return gl::Context::open();
}

class Parity : public testing::Test {
 protected:
  void SetUp() override {
    try {
      context_ = open_context();
    } catch (const Error& error) {
      GTEST_SKIP() << error.what();
    }
  }

 private:
  std::unique_ptr<gl::Context> context_;
};

Comparison compare_languages(const Function& function, const Alteration& alteration = {}) {
  const std::vector<float> inputs = draw_inputs(function, kInputs);
  return compare(function, limits_of(function.name), inputs, evaluate_cpp(function, inputs),
                 evaluate_glsl(function, inputs, alteration));
}

// ----- one test for each function

/// The same answers, all of them off by 0.3 % and a little, or discretely wrong.
std::vector<float> slightly_wrong(const Function& function, std::vector<float> outputs) {
  const auto stride = static_cast<std::size_t>(function.output.size);
  for (const Value& leaf : leaves(function.output)) {
    const bool discrete = leaf.type == "bool" || leaf.type == "int";
    const auto first = static_cast<std::size_t>(leaf.offset);
    for (std::size_t i = first; i < outputs.size(); i += stride) {
      for (std::size_t j = i; j < i + static_cast<std::size_t>(leaf.size); ++j) {
        if (outputs[j] == kAbsent) continue;
        outputs[j] = discrete ? 1.0f - outputs[j] : outputs[j] * 1.003f + 1e-6f;
      }
    }
  }
  return outputs;
}

/// How many of the answers are the same one.
double share_of_commonest(const Function& function, const std::vector<float>& outputs) {
  std::map<std::vector<float>, std::size_t> counts;
  std::size_t most = 0;
  for (auto at = outputs.begin(); at != outputs.end(); at += function.output.size) {
    most = std::max(most, ++counts[{at, at + function.output.size}]);
  }
  return static_cast<double>(most * static_cast<std::size_t>(function.output.size)) /
         static_cast<double>(outputs.size());
}

class CppEqualsGlsl : public Parity {
 public:
  explicit CppEqualsGlsl(const Function& function) : function_(function) {}

  void TestBody() override {
    const std::vector<float> inputs = draw_inputs(function_, kInputs);
    const std::vector<float> cpp = evaluate_cpp(function_, inputs);
    const std::vector<float> glsl = evaluate_glsl(function_, inputs);
    const Limits limits = limits_of(function_.name);
    const Comparison comparison = compare(function_, limits, inputs, cpp, glsl);
    EXPECT_TRUE(comparison.holds) << comparison.evidence;
    RecordProperty("worst", std::to_string(comparison.worst));
    RecordProperty("outliers", comparison.outliers);
    EXPECT_FALSE(compare(function_, limits, inputs, cpp, slightly_wrong(function_, glsl)).holds)
        << "answers that are 0.3 % wrong pass as well: the limits or the domain are too wide";
    if (!function_.inputs.empty()) {
      EXPECT_LT(share_of_commonest(function_, cpp), 0.98) << "the domain shows next to nothing of the function";
    }
  }

 private:
  const Function& function_;
};

void register_functions() {
  for (const Function& function : functions()) {
    const std::string name = "cpp_equals_glsl/" + function.name;
    const std::string file = CANDELA_SOURCE_DIR "/src/" + function.header;
    testing::RegisterTest("parity.shade", name.c_str(), nullptr, nullptr, file.c_str(), function.line,
                          [&function]() -> testing::Test* { return new CppEqualsGlsl(function); });
  }
}

// ----- the harness itself

using parity_harness = Parity;

/// Reads the headers another way than generate.py does, so that what it overlooks is seen.
TEST(parity_coverage, every_shared_function_is_in_the_table) {
  std::set<std::string> headers;
  for (const Function& function : functions()) headers.insert(function.header);
  gl::ShaderText all(gl::read_from_folder(CANDELA_SOURCE_DIR "/src"));
  for (const std::string& header : headers) all.add_header(header);

  std::istringstream lines(all.text());
  std::size_t count = 0;
  bool both = true;  // false between #ifdef __cplusplus and its #endif
  for (std::string line; std::getline(lines, line);) {
    if (line == "#ifdef __cplusplus") both = false;
    if (line == "#endif") both = true;
    if (both && line.starts_with("SHADE_FN ")) ++count;
  }
  EXPECT_GT(count, 0U);
  EXPECT_GE(functions().size(), count);
}

TEST_F(parity_harness, an_altered_function_is_caught) {
  const std::vector<std::pair<std::string, Alteration>> mutants = {
      {"schlick_weight", {"m2 * m2 * m;", "m2 * m2;"}},
      {"fresnel_schlick", {"m2 * m2 * m;", "m2 * m2 * m * 1.01f;"}},  // through the function it calls
      {"cosine_sample", {"max(1.0f - r * r, 0.0f)", "max(1.0f - r, 0.0f)"}},
      {"ggx_d", {"alpha * alpha * t * t", "alpha * t * t"}},
      {"color_luminance", {"0.7152f", "0.7162f"}},
      {"sky_hits_ground", {"mu < 0.0f &&", "mu < -0.1f &&"}},                          // a bool, seldom
      {"tone_map", {"kToneReinhard = 3", "kToneReinhard = 4"}},                        // an int decides
      {"shading_model_thesis", {"m.blend = kBlendView", "m.blend = kBlendSum"}},       // an int is returned
      {"base_matter", {"s.is_mirror = s.alpha <", "s.is_mirror = s.alpha + 0.1f <"}},  // in place
      {"layers_chances", {"least = 0.05f", "least = 0.06f"}},
      {"table_ggx", {"index & 255", "index & 127"}},  // a texel of the tables
      // What is absent from a surface without lobes, and would be 0 by good luck.
      {"surface_albedo", {"if (SHADE_LOBES(s) != 0) return layers_albedo", "return layers_albedo"}},
  };
  for (const auto& [name, alteration] : mutants) {
    const Function* function = find_function(name);
    ASSERT_NE(function, nullptr) << name;
    EXPECT_FALSE(compare_languages(*function, alteration).holds) << "not caught: " << name;
  }
}

TEST_F(parity_harness, an_error_names_file_and_line) {
  const Function* function = find_function("surface_eval");
  ASSERT_NE(function, nullptr);
  try {
    evaluate_glsl(*function, draw_inputs(*function, 1), {"return m2 * m2 * m;", "return m2 * m2 * undeclared;"});
    FAIL() << "compiled";
  } catch (const Error& error) {
    EXPECT_NE(error.message().find("shade/fresnel.glsl.h:12: error: `undeclared'"), std::string::npos)
        << error.message();
  }
}

TEST_F(parity_harness, a_sampler_without_a_table_is_refused) {
  const Function* function = find_function("shade_sqr");
  ASSERT_NE(function, nullptr);
  const Alteration reads_a_texture = {
      "SHADE_FN float shade_sqr(float x) { return x * x; }",
      "uniform highp sampler3D unknown_table; float shade_sqr(float x) { return texture(unknown_table, vec3(x)).x; }"};
  EXPECT_THROW(evaluate_glsl(*function, draw_inputs(*function, 1), reads_a_texture), Error);
}

TEST_F(parity_harness, a_table_is_read_as_a_texture) {
  const Table table = {.uniform = "known_table",
                       .target = GL_TEXTURE_3D,
                       .width = 2,
                       .height = 1,
                       .depth = 3,
                       .channels = 2,
                       .texels = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}};
  const Function* function = find_function("shade_sqr");
  ASSERT_NE(function, nullptr);
  const Alteration reads_it = {"SHADE_FN float shade_sqr(float x) { return x * x; }",
                               "uniform highp sampler3D known_table; float shade_sqr(float x) { return "
                               "texelFetch(known_table, ivec3(1, 0, int(x)), 0).y; }"};
  EXPECT_EQ(evaluate_glsl(*function, {0.0f, 1.0f, 2.0f}, reads_it, {table}), (std::vector<float>{3.0f, 7.0f, 11.0f}));
}

/// More inputs than a vertex has attributes, more outputs than one transform feedback holds.
TEST_F(parity_harness, large_structs_arrive_whole) {
  constexpr int kSize = 90;
  Function reverse;
  reverse.name = "reverse";
  reverse.header = "shade/shim.glsl.h";
  reverse.input_size = kSize;
  reverse.output.size = kSize;
  reverse.glsl = "for (int i = 0; i < 90; ++i) y[i] = x[89 - i];\n";
  std::vector<float> inputs(static_cast<std::size_t>(kSize) * 1000);
  std::iota(inputs.begin(), inputs.end(), 0.0f);
  std::vector<float> expected = inputs;
  for (auto at = expected.begin(); at != expected.end(); at += kSize) std::reverse(at, at + kSize);
  EXPECT_EQ(evaluate_glsl(reverse, inputs), expected);
}

// ----- the report

int write_report(const std::string& path) {
  const std::unique_ptr<gl::Context> context = open_context();
  std::ofstream file(path);
  file.precision(2);
  file << "# How far C++ and GLSL are apart\n\nEvery function of `src/shade/`, " << kInputs
       << " random inputs each, C++ against GLSL ES 3.00 on " << gl::Context::renderer()
       << ".\nWritten by `candela_parity_tests --report docs/parity.md`.\n\n"
       << "The error is |C++ - GLSL| over the larger, for a vector over its largest component. Further apart than the "
          "limit are outliers.\n\n"
       << "| function | header | median | worst | limit | outliers |\n|---|---|---|---|---|---|\n";
  for (const Function& function : functions()) {
    const Comparison result = compare_languages(function);
    file << "| `" << function.name << "` | " << function.header << " | " << result.typical << " | " << result.worst
         << " | " << limits_of(function.name).relative << " | " << result.outliers << " |\n";
    if (result.outliers > 0) std::cout << function.name << ": " << result.evidence << "\n";
  }
  if (!file.flush()) throw Error("cannot write", path);
  return 0;
}

}  // namespace
}  // namespace candela::parity

// What the driver still holds when it is unloaded is not ours, and nameless by then. AddressSanitizer calls this.
// NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming): the name is the sanitizer's
extern "C" const char* __asan_default_options() { return "detect_leaks=0"; }

int main(int argc, char** argv) {
  try {
    if (argc == 3 && std::string(argv[1]) == "--report") return candela::parity::write_report(argv[2]);
    testing::InitGoogleTest(&argc, argv);
    candela::parity::register_functions();
    return RUN_ALL_TESTS();
  } catch (const candela::Error& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
