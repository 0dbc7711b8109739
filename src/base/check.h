#pragma once

#include <cstdlib>
#include <iostream>

namespace candela::detail {

[[noreturn]] inline void check_failed(const char* file, int line, const char* expression) {
  std::cerr << file << ':' << line << ": check failed: " << expression << std::endl;
  std::abort();
}

template <class A, class B>
void check_eq(const A& a, const B& b, const char* file, int line, const char* expression) {
  if (a == b) return;
  std::cerr << file << ':' << line << ": check failed: " << expression << " (" << a << " vs " << b << ')' << std::endl;
  std::abort();
}

}  // namespace candela::detail

/// A broken invariant is a bug of ours, never of the input: print it and abort.
#define CANDELA_CHECK(condition) \
  ((condition) ? void(0) : ::candela::detail::check_failed(__FILE__, __LINE__, #condition))
#define CANDELA_CHECK_EQ(a, b) ::candela::detail::check_eq((a), (b), __FILE__, __LINE__, #a " == " #b)
