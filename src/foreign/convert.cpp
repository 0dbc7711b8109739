#include "foreign/convert.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/parts.h"
#include "foreign/mixtures.h"
#ifdef CANDELA_WITH_ASSIMP
#include "foreign/assimp_reader.h"
#include "foreign/guard.h"
#include "foreign/sandbox.h"
#endif

namespace candela::foreign {

using Json = nlohmann::json;

namespace {

[[maybe_unused]] void append(std::vector<std::byte>& out, const void* data, std::size_t count) {
  const auto* bytes = static_cast<const std::byte*>(data);
  out.insert(out.end(), bytes, bytes + count);
}

/// glTF 2.0 §4.4: header, JSON chunk, binary chunk.
[[maybe_unused]] std::vector<std::byte> glb_of(Draft& draft, const std::string& where) {
  constexpr std::uint32_t kVersion = 2, kHeader = 12, kChunk = 8;
  if (!draft.buffer.empty()) draft.gltf["buffers"] = {{{"byteLength", draft.buffer.size()}}};
  std::string text = draft.gltf.dump(-1, ' ', false, Json::error_handler_t::replace);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  draft.buffer.resize((draft.buffer.size() + 3) / 4 * 4);
  const std::uint64_t total = kHeader + 2 * kChunk + text.size() + draft.buffer.size();
  if (total > std::numeric_limits<std::uint32_t>::max()) throw Error("it holds more than 4 GiB", where);
  std::vector<std::byte> glb;
  glb.reserve(total);
  append(glb, "glTF", 4);
  for (const std::uint32_t value : {kVersion, static_cast<std::uint32_t>(total)}) append(glb, &value, 4);
  const auto chunk = [&](const char* type, const void* data, std::size_t size) {
    const auto length = static_cast<std::uint32_t>(size);
    append(glb, &length, 4);
    append(glb, type, 4);
    append(glb, data, size);
  };
  chunk("JSON", text.data(), text.size());
  // NOLINTNEXTLINE(bugprone-string-literal-with-embedded-nul): the name of the chunk has one
  chunk("BIN\0", draft.buffer.data(), draft.buffer.size());
  return glb;
}

}  // namespace

#ifdef CANDELA_WITH_ASSIMP

bool is_available() { return true; }

Converted convert(std::span<const std::byte> bytes, Format format, const Surroundings& around, const std::string& stem,
                  const std::string& where, Diagnostics& diagnostics, const Measures& measures) {
  require_silence(format, measures, where);
  // A text takes some fifty times its size in Assimp's lists; beyond it something is wrong with the file.
  // Damaged ones, a PLY of a hundred bytes among them, keep it busy without end; whole ones take a second for some MB.
  constexpr std::uint64_t kMemory = std::uint64_t{2} << 30, kMemoryPerByte = 100;
  constexpr unsigned kSeconds = 10, kBytesPerSecond = 100'000;
  const SandboxLimits limits{kMemory + kMemoryPerByte * bytes.size(),
                             kSeconds + static_cast<unsigned>(bytes.size() / kBytesPerSecond)};
  check_claims(bytes, format, limits.memory_bytes, where);
  Draft draft =
      unpack(run_apart([&] { return pack(read_with_assimp(bytes, format, measures, around, stem)); }, limits, where));
  mix(draft, around);
  for (const Diagnostic& told : draft.diagnostics.warnings()) {
    diagnostics.warn(told.message, told.where.empty() ? where : told.where);
  }
  for (const Diagnostic& told : draft.diagnostics.notes()) {
    diagnostics.note(told.message, told.where.empty() ? where : told.where);
  }
  for (const Json& source : draft.sources) {
    if (source.contains("name")) draft.read.push_back(source["name"]);
  }
  return {glb_of(draft, where), std::move(draft.read)};
}

#else

bool is_available() { return false; }

Converted convert(std::span<const std::byte>, Format format, const Surroundings&, const std::string&,
                  const std::string& where, Diagnostics&, const Measures&) {
  throw Error(
      fmt::format("{} is not read: {}", format_name(format), absent_part("Assimp", "CANDELA_WITH_ASSIMP").message()),
      where);
}

#endif

}  // namespace candela::foreign
