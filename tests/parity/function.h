#pragma once

#include <string>
#include <vector>

namespace candela::parity {

/// What a float of a struct reads as where it holds nothing (members of Surface whose lobe is absent): a number that
/// shows in whatever reads it nonetheless.
constexpr float kAbsent = -3.0e38f;

/// A parameter, a member or a result, flattened: `size` floats from `offset` of the function's inputs or outputs. bool
/// is 0 or 1, int its value, mat3 column by column.
struct Value {
  std::string name;   ///< empty for a result
  std::string type;   ///< as GLSL spells it
  std::string owner;  ///< the function or struct that names it
  int offset = 0;
  int size = 0;
  std::vector<Value> members;  ///< of a struct
};

/// A shared function that both languages call over plain floats. The name is unique; overloads carry their types.
struct Function {
  std::string name;
  std::string header;  ///< "shade/x.glsl.h"
  int line = 0;
  std::vector<Value> inputs;
  int input_size = 0;
  Value output;  ///< the result, what is filled in place, or a nameless struct of both
  void (*call)(const float* x, float* y) = nullptr;
  std::string glsl;  ///< the same statements, from float x[] to float y[]
};

/// What generate.py writes at build time: a value before its members, the inputs before the output. Plain data,
/// because thousands of constructors in one function take the compiler minutes.
struct FlatValue {
  const char* name;
  const char* type;
  const char* owner;
  int offset;
  int size;
  int members;
};

struct FlatFunction {
  const char* name;
  const char* header;
  int line;
  int inputs;
  int input_size;
  const FlatValue* values;
  void (*call)(const float* x, float* y);
  const char* glsl;
};

extern const FlatFunction kFlatFunctions[];
extern const int kFlatFunctionCount;

/// Every SHADE_FN of src/shade, in the order of headers and lines.
const std::vector<Function>& functions();

/// The function of that name, or null.
const Function* find_function(const std::string& name);

/// The values without members, in order.
std::vector<Value> leaves(const Value& value);

}  // namespace candela::parity
