#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "unit/io/draco_files.h"
#include "unit/io/gltf_builder.h"
#include "unit/io/meshopt_files.h"

// LoadOptions::unpack_geometry: what is packed is counted and measured by its accessors, as far as they can say it.

namespace candela::io::test {
namespace {

using ::testing::HasSubstr;

constexpr int kTriangles = 16, kVertices = kTriangles + 2;

struct Counted {
  std::size_t vertices = 0, triangles = 0;
  Box3 bounds;
};

Counted counted(const Builder& b, bool unpack_geometry) {
  LoadOptions options;
  options.unpack_geometry = unpack_geometry;
  Diagnostics diagnostics;
  const Scene scene = load_gltf(as_bytes(b.gltf()), {}, diagnostics, options);
  Counted result;
  for (const Mesh& mesh : scene.meshes) {
    for (const Primitive& p : mesh.primitives) {
      result.vertices += p.positions.size();
      result.triangles += p.triangles.size();
    }
  }
  result.bounds = world_bounds(scene);
  return result;
}

/// A strip of Draco or of meshopt, so long as it is not asked for: half of each stream is missing or wrong.
Builder damaged_draco() {
  Builder b = triangle();
  std::vector<std::byte> stream = draco_strip(kTriangles, 5, true);
  std::fill(stream.begin() + static_cast<std::ptrdiff_t>(stream.size() / 2), stream.end(), std::byte{0xFF});
  stream.resize(stream.size() - 20);
  const int view = b.view(stream);
  const auto placeholder = [&](const char* type, int component_type, int count) {
    return b.add_accessor({{"componentType", component_type}, {"count", count}, {"type", type}});
  };
  const int positions = placeholder("VEC3", 5126, kVertices), uvs = placeholder("VEC2", 5126, kVertices);
  const int normals = placeholder("VEC3", 5126, kVertices), indices = placeholder("SCALAR", 5123, 3 * kTriangles);
  b.root["accessors"][static_cast<std::size_t>(positions)].update({{"min", {0, -1, 0}}, {"max", {8, 1, 0.5}}});
  primitive(b) = {{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uvs}, {"NORMAL", normals}}},
                  {"indices", indices},
                  {"extensions",
                   {{"KHR_draco_mesh_compression",
                     {{"bufferView", view}, {"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}, {"NORMAL", 2}}}}}}}};
  b.root["extensionsUsed"] = b.root["extensionsRequired"] = json::array({"KHR_draco_mesh_compression"});
  return b;
}

/// The same strip as normalised words.
Builder meshopt_strip(bool is_damaged) {
  std::vector<std::int16_t> positions, normals;
  for (int i = 0; i < kVertices; ++i) {
    const auto word = [](int k) { return static_cast<std::int16_t>(k); };
    positions.insert(positions.end(), {word(4000 * (i / 2)), word(32767 * (i % 2)), word(-20 * i), word(0)});
    normals.insert(normals.end(), {word(0), word(0), word(32767), word(0)});
  }
  std::vector<std::uint16_t> corners;
  for (int i = 0; i < kTriangles; ++i) {
    for (const int k : {i, i + 1 + i % 2, i + 2 - i % 2}) corners.push_back(static_cast<std::uint16_t>(k));
  }
  Builder b = triangle();
  const auto packed = [&](std::vector<std::byte> stream, int count, int stride, const char* mode) {
    if (is_damaged) stream[0] = std::byte{0};
    const int view = b.view(stream);
    json& entry = b.root["bufferViews"][static_cast<std::size_t>(view)];
    const json inner = {{"buffer", 0},
                        {"byteOffset", entry["byteOffset"]},
                        {"byteLength", stream.size()},
                        {"byteStride", stride},
                        {"count", count},
                        {"mode", mode}};
    entry["byteLength"] = count * stride;
    if (stride > 2) entry["byteStride"] = stride;
    entry["extensions"] = {{"EXT_meshopt_compression", inner}};
    return view;
  };
  const auto words = [&](const std::vector<std::int16_t>& values) {
    const int view = packed(packed_plainly(std::as_bytes(std::span(values)), 8), kVertices, 8, "ATTRIBUTES");
    return b.add_accessor({{"bufferView", view},
                           {"componentType", 5122},
                           {"normalized", true},
                           {"count", kVertices},
                           {"type", "VEC3"},
                           {"min", {0, 0, -20 * (kVertices - 1)}},
                           {"max", {4000 * (kVertices / 2 - 1), 32767, 0}}});
  };
  const int position = words(positions), normal = words(normals);
  const int view = packed(packed_indices(corners, [](std::size_t) { return 0u; }), 3 * kTriangles, 2, "INDICES");
  const int index =
      b.add_accessor({{"bufferView", view}, {"componentType", 5123}, {"count", 3 * kTriangles}, {"type", "SCALAR"}});
  primitive(b) = {{"attributes", {{"POSITION", position}, {"NORMAL", normal}}}, {"indices", index}};
  b.root["extensionsUsed"] = {"EXT_meshopt_compression", "KHR_mesh_quantization"};
  return b;
}

json& position_accessor(Builder& b) {
  return b.root["accessors"][primitive(b)["attributes"]["POSITION"].get<std::size_t>()];
}

TEST(unit_io_gltf_outline, draco_is_counted_by_its_accessors_without_being_unpacked) {
  const Builder b = damaged_draco();
  EXPECT_THROW(counted(b, true), Error) << "to be seen, it has to be unpacked";
  const Counted found = counted(b, false);
  EXPECT_EQ(found.vertices, std::size_t{kVertices});
  EXPECT_EQ(found.triangles, std::size_t{kTriangles});
  EXPECT_EQ(found.bounds.lower, vec3(0, -1, 0));
  EXPECT_EQ(found.bounds.upper, vec3(8, 1, 0.5f));
}

TEST(unit_io_gltf_outline, meshopt_counts_and_measures_as_much_packed_as_unpacked) {
  const Counted whole = counted(meshopt_strip(false), true);
  EXPECT_THROW(counted(meshopt_strip(true), true), Error);
  const Counted found = counted(meshopt_strip(true), false);
  EXPECT_EQ(found.vertices, whole.vertices);
  EXPECT_EQ(found.triangles, whole.triangles);
  EXPECT_EQ(found.bounds.lower, whole.bounds.lower);
  EXPECT_EQ(found.bounds.upper, whole.bounds.upper);
}

TEST(unit_io_gltf_outline, a_box_turned_by_right_angles_stays_one) {
  Builder b = damaged_draco();
  b.root["nodes"][0].update({{"rotation", {0, 0, 0.70710678, 0.70710678}}, {"scale", {2, 2, 2}}});
  const Counted found = counted(b, false);
  EXPECT_LT(distance(found.bounds.lower, vec3(-2, 0, 0)), 1e-5f);
  EXPECT_LT(distance(found.bounds.upper, vec3(2, 16, 1)), 1e-5f);
}

TEST(unit_io_gltf_outline, without_normals_every_triangle_has_its_own_vertices) {
  Builder b = damaged_draco();
  primitive(b)["attributes"].erase("NORMAL");
  EXPECT_EQ(counted(b, false).vertices, std::size_t{3} * kTriangles);
}

TEST(unit_io_gltf_outline, what_the_accessors_cannot_say_is_unpacked) {
  const std::vector<std::pair<std::string, std::function<void(Builder&)>>> changes = {
      {"no bounds", [](Builder& b) { position_accessor(b).erase("max"); }},
      {"bounds of no box",
       [](Builder& b) {
         position_accessor(b)["max"] = {-1, 1, 0.5};
       }},
      {"bounds that are no numbers", [](Builder& b) { position_accessor(b)["min"] = "none"; }},
      {"a count that differs", [](Builder& b) { position_accessor(b)["count"] = kVertices + 1; }},
      {"another count of triangles than the stream's",
       [](Builder& b) {
         b.root["accessors"][primitive(b)["indices"].get<std::size_t>()]["count"] = 3 * (kTriangles - 1);
       }},
      {"a turned node",
       [](Builder& b) {
         b.root["nodes"][0]["rotation"] = {0, 0.6, 0, 0.8};
       }},
      {"a sheared mesh",
       [](Builder& b) { b.root["nodes"][0]["matrix"] = {1, 0.1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; }},
      {"weights",
       [](Builder& b) {
         primitive(b)["targets"] = json::array({{{"POSITION", primitive(b)["attributes"]["POSITION"]}}});
         b.root["meshes"][0]["weights"] = json::array({0.5});
       }},
      {"tangents to be made",
       [](Builder& b) {
         add_texture(b);
         b.root["materials"] = json::array({{{"normalTexture", {{"index", 0}}}}});
         primitive(b)["material"] = 0;
       }},
  };
  for (const auto& [name, change] : changes) {
    Builder b = damaged_draco();
    change(b);
    try {
      counted(b, false);
      ADD_FAILURE() << name << ": not unpacked";
    } catch (const Error& error) {
      EXPECT_THAT(error.message(), HasSubstr("Draco")) << name;
    }
  }
}

TEST(unit_io_gltf_outline, a_claim_that_no_stream_could_keep_is_refused) {
  Builder b = meshopt_strip(false);
  for (json& view : b.root["bufferViews"]) {
    if (!view.contains("extensions")) continue;
    view["extensions"]["EXT_meshopt_compression"]["count"] = 1 << 24;
    view["byteLength"] = (1 << 24) * view["extensions"]["EXT_meshopt_compression"]["byteStride"].get<int>();
  }
  try {
    counted(b, false);
    ADD_FAILURE() << "believed";
  } catch (const Error& error) {
    EXPECT_THAT(error.message(), HasSubstr("too short for its count"));
  }
}

}  // namespace
}  // namespace candela::io::test
