#include "base/memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "base/error.h"

namespace candela {

namespace fs = std::filesystem;

namespace {

using Bytes = std::optional<std::uint64_t>;

/// The number at the start of a file. A file that is absent or says "max" gives none.
Bytes number_in(const fs::path& path) {
  std::ifstream stream(path);
  std::uint64_t value = 0;
  return stream >> value ? Bytes(value) : std::nullopt;
}

/// The number after `name` in a file of lines "name number …".
Bytes number_after(const fs::path& path, const std::string& name) {
  std::ifstream stream(path);
  for (std::string line; std::getline(stream, line);) {
    if (!line.starts_with(name + ' ')) continue;
    std::istringstream rest(line.substr(name.size()));
    std::uint64_t value = 0;
    if (rest >> value) return value;
  }
  return std::nullopt;
}

Bytes smaller(Bytes a, Bytes b) { return a && b ? std::min(*a, *b) : a ? a : b; }
std::uint64_t difference(std::uint64_t a, std::uint64_t b) { return a > b ? a - b : 0; }

struct GroupFiles {
  const char* limit;
  const char* usage;
  const char* file_cache;  ///< in memory.stat; given back when memory is short
};
constexpr GroupFiles kVersion1{"memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"};
constexpr GroupFiles kVersion2{"memory.max", "memory.current", "inactive_file"};

/// What the group at `path` below `root` and those around it leave. A container may not see its own group by that path:
/// then those that it does see count, at least the root.
Bytes left_in_groups(const fs::path& root, fs::path path, const GroupFiles& files) {
  Bytes left;
  for (path = path.relative_path();; path = path.parent_path()) {
    const fs::path folder = root / path;
    const Bytes limit = number_in(folder / files.limit);
    const Bytes usage = number_in(folder / files.usage);
    if (limit && usage) {
      const std::uint64_t cache = number_after(folder / "memory.stat", files.file_cache).value_or(0);
      left = smaller(left, difference(*limit, difference(*usage, cache)));
    }
    if (path.empty()) return left;
  }
}

std::string gibibytes(std::uint64_t bytes) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.2f GiB", static_cast<double>(bytes) * 0x1p-30);
  return text;
}

/// What `ulimit -v` leaves.
Bytes left_in_address_space() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return std::nullopt;
  const Bytes pages = number_in("/proc/self/statm");
  if (!pages) return std::nullopt;
  return difference(limit.rlim_cur, *pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)));
}

}  // namespace

std::optional<std::uint64_t> available_memory(const fs::path& proc, const fs::path& cgroup) {
  constexpr std::uint64_t kKibi = 1024;
  Bytes available;
  if (const Bytes memory = number_after(proc / "meminfo", "MemAvailable:"))
    available = (*memory + number_after(proc / "meminfo", "SwapFree:").value_or(0)) * kKibi;
  // A line is "number:controllers:path"; version 2 has no controllers.
  std::ifstream groups(proc / "self" / "cgroup");
  for (std::string line; std::getline(groups, line);) {
    const std::size_t first = line.find(':');
    const std::size_t second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    const fs::path path = line.substr(second + 1);
    if (controllers == ",,") available = smaller(available, left_in_groups(cgroup, path, kVersion2));
    if (controllers.find(",memory,") != std::string::npos)
      available = smaller(available, left_in_groups(cgroup / "memory", path, kVersion1));
  }
  return available;
}

std::optional<std::uint64_t> available_memory() {
  return smaller(available_memory("/proc", "/sys/fs/cgroup"), left_in_address_space());
}

void require_memory(std::uint64_t needed, std::optional<std::uint64_t> available, const std::string& what,
                    const std::string& where) {
  if (!available || needed <= *available) return;
  throw Error(what + " needs about " + gibibytes(needed) + " of memory, " + gibibytes(*available) + " are available",
              where);
}

}  // namespace candela
