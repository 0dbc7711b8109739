#include "parity/function.h"

#include <algorithm>

namespace candela::parity {
namespace {

/// The value at `flat`, which is moved behind its last member.
Value read_value(const FlatValue*& flat) {
  Value value{flat->name, flat->type, flat->owner, flat->offset, flat->size, {}};
  const int members = flat->members;
  ++flat;
  for (int i = 0; i < members; ++i) value.members.push_back(read_value(flat));
  return value;
}

Function read_function(const FlatFunction& flat) {
  Function function;
  function.name = flat.name;
  function.header = flat.header;
  function.line = flat.line;
  const FlatValue* values = flat.values;
  for (int i = 0; i < flat.inputs; ++i) function.inputs.push_back(read_value(values));
  function.input_size = flat.input_size;
  function.output = read_value(values);
  function.call = flat.call;
  function.glsl = flat.glsl;
  return function;
}

}  // namespace

const std::vector<Function>& functions() {
  static const std::vector<Function> kTable = [] {
    std::vector<Function> table;
    table.reserve(static_cast<std::size_t>(kFlatFunctionCount));
    for (int i = 0; i < kFlatFunctionCount; ++i) table.push_back(read_function(kFlatFunctions[i]));
    return table;
  }();
  return kTable;
}

const Function* find_function(const std::string& name) {
  const auto& table = functions();
  const auto found = std::find_if(table.begin(), table.end(), [&](const Function& f) { return f.name == name; });
  return found == table.end() ? nullptr : &*found;
}

std::vector<Value> leaves(const Value& value) {
  if (value.members.empty()) return {value};
  std::vector<Value> all;
  for (const Value& member : value.members) {
    const std::vector<Value> inner = leaves(member);
    all.insert(all.end(), inner.begin(), inner.end());
  }
  return all;
}

}  // namespace candela::parity
