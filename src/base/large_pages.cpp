#include "base/large_pages.h"

#include <sys/mman.h>

#include <cstdint>

namespace candela {

void advise_large_pages([[maybe_unused]] void* data, [[maybe_unused]] std::size_t bytes) {
#ifdef MADV_HUGEPAGE
  // Only whole pages within, so that nothing outside grows. Where it is refused, small ones serve.
  constexpr std::uintptr_t kPage = std::uintptr_t{2} << 20;
  const auto begin = reinterpret_cast<std::uintptr_t>(data);
  const std::uintptr_t first = (begin + kPage - 1) / kPage * kPage, last = (begin + bytes) / kPage * kPage;
  if (first >= last) return;
  // NOLINTNEXTLINE(performance-no-int-to-ptr): rounded up from a pointer
  madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
#endif
}

}  // namespace candela
