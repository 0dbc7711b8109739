#pragma once

#include <string>
#include <vector>

namespace candela::parity {

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
  Value output;
  void (*call)(const float* x, float* y) = nullptr;
  std::string glsl;  ///< the same statements, from float x[] to float y[]
};

/// Every SHADE_FN of src/shade, in the order of headers and lines. Written by generate.py at build time.
const std::vector<Function>& functions();

/// The function of that name, or null.
const Function* find_function(const std::string& name);

/// The values without members, in order.
std::vector<Value> leaves(const Value& value);

}  // namespace candela::parity
