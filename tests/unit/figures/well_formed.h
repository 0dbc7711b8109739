#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace candela::test {

/// Whether every element of an XML text ends, in the right order, and every & begins an entity.
inline testing::AssertionResult is_well_formed(const std::string& xml) {
  std::vector<std::string> open;
  bool had_root = false;
  for (std::size_t at = 0; at < xml.size();) {
    if (xml[at] == '&') {
      const std::size_t end = xml.find(';', at);
      if (end == std::string::npos || end - at > 6) return testing::AssertionFailure() << "a bare & at " << at;
      at = end + 1;
    } else if (xml[at] != '<') {
      ++at;
    } else {
      const std::size_t end = xml.find('>', at);
      if (end == std::string::npos) return testing::AssertionFailure() << "a tag without its end at " << at;
      const std::string tag = xml.substr(at + 1, end - at - 1);
      if (tag.find('<') != std::string::npos) return testing::AssertionFailure() << "a bare < in " << tag;
      const std::string name = tag.substr(tag[0] == '/' ? 1 : 0, tag.find_first_of(" /", 1) - (tag[0] == '/' ? 1 : 0));
      if (tag[0] == '/') {
        if (open.empty() || open.back() != name) return testing::AssertionFailure() << "</" << name << "> out of order";
        open.pop_back();
      } else if (tag.back() != '/') {
        if (open.empty() && had_root) return testing::AssertionFailure() << "a second root, " << name;
        open.push_back(name);
        had_root = true;
      }
      at = end + 1;
    }
  }
  if (!open.empty()) return testing::AssertionFailure() << "<" << open.back() << "> does not end";
  return had_root ? testing::AssertionSuccess() : testing::AssertionFailure() << "no element";
}

inline std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++count;
  return count;
}

}  // namespace candela::test
