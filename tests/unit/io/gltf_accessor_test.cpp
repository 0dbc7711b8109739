#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "unit/io/gltf_builder.h"

namespace candela::io::test {
namespace {

using ::testing::HasSubstr;

const std::vector<vec3>& positions(const Loaded& loaded) {
  return loaded.scene.meshes.at(0).primitives.at(0).positions;
}
const Primitive& first(const Loaded& loaded) { return loaded.scene.meshes.at(0).primitives.at(0); }

/// The triangle with positions from an accessor of another component type.
template <class T>
std::vector<vec3> positions_as(const std::vector<T>& values, int component_type, bool normalized) {
  Builder b = triangle();
  primitive(b)["attributes"]["POSITION"] = b.accessor(values, "VEC3", component_type, 3, normalized);
  return positions(load(b));
}

TEST(unit_io_gltf_accessor, every_component_type_is_read_plain_and_normalized) {
  using P = std::vector<vec3>;
  EXPECT_EQ(positions_as<std::int8_t>({-128, -127, 127, 0, 1, 0, 100, 0, 0}, 5120, false),
            (P{{-128, -127, 127}, {0, 1, 0}, {100, 0, 0}}));
  EXPECT_EQ(positions_as<std::int8_t>({-128, -127, 127, 0, 1, 0, 100, 0, 0}, 5120, true),
            (P{{-1, -1, 1}, {0, 1 / 127.0f, 0}, {100 / 127.0f, 0, 0}}));
  EXPECT_EQ(positions_as<std::uint8_t>({255, 0, 1, 0, 51, 0, 0, 0, 0}, 5121, false),
            (P{{255, 0, 1}, {0, 51, 0}, {0, 0, 0}}));
  EXPECT_EQ(positions_as<std::uint8_t>({255, 0, 1, 0, 51, 0, 0, 0, 0}, 5121, true),
            (P{{1, 0, 1 / 255.0f}, {0, 0.2f, 0}, {0, 0, 0}}));
  EXPECT_EQ(positions_as<std::int16_t>({-32768, 32767, 5, 0, 1, 0, 0, 0, 0}, 5122, false),
            (P{{-32768, 32767, 5}, {0, 1, 0}, {0, 0, 0}}));
  EXPECT_EQ(positions_as<std::int16_t>({-32768, 32767, -32767, 0, 1, 0, 0, 0, 0}, 5122, true),
            (P{{-1, 1, -1}, {0, 1 / 32767.0f, 0}, {0, 0, 0}}));
  EXPECT_EQ(positions_as<std::uint16_t>({65535, 0, 5, 0, 1, 0, 0, 0, 0}, 5123, false),
            (P{{65535, 0, 5}, {0, 1, 0}, {0, 0, 0}}));
  EXPECT_EQ(positions_as<std::uint16_t>({65535, 0, 13107, 0, 1, 0, 0, 0, 0}, 5123, true),
            (P{{1, 0, 0.2f}, {0, 1 / 65535.0f, 0}, {0, 0, 0}}));
  EXPECT_EQ(positions_as<std::uint32_t>({70000, 0, 5, 0, 1, 0, 0, 0, 0}, 5125, false),
            (P{{70000, 0, 5}, {0, 1, 0}, {0, 0, 0}}));
  EXPECT_EQ(positions_as<float>({0.5f, -2, 0, 0, 1, 0, 0, 0, 0}, 5126, true), (P{{0.5f, -2, 0}, {0, 1, 0}, {0, 0, 0}}));
}

TEST(unit_io_gltf_accessor, indices_may_be_of_three_types) {
  for (const int type : {5121, 5123, 5125}) {
    Builder b = triangle();
    primitive(b)["indices"] = type == 5121   ? b.accessor(std::vector<std::uint8_t>{2, 0, 1}, "SCALAR", type, 1)
                              : type == 5123 ? b.accessor(std::vector<std::uint16_t>{2, 0, 1}, "SCALAR", type, 1)
                                             : b.accessor(std::vector<std::uint32_t>{2, 0, 1}, "SCALAR", type, 1);
    EXPECT_EQ(first(load(b)).triangles, (std::vector<uvec3>{{2, 0, 1}})) << type;
  }
}

TEST(unit_io_gltf_accessor, bad_indices_are_errors) {
  Builder b = triangle();
  primitive(b)["indices"] = b.indices({0, 1, 3});
  EXPECT_THAT(error_of(b), HasSubstr("index 2 is 3, but there are 3 vertices"));
  primitive(b)["indices"] = b.indices({0, 1, 65535});
  EXPECT_THAT(error_of(b), HasSubstr("primitive restart value 65535"));
  primitive(b)["indices"] = b.accessor(std::vector<std::uint8_t>{0, 1, 255}, "SCALAR", 5121, 1);
  EXPECT_THAT(error_of(b), HasSubstr("primitive restart value 255"));
  primitive(b)["indices"] = b.accessor(std::vector<std::uint32_t>{0, 1, 0xFFFFFFFF}, "SCALAR", 5125, 1);
  EXPECT_THAT(error_of(b), HasSubstr("primitive restart value 4294967295"));
  primitive(b)["indices"] = b.floats({0, 1, 2}, "SCALAR", 1);
  EXPECT_THAT(error_of(b), HasSubstr("indices must be unsigned integers"));
  primitive(b)["indices"] = b.vec2s({0, 1, 2, 3});
  EXPECT_THAT(error_of(b), HasSubstr("the accessor must be SCALAR, not VEC2"));
}

TEST(unit_io_gltf_accessor, interleaved_data_follows_the_stride) {
  Builder b = triangle();
  // position, normal, four bytes of nothing
  const int view = b.view(std::vector<float>{0, 0, 0, 0, 0, 1, 9, 2, 0, 0, 0, 0, 1, 9, 0, 3, 0, 0, 0, 1, 9}, 28);
  const auto at = [&](int offset) {
    return b.add_accessor(
        {{"bufferView", view}, {"byteOffset", offset}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
  };
  primitive(b)["attributes"]["POSITION"] = at(0);
  primitive(b)["attributes"]["NORMAL"] = at(12);
  const Loaded loaded = load(b);
  EXPECT_EQ(positions(loaded), (std::vector<vec3>{{0, 0, 0}, {2, 0, 0}, {0, 3, 0}}));
  EXPECT_EQ(first(loaded).normals, std::vector<vec3>(3, vec3(0, 0, 1)));
}

/// A sparse accessor that replaces elements 0 and 2.
json sparse(Builder& b, int count, const std::vector<std::uint8_t>& elements, const std::vector<float>& values) {
  return {{"componentType", 5126},
          {"count", count},
          {"type", "VEC3"},
          {"sparse",
           {{"count", elements.size()},
            {"indices", {{"bufferView", b.view(elements)}, {"componentType", 5121}}},
            {"values", {{"bufferView", b.view(values)}}}}}};
}

TEST(unit_io_gltf_accessor, sparse_values_replace_those_of_the_view) {
  Builder b = triangle();
  json entry = sparse(b, 3, {0, 2}, {5, 5, 5, 7, 7, 0});
  entry["bufferView"] = b.view(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
  primitive(b)["attributes"]["POSITION"] = b.add_accessor(entry);
  EXPECT_EQ(positions(load(b)), (std::vector<vec3>{{5, 5, 5}, {1, 0, 0}, {7, 7, 0}}));
}

TEST(unit_io_gltf_accessor, sparse_without_a_view_starts_from_zeros) {
  Builder b = triangle();
  primitive(b)["attributes"]["POSITION"] = b.add_accessor(sparse(b, 3, {1, 2}, {1, 0, 0, 0, 1, 0}));
  EXPECT_EQ(positions(load(b)), (std::vector<vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
}

TEST(unit_io_gltf_accessor, sparse_values_find_their_vertex_when_others_are_left_out) {
  Builder b = triangle();
  // Six vertices, of which the triangle uses 1, 3 and 5; element 2 is replaced but unused.
  primitive(b)["attributes"] = {{"POSITION", b.add_accessor(sparse(b, 6, {2, 3, 5}, {9, 9, 9, 1, 0, 0, 0, 1, 0}))}};
  primitive(b)["indices"] = b.indices({1, 3, 5});
  EXPECT_EQ(positions(load(b)), (std::vector<vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
}

TEST(unit_io_gltf_accessor, bad_sparse_parts_are_errors) {
  const auto error_with = [](auto change) {
    Builder b = triangle();
    json entry = sparse(b, 3, {0, 2}, {5, 5, 5, 7, 7, 0});
    change(entry);
    primitive(b)["attributes"]["POSITION"] = b.add_accessor(entry);
    return error_of(b);
  };
  EXPECT_EQ(error_with([](json&) {}), "loaded");
  EXPECT_THAT(error_with([](json& e) { e["sparse"]["count"] = 4; }), HasSubstr("4 of 3 elements"));
  EXPECT_THAT(error_with([](json& e) { e["sparse"]["count"] = 0; }), HasSubstr("/sparse/count"));
  EXPECT_THAT(error_with([](json& e) { e["sparse"]["count"] = 3; }), HasSubstr("lie outside their buffer view"));
  EXPECT_THAT(error_with([](json& e) { e["sparse"]["indices"]["byteOffset"] = 9007199254740991; }),
              HasSubstr("outside"));
  EXPECT_THAT(error_with([](json& e) { e["sparse"]["values"]["byteOffset"] = 4; }),
              HasSubstr("sparse values lie outside"));
  EXPECT_THAT(error_with([](json& e) { e["sparse"]["indices"]["componentType"] = 5126; }),
              HasSubstr("not an index type"));
  EXPECT_THAT(error_with([](json& e) { e["sparse"].erase("values"); }), HasSubstr("'values' is missing"));
  Builder descending = triangle();
  primitive(descending)["attributes"]["POSITION"] =
      descending.add_accessor(sparse(descending, 3, {2, 0}, {5, 5, 5, 7, 7, 0}));
  EXPECT_THAT(error_of(descending), HasSubstr("must ascend"));
  Builder outside = triangle();
  primitive(outside)["attributes"]["POSITION"] = outside.add_accessor(sparse(outside, 3, {0, 3}, {5, 5, 5, 7, 7, 0}));
  EXPECT_THAT(error_of(outside), HasSubstr("element 3 of 3"));
}

TEST(unit_io_gltf_accessor, claims_without_bytes_are_refused_before_allocation) {
  for (const double count : {4294967295.0, 3000000000.0, 100000000.0}) {
    Builder b = triangle();
    json entry = sparse(b, 3, {0, 2}, {5, 5, 5, 7, 7, 0});
    entry["count"] = count;
    b.root["meshes"][0]["primitives"][0] = {{"attributes", {{"POSITION", b.add_accessor(entry)}}}};
    EXPECT_THAT(error_of(b), HasSubstr("far larger than the file")) << count;
  }
  Builder b = triangle();
  b.root["accessors"][0]["count"] = 1e15;
  EXPECT_THAT(error_of(b), HasSubstr("/accessors/0/count"));
}

TEST(unit_io_gltf_accessor, many_primitives_over_the_same_data_are_bounded) {
  Builder b = triangle();
  const int large = b.vec3s(std::vector<float>(300000, 0.25f));
  b.root["meshes"][0]["primitives"] = json::array();
  for (int i = 0; i < 2000; ++i) b.root["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", large}}}});
  EXPECT_THAT(error_of(b), HasSubstr("far larger than the file"));
}

TEST(unit_io_gltf_accessor, ranges_outside_their_buffer_are_errors) {
  const auto error_with = [](auto change) {
    Builder b = triangle();
    change(b.root);
    return error_of(b);
  };
  EXPECT_THAT(error_with([](json& r) { r["accessors"][0]["count"] = 4; }),
              HasSubstr("#/accessors/0: needs 48 bytes of a buffer view that has 36"));
  EXPECT_THAT(error_with([](json& r) { r["accessors"][0]["count"] = 0; }), HasSubstr("count of 0"));
  EXPECT_THAT(error_with([](json& r) { r["accessors"][0]["count"] = -3; }),
              HasSubstr("must be a whole number that is not negative, not -3"));
  EXPECT_THAT(error_with([](json& r) { r["accessors"][0]["count"] = 2.5; }), HasSubstr("must be a whole number"));
  EXPECT_THAT(error_with([](json& r) { r["accessors"][0]["count"] = "3"; }),
              HasSubstr("must be a whole number, not string"));
  EXPECT_THAT(error_with([](json& r) { r["accessors"][0]["byteOffset"] = 1; }), HasSubstr("needs 37 bytes"));
  EXPECT_THAT(error_with([](json& r) { r["accessors"][0]["byteOffset"] = 9007199254740991; }),
              HasSubstr("bytes of a buffer view"));
  EXPECT_THAT(error_with([](json& r) { r["accessors"][0]["byteOffset"] = 18446744073709551615u; }),
              HasSubstr("whole number"));
  EXPECT_THAT(error_with([](json& r) { r["accessors"][0]["componentType"] = 5124; }),
              HasSubstr("5124 is not a component type"));
  EXPECT_THAT(error_with([](json& r) { r["accessors"][0]["type"] = "VEC9"; }), HasSubstr("must be VEC3, not VEC9"));
  EXPECT_THAT(error_with([](json& r) { r["accessors"][0].erase("componentType"); }),
              HasSubstr("'componentType' is missing"));
  EXPECT_THAT(error_with([](json& r) { r["accessors"][0]["bufferView"] = 99; }),
              HasSubstr("buffer view 99 does not exist"));
  EXPECT_THAT(error_with([](json& r) { r["bufferViews"][0]["buffer"] = 9; }),
              HasSubstr("#/bufferViews/0/buffer: buffer 9 does not exist"));
  EXPECT_THAT(error_with([](json& r) { r["bufferViews"][0]["byteOffset"] = 9007199254740991; }),
              HasSubstr("lie outside the buffer"));
  EXPECT_THAT(error_with([](json& r) { r["bufferViews"][0]["byteLength"] = 100000; }),
              HasSubstr("lie outside the buffer"));
  EXPECT_THAT(error_with([](json& r) { r["bufferViews"][0]["byteLength"] = 0; }), HasSubstr("at least 1"));
  EXPECT_THAT(error_with([](json& r) { r["bufferViews"][0]["byteStride"] = 300; }), HasSubstr("at most 252"));
  EXPECT_THAT(error_with([](json& r) { r["bufferViews"][0]["byteStride"] = 8; }),
              HasSubstr("do not fit a stride of 8"));
  EXPECT_THAT(error_with([](json& r) { r.erase("accessors"); }), HasSubstr("accessor 0 does not exist (there are 0)"));
  EXPECT_THAT(error_with([](json& r) { r["bufferViews"] = json::object(); }),
              HasSubstr("#/bufferViews: must be an array, not object"));
  EXPECT_THAT(error_with([](json& r) { r["accessors"][0] = 5; }), HasSubstr("must be an object, not number"));
}

TEST(unit_io_gltf_accessor, nan_and_infinity_are_errors_that_name_the_element) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Builder b = triangle();
    primitive(b)["attributes"]["POSITION"] = b.vec3s({0, 0, 0, 1, 0, 0, 0, bad, 0});
    EXPECT_THAT(error_of(b), HasSubstr("element 2 is not finite"));
    b = triangle();
    primitive(b)["attributes"]["NORMAL"] = b.vec3s({0, 0, bad, 0, 0, 1, 0, 0, 1});
    EXPECT_THAT(error_of(b), HasSubstr("element 0 is not finite"));
    b = triangle();
    primitive(b)["attributes"]["TEXCOORD_0"] = b.vec2s({0, 0, bad, 0, 0, 0});
    EXPECT_THAT(error_of(b), HasSubstr("element 1 is not finite"));
  }
}

TEST(unit_io_gltf_accessor, unaligned_data_is_read) {
  Builder b = triangle();
  b.binary.push_back(std::byte{0});
  std::vector<std::byte> raw(37);
  const float values[9] = {0, 0, 0, 2, 0, 0, 0, 2, 0};
  std::memcpy(raw.data() + 1, values, sizeof values);
  const int view = b.view(raw);
  primitive(b)["attributes"]["POSITION"] = b.add_accessor(
      {{"bufferView", view}, {"byteOffset", 1}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
  EXPECT_EQ(positions(load(b)), (std::vector<vec3>{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}));
}

TEST(unit_io_gltf_accessor, attributes_of_another_length_are_errors) {
  Builder b = triangle();
  primitive(b)["attributes"]["TEXCOORD_0"] = b.vec2s({0, 0, 1, 1});
  EXPECT_THAT(error_of(b), HasSubstr("/attributes/TEXCOORD_0: has 2 elements, but POSITION has 3"));
}

}  // namespace
}  // namespace candela::io::test
