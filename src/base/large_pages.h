#pragma once

#include <cstddef>
#include <vector>

namespace candela {

/// Asks the system to back memory that nobody has touched yet with large pages, where it has them (Linux, unless they
/// are switched off). Reading at random waits less for translations of addresses; nothing else changes.
void advise_large_pages(void* data, std::size_t bytes);

/// resize() of an empty vector that is large and will be read at random.
template <class T>
void resize_large(std::vector<T>& values, std::size_t count) {
  values.reserve(count);
  advise_large_pages(values.data(), count * sizeof(T));
  values.resize(count);
}

}  // namespace candela
