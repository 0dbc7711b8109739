#include "io/gltf_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <exception>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string_view>
#include <unordered_set>
#include <utility>

#include "base/file.h"
#include "base/parallel.h"
#include "io/meshopt.h"

namespace candela::io {

namespace fs = std::filesystem;

namespace {

constexpr std::uint32_t kGlbMagic = 0x46546C67;   // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;  // "JSON"
constexpr std::uint32_t kBinChunk = 0x004E4942;   // "BIN\0"
constexpr std::size_t kGlbHeader = 12;
constexpr std::size_t kChunkHeader = 8;
// A parsed document takes up to about thirty times its text.
constexpr std::size_t kLargestJson = std::size_t{512} << 20;
constexpr std::size_t kLongestQuotation = 200;  // characters of a parser message or URI that are worth repeating

std::uint32_t read_u32(std::span<const std::byte> bytes, std::size_t offset) {
  std::uint32_t value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

std::string shortened(std::string_view text) {
  if (text.size() <= kLongestQuotation) return std::string(text);
  return std::string(text.substr(0, kLongestQuotation)) + "…";
}

struct Container {
  std::string_view json;
  std::span<const std::byte> binary;
};

Container split_glb(std::span<const std::byte> bytes, const std::string& file, Diagnostics& diagnostics) {
  if (bytes.size() < kGlbHeader) throw Error("truncated GLB: the header is incomplete", file);
  const std::uint32_t version = read_u32(bytes, 4);
  if (version != 2) throw Error(fmt::format("GLB version {} is not supported (only 2)", version), file);
  const std::uint32_t length = read_u32(bytes, 8);
  if (length > bytes.size()) {
    throw Error(fmt::format("truncated GLB: {} bytes of {}", bytes.size(), length), file);
  }
  if (length < kGlbHeader) throw Error(fmt::format("GLB header gives a length of only {} bytes", length), file);
  if (length < bytes.size())
    diagnostics.warn(fmt::format("{} bytes after the end of the GLB", bytes.size() - length), file);
  bytes = bytes.first(length);

  Container result;
  std::size_t offset = kGlbHeader;
  for (int i = 0; offset < bytes.size(); ++i) {
    if (bytes.size() - offset < kChunkHeader)
      throw Error(fmt::format("GLB chunk {} has an incomplete header", i), file);
    const std::uint32_t chunk_length = read_u32(bytes, offset);
    const std::uint32_t type = read_u32(bytes, offset + 4);
    offset += kChunkHeader;
    if (chunk_length > bytes.size() - offset) {
      throw Error(fmt::format("GLB chunk {} claims {} bytes, {} are left", i, chunk_length, bytes.size() - offset),
                  file);
    }
    const auto chunk = bytes.subspan(offset, chunk_length);
    if (i == 0) {
      if (type != kJsonChunk) throw Error("the first GLB chunk is not JSON", file);
      result.json = {reinterpret_cast<const char*>(chunk.data()), chunk.size()};
    } else if (i == 1 && type == kBinChunk) {
      result.binary = chunk;
    }
    offset += chunk_length;
  }
  if (result.json.empty()) throw Error("the GLB has no JSON chunk", file);
  return result;
}

/// Looks for keys that an object has twice, in a pass of its own: a parse with a callback takes time that grows with
/// the square of an array's objects (nlohmann-json 3.11.2, 3.11.3).
class DuplicateKeys final : public nlohmann::json_sax<nlohmann::json> {
 public:
  DuplicateKeys(const std::string& file, Diagnostics& diagnostics) : file_(file), diagnostics_(diagnostics) {}

  bool null() override { return count_element(); }
  bool boolean(bool) override { return count_element(); }
  bool number_integer(number_integer_t) override { return count_element(); }
  bool number_unsigned(number_unsigned_t) override { return count_element(); }
  bool number_float(number_float_t, const string_t&) override { return count_element(); }
  bool string(string_t&) override { return count_element(); }
  bool binary(binary_t&) override { return count_element(); }
  bool start_object(std::size_t) override { return begin(false); }
  bool start_array(std::size_t) override { return begin(true); }
  bool end_object() override { return end(); }
  bool end_array() override { return end(); }
  bool key(string_t& key) override {
    add_key(key);
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::json::exception&) override { return false; }

 private:
  struct Level {
    bool is_array;
    std::unordered_set<std::string> keys;
    std::string key;  ///< the last
    std::size_t count;
  };
  static constexpr std::size_t kMostTold = 10;

  bool count_element() {
    if (!levels_.empty() && levels_.back().is_array) ++levels_.back().count;
    return true;
  }
  bool begin(bool is_array) {
    count_element();
    levels_.push_back({.is_array = is_array, .keys = {}, .key = {}, .count = 0});
    return true;
  }
  bool end() {
    levels_.pop_back();
    return true;
  }
  void add_key(const std::string& key) {
    levels_.back().key = key;
    if (levels_.back().keys.insert(key).second || ++told_ > kMostTold) return;
    std::string pointer;
    for (const Level& level : levels_) {
      pointer += '/' + (level.is_array ? std::to_string(level.count - 1) : escaped_token(level.key));
    }
    diagnostics_.warn(fmt::format("the key '{}' is given twice; the last one counts", shortened(key)),
                      file_ + '#' + pointer);
  }

  const std::string& file_;
  Diagnostics& diagnostics_;
  std::vector<Level> levels_;
  std::size_t told_ = 0;
};

bool looks_like_json(std::span<const std::byte> bytes) {
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  const auto first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && text[first] == '{';
}

/// nlohmann's text without its error number: "JSON error at line 3, column 5: …".
std::string json_message(const std::string& what) {
  const std::string_view marker = "parse error at ";
  const auto found = what.find(marker);
  if (found != std::string::npos)
    return "JSON error at " + shortened(std::string_view(what).substr(found + marker.size()));
  const auto bracket = what.find("] ");
  return "JSON error: " + shortened(std::string_view(what).substr(bracket == std::string::npos ? 0 : bracket + 2));
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

/// RFC 3986 §2.1. A '%' that starts no escape is kept: such names exist.
std::string percent_decoded(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size() && hex_digit(text[i + 1]) >= 0 && hex_digit(text[i + 2]) >= 0) {
      out += static_cast<char>(hex_digit(text[i + 1]) * 16 + hex_digit(text[i + 2]));
      i += 2;
    } else {
      out += text[i];
    }
  }
  return out;
}

constexpr std::array<std::int8_t, 256> base64_table() {
  std::array<std::int8_t, 256> table{};
  for (auto& entry : table) entry = -1;
  constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t i = 0; i < alphabet.size(); ++i) {
    table[static_cast<unsigned char>(alphabet[i])] = static_cast<std::int8_t>(i);
  }
  return table;
}

/// RFC 4648 §4; padding may be missing. Empty optional on a character outside the alphabet.
std::optional<std::vector<std::byte>> base64_decoded(std::string_view text) {
  static constexpr auto table = base64_table();
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  std::vector<std::byte> out;
  out.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const auto value = table[static_cast<unsigned char>(c)];
    if (value < 0) return std::nullopt;
    bits = bits << 6 | static_cast<std::uint32_t>(value);
    count += 6;
    if (count >= 8) {
      count -= 8;
      out.push_back(static_cast<std::byte>(bits >> count & 0xFF));
    }
  }
  return out;
}

std::vector<std::byte> read_data_uri(const JsonView& uri, std::string_view text) {
  const auto comma = text.find(',');
  if (comma == std::string_view::npos) throw uri.error("the data URI has no comma");
  const auto header = text.substr(0, comma);
  const auto payload = text.substr(comma + 1);
  if (header.ends_with(";base64")) {
    auto bytes = base64_decoded(payload);
    if (!bytes) throw uri.error("the data URI is not valid base64");
    return *std::move(bytes);
  }
  const std::string decoded = percent_decoded(payload);
  std::vector<std::byte> bytes(decoded.size());
  if (!decoded.empty()) std::memcpy(bytes.data(), decoded.data(), decoded.size());
  return bytes;
}

/// RFC 3986 §3.1: letters, digits, "+-." before a colon. One letter is a Windows drive, as unwelcome as a scheme.
bool has_scheme(std::string_view uri) {
  const auto end = uri.find_first_of(":/?#");
  return end != std::string_view::npos && end > 0 && uri[end] == ':';
}

/// RFC 8089, and the names of Windows' drives.
bool has_file_scheme(std::string_view uri) {
  constexpr std::string_view kScheme = "file:";
  const auto is_same = [](char a, char b) { return a == std::tolower(static_cast<unsigned char>(b)); };
  const bool is_file = uri.size() >= kScheme.size() && std::equal(kScheme.begin(), kScheme.end(), uri.begin(), is_same);
  return is_file || (uri.size() > 1 && uri[1] == ':');
}

/// The names of files that a URI may mean, likeliest first.
std::vector<std::string> relative_names(const std::string& uri) {
  if (uri.empty() || uri.find('\0') != std::string::npos || has_scheme(uri)) return {};
  std::string decoded = percent_decoded(uri);
  if (decoded.find('\0') != std::string::npos || fs::path(decoded).is_absolute()) return {};
  if (decoded == uri) return {uri};
  return {std::move(decoded), uri};
}

/// Where the packed bytes of a buffer view are.
std::optional<JsonView> meshopt_of(const JsonView& view) {
  const auto meshopt = view.extension("KHR_meshopt_compression");
  return meshopt ? meshopt : view.extension("EXT_meshopt_compression");
}

MeshoptLayout read_meshopt_layout(const JsonView& json) {
  using Mode = MeshoptLayout::Mode;
  using Filter = MeshoptLayout::Filter;
  const auto choose = [&json](const char* key, const std::string& name, const auto& choices) {
    for (const auto& [word, choice] : choices) {
      if (name == word) return choice;
    }
    throw json.error(fmt::format("the {} '{}' is unknown", key, shortened(name)));
  };
  constexpr std::array<std::pair<std::string_view, Mode>, 3> kModes{
      {{"ATTRIBUTES", Mode::attributes}, {"TRIANGLES", Mode::triangles}, {"INDICES", Mode::indices}}};
  constexpr std::array<std::pair<std::string_view, Filter>, 5> kFilters{{{"NONE", Filter::none},
                                                                         {"OCTAHEDRAL", Filter::octahedral},
                                                                         {"QUATERNION", Filter::quaternion},
                                                                         {"EXPONENTIAL", Filter::exponential},
                                                                         {"COLOR", Filter::color}}};
  MeshoptLayout layout;
  layout.mode = choose("mode", json.at("mode").string(), kModes);
  layout.filter = choose("filter", json.string_or("filter", "NONE"), kFilters);
  layout.count = static_cast<std::size_t>(json.at("count").whole());
  layout.stride = static_cast<std::size_t>(json.at("byteStride").whole());
  if (const std::string_view fault = meshopt_fault(layout); !fault.empty()) throw json.error(std::string(fault));
  return layout;
}

}  // namespace

GltfDocument::GltfDocument(std::span<const std::byte> bytes, std::string file, Diagnostics& diagnostics)
    : file_(std::move(file)) {
  Container container;
  is_glb_ = bytes.size() >= 4 && read_u32(bytes, 0) == kGlbMagic;
  if (is_glb_) {
    container = split_glb(bytes, file_, diagnostics);
  } else if (looks_like_json(bytes)) {
    container.json = {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  } else {
    throw Error("not a glTF file", file_);
  }
  // A chunk may be padded with zeros where the specification wants spaces.
  while (!container.json.empty() && container.json.back() == '\0') container.json.remove_suffix(1);
  if (container.json.size() > kLargestJson) throw Error("the JSON is larger than 512 MiB", file_);
  try {
    json_ = std::make_unique<nlohmann::json>(nlohmann::json::parse(container.json));
    DuplicateKeys duplicates(file_, diagnostics);
    nlohmann::json::sax_parse(container.json, &duplicates);
  } catch (const nlohmann::json::exception& exception) {
    throw Error(json_message(exception.what()), file_);
  }
  binary_chunk_ = container.binary;
}

GltfDocument::~GltfDocument() = default;

JsonView GltfDocument::root() const { return JsonView(*json_, file_); }

std::vector<fs::path> UriReader::files(const std::string& uri) const {
  std::vector<fs::path> result;
  for (const std::string& name : relative_names(uri)) {
    if (fs::path path = files_.path(name); !files_.empty() && !path.empty()) result.push_back(std::move(path));
  }
  return result;
}

std::string UriReader::fault(const std::string& uri) const {
  if (!files_.is_confined() || uri.starts_with("data:")) return {};
  const std::string decoded = percent_decoded(uri);
  // Anything else with a scheme is no file, and read by nobody.
  if (fs::path(decoded).is_absolute() || has_file_scheme(decoded)) {
    return fmt::format("'{}' is not a relative file name", shortened(decoded));
  }
  for (const std::string& name : relative_names(uri)) {
    try {
      files_.check(name);
    } catch (const Error& cause) {
      return fmt::format("'{}' {}", shortened(name), cause.message());
    }
  }
  return {};
}

bool UriReader::leaves_folder(const std::string& uri) const {
  const std::vector<std::string> names = relative_names(uri);
  return !files_.empty() && !names.empty() && files_.leaves_folder(names.front());
}

std::map<std::string, std::set<std::string>> GltfDocument::extension_places() const {
  std::map<std::string, std::set<std::string>> places;
  if (!json_->is_object()) return places;
  const auto add = [&](const nlohmann::json& owner, const std::string& place) {
    const auto extensions = owner.find("extensions");
    if (extensions == owner.end() || !extensions->is_object()) return;
    for (const auto& extension : extensions->items()) places[extension.key()].insert(place);
  };
  add(*json_, "extensions");
  for (const auto& member : json_->items()) {
    if (member.key() == "extras") continue;
    // No recursion: a file may be as deep as it likes.
    std::vector<const nlohmann::json*> stack{&member.value()};
    while (!stack.empty()) {
      const nlohmann::json& value = *stack.back();
      stack.pop_back();
      if (value.is_object()) add(value, member.key());
      if (!value.is_structured()) continue;
      for (const nlohmann::json& element : value) {
        if (element.is_structured()) stack.push_back(&element);
      }
    }
  }
  return places;
}

std::vector<std::byte> UriReader::read(const JsonView& uri) const {
  const std::string& text = uri.string();
  if (text.starts_with("data:")) return read_data_uri(uri, text);
  if (has_scheme(text)) throw uri.error(fmt::format("'{}' is not a relative file name", shortened(text)));
  const std::string decoded = percent_decoded(text);
  if (decoded.empty() || decoded.find('\0') != std::string::npos) throw uri.error("is not a file name");
  if (fs::path(decoded).is_absolute())
    throw uri.error(fmt::format("'{}' is not a relative file name", shortened(decoded)));
  if (files_.empty()) throw uri.error(fmt::format("external file '{}' cannot be read from here", shortened(decoded)));
  if (const std::string forbidden = fault(text); !forbidden.empty()) throw uri.error(forbidden);
  try {
    const bool literal = text != decoded && !files_.contains(decoded) && files_.contains(text);
    return files_.read(literal ? text : decoded);
  } catch (const Error& cause) {
    throw uri.error(fmt::format("'{}': {}", shortened(decoded), cause.message()));
  }
}

GltfBuffers::GltfBuffers(const GltfDocument& document, const UriReader& uris)
    : root_(document.root()), binary_chunk_(document.binary_chunk()), is_glb_(document.is_glb()), uris_(uris) {
  loaded_.resize(count_of(root_, "buffers"));
}

std::optional<JsonView> GltfBuffers::find_undefined(const JsonView& reference) const {
  const JsonView view = root_.at("bufferViews")[reference.index(count_of(root_, "bufferViews"), "buffer view")];
  if (meshopt_of(view)) return std::nullopt;
  const std::size_t index = view.at("buffer").index(loaded_.size(), "buffer");
  JsonView json = root_.at("buffers")[index];
  // A GLB whose first buffer has no uri has lost its binary chunk.
  if (json.find("uri") || (index == 0 && is_glb_)) return std::nullopt;
  return json;
}

std::span<const std::byte> GltfBuffers::buffer(std::size_t index) {
  const JsonView json = root_.at("buffers")[index];
  const std::uint64_t length = json.at("byteLength").whole();
  if (length == 0) throw json.at("byteLength").error("must be at least 1");
  std::span<const std::byte> bytes;
  if (const auto uri = json.find("uri")) {
    if (loaded_[index].empty()) {
      loaded_[index] = uris_.read(*uri);
      loaded_bytes_ += loaded_[index].size();
    }
    bytes = loaded_[index];
  } else if (index == 0 && !binary_chunk_.empty()) {
    bytes = binary_chunk_;
  } else {
    throw json.error("the buffer has neither a uri nor a GLB binary chunk");
  }
  if (length > bytes.size()) {
    throw json.at("byteLength")
        .error(fmt::format("the buffer claims {} bytes but only {} are there", length, bytes.size()));
  }
  return bytes.first(static_cast<std::size_t>(length));
}

/// What a buffer view, or the extension that says where its packed bytes are, names of a buffer.
std::span<const std::byte> GltfBuffers::slice(const JsonView& json) {
  const auto bytes = buffer(json.at("buffer").index(loaded_.size(), "buffer"));
  const std::uint64_t offset = json.whole_or("byteOffset", 0);
  const std::uint64_t length = json.at("byteLength").whole();
  // Both are below 2^53, so that the sum cannot overflow.
  if (offset + length > bytes.size()) {
    throw json.error(
        fmt::format("bytes {} to {} lie outside the buffer of {} bytes", offset, offset + length, bytes.size()));
  }
  if (length == 0) throw json.at("byteLength").error("must be at least 1");
  return bytes.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
}

/// A small file may hold a large mesh, but not without bound.
void GltfBuffers::charge(std::uint64_t bytes, const JsonView& cause) {
  constexpr std::uint64_t kMostUnpacked = std::uint64_t{4} << 30;
  unpacked_bytes_ += std::min(bytes, kMostUnpacked + 1);
  if (unpacked_bytes_ > kMostUnpacked) throw cause.error("the compressed geometry is larger than 4 GiB");
}

/// What is packed and how, for a view of `length` bytes.
std::pair<MeshoptLayout, std::span<const std::byte>> GltfBuffers::packed(const JsonView& extension,
                                                                         std::uint64_t length) {
  const MeshoptLayout layout = read_meshopt_layout(extension);
  if (layout.count > length / layout.stride || layout.count * layout.stride != length) {
    throw extension.error(fmt::format("{} elements of {} bytes are not the {} bytes of the buffer view", layout.count,
                                      layout.stride, length));
  }
  const std::span<const std::byte> bytes = slice(extension);
  if (bytes.size() < meshopt_least_bytes(layout)) throw extension.error("the data is too short for its count");
  return {layout, bytes};
}

bool GltfBuffers::is_packed(const JsonView& reference) {
  const JsonView view = root_.at("bufferViews")[reference.index(count_of(root_, "bufferViews"), "buffer view")];
  const auto meshopt = meshopt_of(view);
  if (meshopt) packed(*meshopt, view.at("byteLength").whole());
  return meshopt.has_value();
}

std::span<const std::byte> GltfBuffers::unpacked(std::size_t view, const JsonView& extension, std::uint64_t length) {
  const auto size = static_cast<std::size_t>(length);
  if (const auto found = unpacked_.find(view); found != unpacked_.end()) return {found->second.get(), size};
  const auto [layout, bytes_in] = packed(extension, length);
  charge(length, extension);
  auto bytes = std::make_unique_for_overwrite<std::byte[]>(size);
  try {
    decode_meshopt(bytes_in, layout, {bytes.get(), size});
  } catch (const Error& cause) {
    throw extension.error(cause.message());
  }
  loaded_bytes_ += length;
  return {unpacked_.emplace(view, std::move(bytes)).first->second.get(), size};
}

BufferView GltfBuffers::view(const JsonView& reference) {
  const std::size_t index = reference.index(count_of(root_, "bufferViews"), "buffer view");
  const JsonView json = root_.at("bufferViews")[index];
  const auto meshopt = meshopt_of(json);
  BufferView result;
  result.bytes = meshopt ? unpacked(index, *meshopt, json.at("byteLength").whole()) : slice(json);
  if (const auto stride = json.find("byteStride")) {
    // glTF 2.0 §5.11.4 allows 4 to 252; 0 is how old exporters write "tightly packed".
    const std::uint64_t value = stride->whole();
    if (value > 252) throw stride->error(fmt::format("must be at most 252, not {}", value));
    result.stride = static_cast<std::size_t>(value);
  }
  return result;
}

const DracoMesh& GltfBuffers::draco(const JsonView& reference) {
  decode_draco({reference});
  return draco_.at(reference.index(count_of(root_, "bufferViews"), "buffer view"));
}

DracoMesh::Claim GltfBuffers::claim_draco(const JsonView& reference) {
  const std::span<const std::byte> packed = view(reference).bytes;
  try {
    return DracoMesh::claim(packed);
  } catch (const Error& cause) {
    throw reference.error(cause.message());
  }
}

void GltfBuffers::decode_draco(const std::vector<JsonView>& references) {
  struct Work {
    std::size_t view;
    JsonView place;
    std::span<const std::byte> packed;
    std::optional<DracoMesh> mesh = {};
    std::exception_ptr error = {};
  };
  std::vector<Work> works;
  std::set<std::size_t> seen;
  for (const JsonView& reference : references) {
    const std::size_t index = reference.index(count_of(root_, "bufferViews"), "buffer view");
    if (draco_.contains(index) || !seen.insert(index).second) continue;
    // Triangles, and what most vertices have.
    constexpr std::uint64_t kFaceBytes = 12, kVertexBytes = 48;
    const DracoMesh::Claim claim = claim_draco(reference);
    charge(claim.faces * kFaceBytes + claim.vertices * kVertexBytes, reference);
    works.push_back({index, reference, view(reference).bytes});
  }
  parallel_for(0, works.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const double start = thread_seconds();
      try {
        draco_budget_.require();
        works[i].mesh.emplace(works[i].packed);
      } catch (const Error& cause) {
        works[i].error = std::make_exception_ptr(works[i].place.error(cause.message()));
      } catch (...) {
        works[i].error = std::current_exception();
      }
      draco_budget_.charge(works[i].packed.size(), thread_seconds() - start);
    }
  });
  for (Work& work : works) {
    if (work.error) std::rethrow_exception(work.error);
    loaded_bytes_ += work.mesh->face_count() * 12 + work.mesh->vertex_count() * 32;
    draco_.emplace(work.view, *std::move(work.mesh));
  }
}

}  // namespace candela::io
