#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace candela {

/// Bytes that this process can still take before the system refuses or kills it: memory that is free or can be had
/// back, and swap; less where a control group or a limit on the address space (ulimit -v) leaves less. Empty where the
/// system does not say.
std::optional<std::uint64_t> available_memory();

/// The same without the limit on the address space, from what stands in `proc` and `cgroup`: /proc and /sys/fs/cgroup,
/// version 1 or 2. The group's own limit counts and that of every group around it; its file cache is no use of memory.
std::optional<std::uint64_t> available_memory(const std::filesystem::path& proc, const std::filesystem::path& cgroup);

/// Throws Error(…, where) when `what` needs more bytes than there are. Nothing is refused where `available` is unknown.
void require_memory(std::uint64_t needed, std::optional<std::uint64_t> available, const std::string& what,
                    const std::string& where);

}  // namespace candela
