#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "io/gltf.h"

/// Tiny glTF files made in memory: tests take one that is right, change one thing, and load it.
namespace candela::io::test {

using nlohmann::json;

/// RFC 4648 §4.
inline std::string base64(std::span<const std::byte> bytes) {
  static constexpr char alphabet[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0);
    for (std::size_t k = 0; k < 4; ++k) out += i + k > bytes.size() ? '=' : alphabet[bits >> (18 - 6 * k) & 63];
  }
  return out;
}

inline std::span<const std::byte> as_bytes(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

struct Builder {
  json root = {{"asset", {{"version", "2.0"}}}};
  std::vector<std::byte> binary;

  /// A buffer view with these bytes, 4-aligned.
  template <class T>
  int view(const std::vector<T>& values, int stride = 0) {
    binary.resize((binary.size() + 3) / 4 * 4);
    json entry = {{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", values.size() * sizeof(T)}};
    if (stride > 0) entry["byteStride"] = stride;
    const auto bytes = std::as_bytes(std::span(values));
    binary.insert(binary.end(), bytes.begin(), bytes.end());
    root["bufferViews"].push_back(entry);
    return static_cast<int>(root["bufferViews"].size()) - 1;
  }

  template <class T>
  int accessor(const std::vector<T>& values, const char* type, int component_type, std::size_t components,
               bool normalized = false) {
    json entry = {{"bufferView", view(values)},
                  {"componentType", component_type},
                  {"count", values.size() / components},
                  {"type", type}};
    if (normalized) entry["normalized"] = true;
    return add_accessor(entry);
  }
  int floats(const std::vector<float>& values, const char* type, std::size_t components) {
    return accessor(values, type, 5126, components);
  }
  int vec2s(const std::vector<float>& values) { return floats(values, "VEC2", 2); }
  int vec3s(const std::vector<float>& values) { return floats(values, "VEC3", 3); }
  int vec4s(const std::vector<float>& values) { return floats(values, "VEC4", 4); }
  int indices(const std::vector<std::uint16_t>& values) { return accessor(values, "SCALAR", 5123, 1); }

  int add_accessor(const json& entry) {
    root["accessors"].push_back(entry);
    return static_cast<int>(root["accessors"].size()) - 1;
  }

  std::string gltf() const {
    json document = root;
    if (!binary.empty() && !document.contains("buffers")) {
      document["buffers"] = json::array(
          {{{"byteLength", binary.size()}, {"uri", "data:application/octet-stream;base64," + base64(binary)}}});
    }
    return document.dump();
  }

  std::vector<std::byte> glb() const {
    json document = root;
    if (!binary.empty() && !document.contains("buffers"))
      document["buffers"] = json::array({{{"byteLength", binary.size()}}});
    std::string text = document.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::vector<std::byte> chunk = binary;
    chunk.resize((chunk.size() + 3) / 4 * 4);
    std::vector<std::byte> out;
    const auto put = [&](std::uint32_t word) {
      const auto bytes = std::as_bytes(std::span(&word, 1));
      out.insert(out.end(), bytes.begin(), bytes.end());
    };
    const std::size_t chunk_size = chunk.empty() ? 0 : chunk.size() + 8;
    for (const std::size_t word : {std::size_t{0x46546C67}, std::size_t{2}, 20 + text.size() + chunk_size, text.size(),
                                   std::size_t{0x4E4F534A}}) {
      put(static_cast<std::uint32_t>(word));
    }
    const auto text_bytes = as_bytes(text);
    out.insert(out.end(), text_bytes.begin(), text_bytes.end());
    if (!chunk.empty()) {
      put(static_cast<std::uint32_t>(chunk.size()));
      put(0x004E4942);
      out.insert(out.end(), chunk.begin(), chunk.end());
    }
    return out;
  }
};

// Lists are json::array, because {x} of one element is a copy of x to clang and a list to g++.

/// One triangle in z = 0, counter-clockwise seen from +z, indexed, with normals and uvs, on one node.
inline Builder triangle() {
  Builder b;
  const int positions = b.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int normals = b.vec3s({0, 0, 1, 0, 0, 1, 0, 0, 1});
  const int uvs = b.vec2s({0, 1, 1, 1, 0, 0});
  const int indices = b.indices({0, 1, 2});
  json first = {{"attributes", {{"POSITION", positions}, {"NORMAL", normals}, {"TEXCOORD_0", uvs}}},
                {"indices", indices}};
  b.root["meshes"] = json::array({{{"primitives", json::array({std::move(first)})}}});
  b.root["nodes"] = json::array({{{"mesh", 0}}});
  b.root["scenes"] = json::array({{{"nodes", json::array({0})}}});
  b.root["scene"] = 0;
  return b;
}

inline json& primitive(Builder& b) { return b.root["meshes"][0]["primitives"][0]; }

/// A 1×1 RGBA PNG, and the material's texture 0 that shows it.
inline std::vector<std::byte> tiny_png() {
  static constexpr unsigned char bytes[] = {
      0x89, 0x50, 0x4E, 0x47, 0x0D, 0x0A, 0x1A, 0x0A, 0x00, 0x00, 0x00, 0x0D, 0x49, 0x48, 0x44, 0x52, 0x00, 0x00,
      0x00, 0x01, 0x00, 0x00, 0x00, 0x01, 0x08, 0x06, 0x00, 0x00, 0x00, 0x1F, 0x15, 0xC4, 0x89, 0x00, 0x00, 0x00,
      0x0D, 0x49, 0x44, 0x41, 0x54, 0x78, 0xDA, 0x63, 0x38, 0x91, 0x62, 0xD4, 0x00, 0x00, 0x05, 0x35, 0x01, 0xDF,
      0xAC, 0x3C, 0xF1, 0xCB, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4E, 0x44, 0xAE, 0x42, 0x60, 0x82};
  const auto view = std::as_bytes(std::span(bytes));
  return {view.begin(), view.end()};
}

inline void add_texture(Builder& b) {
  b.root["images"].push_back({{"bufferView", b.view(tiny_png())}, {"mimeType", "image/png"}});
  b.root["textures"].push_back({{"source", b.root["images"].size() - 1}});
}

/// The triangle with a material; tests fill `b.root["materials"][0]`.
inline Builder with_material(const json& material) {
  Builder b = triangle();
  b.root["materials"] = json::array({material});
  primitive(b)["material"] = 0;
  return b;
}

struct Loaded {
  Scene scene;
  std::vector<Diagnostic> warnings;
  std::vector<Diagnostic> notes = {};

  bool warned(const std::string& part) const { return contains(warnings, part); }
  bool noted(const std::string& part) const { return contains(notes, part); }

  static bool contains(const std::vector<Diagnostic>& list, const std::string& part) {
    for (const Diagnostic& d : list) {
      if (d.text().find(part) != std::string::npos) return true;
    }
    return false;
  }
};

inline Loaded load(const Builder& b, const LoadOptions& options = {}) {
  Diagnostics diagnostics;
  const auto bytes = b.glb();
  Scene scene = load_gltf(bytes, {}, diagnostics, options);
  return {std::move(scene), diagnostics.warnings(), diagnostics.notes()};
}

inline Loaded load_text(const std::string& text) {
  Diagnostics diagnostics;
  Scene scene = load_gltf(as_bytes(text), {}, diagnostics);
  return {std::move(scene), diagnostics.warnings(), diagnostics.notes()};
}

/// The error of a file that must not load, "loaded" when it does.
inline std::string error_of(std::span<const std::byte> bytes) {
  Diagnostics diagnostics;
  try {
    load_gltf(bytes, {}, diagnostics);
  } catch (const Error& error) {
    return error.what();
  }
  return "loaded";
}
inline std::string error_of(const Builder& b) { return error_of(b.glb()); }
inline std::string error_of(const std::string& text) { return error_of(as_bytes(text)); }

}  // namespace candela::io::test
