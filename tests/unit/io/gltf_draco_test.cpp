#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "io/draco_mesh.h"
#include "unit/io/draco_files.h"
#include "unit/io/gltf_builder.h"

// KHR_draco_mesh_compression: the mesh is that of the stream, whatever else the file says of it.

namespace candela::io::test {
namespace {

using ::testing::HasSubstr;

constexpr int kTriangles = 16;
// Ids as draco_strip gives them.
constexpr int kPositions = 0, kUvs = 1, kNormals = 2;

/// A primitive of placeholders: accessors without a buffer view, which count what the stream holds.
Builder packed(const std::vector<std::byte>& stream) {
  Builder b = triangle();
  const int view = b.view(stream);
  const auto placeholder = [&](const char* type, int component_type, int count) {
    return b.add_accessor({{"componentType", component_type}, {"count", count}, {"type", type}});
  };
  constexpr int kVertices = kTriangles + 2;
  primitive(b) = {{"attributes",
                   {{"POSITION", placeholder("VEC3", 5126, kVertices)},
                    {"TEXCOORD_0", placeholder("VEC2", 5126, kVertices)},
                    {"NORMAL", placeholder("VEC3", 5126, kVertices)}}},
                  {"indices", placeholder("SCALAR", 5123, 3 * kTriangles)},
                  {"extensions",
                   {{"KHR_draco_mesh_compression",
                     {{"bufferView", view},
                      {"attributes", {{"POSITION", kPositions}, {"TEXCOORD_0", kUvs}, {"NORMAL", kNormals}}}}}}}};
  b.root["extensionsUsed"] = b.root["extensionsRequired"] = json::array({"KHR_draco_mesh_compression"});
  return b;
}

json& extension(Builder& b) { return primitive(b)["extensions"]["KHR_draco_mesh_compression"]; }

/// Corners of a triangle, the least of them first.
using Corners = std::array<vec3, 3>;

std::vector<Corners> triangles_of(const Primitive& p) {
  std::vector<Corners> result;
  const auto is_less = [](vec3 a, vec3 b) { return std::array{a.x, a.y, a.z} < std::array{b.x, b.y, b.z}; };
  for (const uvec3 t : p.triangles) {
    Corners c{p.positions[t.x], p.positions[t.y], p.positions[t.z]};
    std::rotate(c.begin(), std::min_element(c.begin(), c.end(), is_less), c.end());
    result.push_back(c);
  }
  std::sort(result.begin(), result.end(), [&](const Corners& a, const Corners& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(), is_less);
  });
  return result;
}

/// What draco_strip packs, at the thousandths to which 11 bits of 9 units leave it.
std::vector<Corners> strip() {
  const auto position = [](int i) {
    const int step = i / 2;
    return vec3(static_cast<float>(step), static_cast<float>(i % 2), static_cast<float>(i % 5) / 8.0f);
  };
  Primitive p;
  for (int i = 0; i < kTriangles; ++i) {
    const auto first = static_cast<unsigned>(p.positions.size());
    for (const int k : {i, i + 1 + i % 2, i + 2 - i % 2}) p.positions.push_back(position(k));
    p.triangles.emplace_back(first, first + 1, first + 2);
  }
  return triangles_of(p);
}

double largest_distance(const std::vector<Corners>& a, const std::vector<Corners>& b) {
  double largest = a.size() == b.size() ? 0.0 : 1e30;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    for (std::size_t k = 0; k < 3; ++k) largest = std::max(largest, static_cast<double>(distance(a[i][k], b[i][k])));
  }
  return largest;
}

const Primitive& first(const Loaded& loaded) { return loaded.scene.meshes.at(0).primitives.at(0); }

constexpr double kStep = 9.0 / 2047.0;  // of positions of 11 bits

TEST(unit_io_gltf_draco, triangles_and_what_their_corners_have_are_those_of_the_stream) {
  for (const int speed : {0, 5, 10}) {
    const Loaded loaded = load(packed(draco_strip(kTriangles, speed, true)));
    const Primitive& p = first(loaded);
    EXPECT_LT(largest_distance(triangles_of(p), strip()), kStep) << "speed " << speed;
    ASSERT_EQ(p.uvs[0].size(), p.positions.size());
    ASSERT_EQ(p.normals.size(), p.positions.size());
    for (std::size_t i = 0; i < p.positions.size(); ++i) {
      EXPECT_NEAR(p.uvs[0][i].y, p.positions[i].y, 0.01) << "a uv belongs to its own corner";
      EXPECT_LT(distance(p.normals[i], vec3(0.0f, 0.6f, 0.8f)), 0.02f);
    }
  }
}

TEST(unit_io_gltf_draco, attributes_are_found_by_their_ids) {
  Builder b = packed(draco_strip(kTriangles, 5, true));
  extension(b)["attributes"]["NORMAL"] = kPositions;
  const Loaded loaded = load(b);
  for (std::size_t i = 0; i < first(loaded).positions.size(); ++i) {
    const vec3 position = first(loaded).positions[i];
    if (length(position) < 0.5f) continue;
    EXPECT_LT(distance(first(loaded).normals[i], normalize(position)), 0.01f);
  }
}

TEST(unit_io_gltf_draco, the_stream_is_believed_and_not_what_stands_beside_it) {
  Builder b = packed(draco_strip(kTriangles, 5, true));
  // A fallback: a lone triangle far away, and counts of something else.
  json& attributes = primitive(b)["attributes"];
  const int fallback = b.vec3s({100, 0, 0, 101, 0, 0, 100, 1, 0});
  attributes["POSITION"] = fallback;
  b.root["accessors"][static_cast<std::size_t>(attributes["TEXCOORD_0"])]["count"] = 3;
  primitive(b)["mode"] = 5;  // Draco holds triangles, whatever strips they were
  EXPECT_LT(largest_distance(triangles_of(first(load(b))), strip()), kStep);
}

TEST(unit_io_gltf_draco, two_primitives_share_a_stream) {
  Builder b = packed(draco_strip(kTriangles, 5, true));
  b.root["meshes"][0]["primitives"].push_back(primitive(b));
  const Loaded loaded = load(b);
  ASSERT_EQ(loaded.scene.meshes[0].primitives.size(), 2u);
  EXPECT_EQ(loaded.scene.meshes[0].primitives[1].positions, first(loaded).positions);
}

TEST(unit_io_gltf_draco, what_the_stream_does_not_hold_is_named) {
  Builder b = packed(draco_strip(kTriangles, 5, false));
  EXPECT_THAT(error_of(b), HasSubstr("the Draco data has no attribute 2"));
  b = packed(draco_strip(kTriangles, 5, true));
  extension(b)["attributes"]["POSITION"] = kUvs;
  EXPECT_THAT(error_of(b), HasSubstr("attribute 1 of the Draco data has 2 components, its accessor 3"));
  extension(b)["attributes"]["POSITION"] = 4294967296;
  EXPECT_THAT(error_of(b), HasSubstr("is no attribute of Draco"));
  extension(b)["bufferView"] = 77;
  EXPECT_THAT(error_of(b), HasSubstr("buffer view 77 does not exist"));
}

TEST(unit_io_gltf_draco, truth_values_are_no_attribute_of_gltf) {
  // One triangle in order; its only attribute has two values of type 11, which is bool, the first of them 250.
  const std::string text("DRACO\2\2\1\0\0\0\1\1\1\1\1\1\1\1\1\x0b\2\0\0\0\xfa\x43\x3f\x0a", 29);
  const DracoMesh mesh(std::as_bytes(std::span(text)));
  try {
    mesh.attribute(0, 5126, 2);
    FAIL() << "it was read";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("attribute 0 of the Draco data is of truth values"));
  }
}

TEST(unit_io_gltf_draco, damage_is_one_error) {
  const std::vector<std::byte> whole = draco_strip(kTriangles, 0, true);
  std::vector<std::byte> cloud = whole;
  cloud[7] = std::byte{0};
  EXPECT_THAT(error_of(packed(cloud)), HasSubstr("it is a cloud of points, not a mesh"));
  EXPECT_THAT(error_of(packed({std::byte{1}, std::byte{2}})), HasSubstr("damaged Draco data: it has no header"));
  for (std::size_t size = 12; size < whole.size(); size += 7) {
    EXPECT_THAT(error_of(packed({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)})),
                HasSubstr("Draco"))
        << size << " of " << whole.size() << " bytes";
  }
}

TEST(unit_io_gltf_draco, a_claim_beyond_the_file_asks_for_no_memory) {
  // A header of version 2.2, sequential, whose faces are 2^31.
  const std::string text("DRACO\2\2\1\0\0\0\x80\x80\x80\x80\x08\3\1", 18);
  const auto bytes = as_bytes(text);
  EXPECT_THAT(error_of(packed({bytes.begin(), bytes.end()})), HasSubstr("larger than 4 GiB"));
}

TEST(unit_io_gltf_draco, streams_that_take_far_longer_than_honest_ones_are_not_gone_on_with) {
  DracoBudget honest;
  for (int i = 0; i < 1000; ++i) honest.charge(100'000, 0.5);
  honest.require();
  DracoBudget hostile;
  for (int i = 0; i < 3; ++i) {
    hostile.require();
    hostile.charge(229, 7.0);
  }
  EXPECT_THROW(hostile.require(), Error);
}

}  // namespace
}  // namespace candela::io::test
