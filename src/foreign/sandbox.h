#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace candela::foreign {

struct SandboxLimits {
  std::uint64_t memory_bytes = 0;  ///< beyond what the process has; not enforced under sanitizers, which need it all
  unsigned cpu_seconds = 0;
};

/// What `work` writes, made in a process of its own: a library that reads strangers' files may crash, hang or ask for
/// all memory there, and the caller gets an Error at `where`. `work` must use neither threads nor locks that another
/// thread may hold; what it throws is an Error too. A stop of the caller's StopScope ends it.
std::vector<std::byte> run_apart(const std::function<std::vector<std::byte>()>& work, const SandboxLimits& limits,
                                 const std::string& where);

}  // namespace candela::foreign
