#include "foreign/draft.h"

#include <algorithm>
#include <cstring>

#include "base/error.h"

namespace candela::foreign {

using Json = nlohmann::json;

std::size_t Draft::add_view(std::span<const std::byte> bytes) {
  constexpr std::size_t kAlignment = 4;
  buffer.resize((buffer.size() + kAlignment - 1) / kAlignment * kAlignment);
  const std::size_t offset = buffer.size();
  buffer.insert(buffer.end(), bytes.begin(), bytes.end());
  return add("bufferViews", {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes.size()}});
}

std::size_t Draft::add_times(std::span<const float> v) {
  const std::size_t accessor = add_floats(v);
  gltf["accessors"][accessor]["min"] = {v.front()};
  gltf["accessors"][accessor]["max"] = {v.back()};
  return accessor;
}

std::size_t Draft::add(const char* list, Json value) {
  gltf[list].push_back(std::move(value));
  return gltf[list].size() - 1;
}

void Draft::use_extension(const std::string& name) {
  Json& used = gltf["extensionsUsed"];
  if (std::find(used.begin(), used.end(), name) == used.end()) used.push_back(name);
}

namespace {

Json texts(const std::vector<Diagnostic>& list) {
  Json result = Json::array();
  for (const Diagnostic& one : list) result.push_back({one.message, one.where});
  return result;
}

}  // namespace

std::vector<std::byte> pack(const Draft& draft) {
  const Json head{{"gltf", draft.gltf},
                  {"sources", draft.sources},
                  {"mixtures", draft.mixtures},
                  {"read", draft.read},
                  {"warnings", texts(draft.diagnostics.warnings())},
                  {"notes", texts(draft.diagnostics.notes())}};
  // What a file says in another encoding than UTF-8 must not end the reading.
  const std::string text = head.dump(-1, ' ', false, Json::error_handler_t::replace);
  const std::uint64_t length = text.size();
  std::vector<std::byte> bytes(sizeof length + text.size() + draft.buffer.size());
  std::memcpy(bytes.data(), &length, sizeof length);
  std::memcpy(bytes.data() + sizeof length, text.data(), text.size());
  std::copy(draft.buffer.begin(), draft.buffer.end(), bytes.end() - static_cast<std::ptrdiff_t>(draft.buffer.size()));
  return bytes;
}

Draft unpack(std::span<const std::byte> bytes) {
  std::uint64_t length = 0;
  if (bytes.size() < sizeof length) throw Error("damaged: its reader said nothing");
  std::memcpy(&length, bytes.data(), sizeof length);
  bytes = bytes.subspan(sizeof length);
  if (length > bytes.size()) throw Error("damaged: its reader was cut off");
  const char* text = reinterpret_cast<const char*>(bytes.data());
  const Json head = Json::parse(text, text + length);
  Draft draft;
  draft.gltf = head.at("gltf");
  draft.sources = head.at("sources");
  draft.mixtures = head.at("mixtures");
  draft.read = head.at("read").get<std::vector<std::string>>();
  for (const Json& told : head.at("warnings")) draft.diagnostics.warn(told[0], told[1]);
  for (const Json& told : head.at("notes")) draft.diagnostics.note(told[0], told[1]);
  draft.buffer.assign(bytes.begin() + static_cast<std::ptrdiff_t>(length), bytes.end());
  return draft;
}

std::string find_reference(const Surroundings& around, std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  while (name.starts_with("./")) name.erase(0, 2);
  for (const char* scheme : {"file:///", "file://"}) {
    if (name.starts_with(scheme)) name.erase(0, std::strlen(scheme) - 1);
  }
  const bool is_absolute = name.starts_with('/') || (name.size() > 1 && name[1] == ':');
  if (!is_absolute && around.has(name)) return name;
  const std::string last = name.substr(name.find_last_of('/') + 1);
  for (const std::string& candidate : {last, "textures/" + last, "Textures/" + last}) {
    if (!last.empty() && around.has(candidate)) return candidate;
  }
  return is_absolute ? last : name;
}

std::string uri_of(const std::string& name) {
  constexpr char kHex[] = "0123456789ABCDEF";
  std::string uri;
  for (const char c : name) {
    const auto code = static_cast<unsigned char>(c);
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                          std::strchr("-._~/", c) != nullptr;
    if (is_plain && c != '\0') {
      uri += c;
    } else {
      uri += {'%', kHex[code >> 4], kHex[code & 15]};
    }
  }
  return uri;
}

}  // namespace candela::foreign
