#include "parity/function.h"

#include <algorithm>

namespace candela::parity {

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
