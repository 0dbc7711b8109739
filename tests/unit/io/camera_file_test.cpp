#include "io/camera_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "base/error.h"
#include "base/file.h"
#include "unit/base/temp_folder.h"

namespace candela::io {
namespace {

using testing::HasSubstr;

constexpr ivec2 kSize{640, 480};

mat4 pose() {
  mat4 m = glm::mat4_cast(glm::angleAxis(0.8f, glm::normalize(vec3(1, -2, 0.5f))));
  m[3] = vec4(1, 2, 3, 1);
  return m;
}

std::vector<PosedCamera> two_cameras() {
  PosedCamera plain{.name = "a.png", .view = {}, .size = kSize, .picture = {}};
  plain.view.world_from_camera = pose();
  plain.view.projection = PerspectiveCamera{.yfov = 0.7f, .aspect_ratio = 4.0f / 3.0f};
  PosedCamera other = plain;
  other.name = "b.png";
  other.picture = "train/007.png";
  other.view.world_from_camera = mat4(1.0f);
  return {plain, other};
}

void expect_same(const View& a, const View& b) {
  for (int c = 0; c < 4; ++c) {
    for (int r = 0; r < 4; ++r) EXPECT_NEAR(a.world_from_camera[c][r], b.world_from_camera[c][r], 2e-6f);
  }
  ASSERT_EQ(a.projection.index(), b.projection.index());
  if (const auto* p = std::get_if<PerspectiveCamera>(&a.projection)) {
    EXPECT_NEAR(p->yfov, std::get<PerspectiveCamera>(b.projection).yfov, 1e-6f);
  } else {
    EXPECT_NEAR(std::get<OrthographicCamera>(a.projection).ymag, std::get<OrthographicCamera>(b.projection).ymag,
                1e-6f);
  }
}

TEST(unit_io_camera_file, what_is_written_is_read_back_in_every_format) {
  const test::TempFolder folder;
  for (const char* name : {"cameras.gltf", "transforms.json", "cameras.json"}) {
    const std::vector<PosedCamera> written = two_cameras();
    write_cameras(folder / name, written, kSize);
    const std::vector<PosedCamera> read = read_cameras(folder / name, kSize);
    ASSERT_EQ(read.size(), 2u) << name;
    for (std::size_t i = 0; i < 2; ++i) expect_same(read[i].view, written[i].view);
  }
  EXPECT_EQ(read_cameras(folder / "transforms.json", {10, 10})[0].name, "a");
  EXPECT_EQ(read_cameras(folder / "transforms.json", {10, 10})[1].name, "007");
  EXPECT_EQ(read_cameras(folder / "transforms.json", {10, 10})[1].picture, "train/007.png");
  EXPECT_EQ(read_cameras(folder / "cameras.json", {10, 10})[1].name, "b.png");
  EXPECT_EQ(read_cameras(folder / "cameras.json", {10, 10})[1].size, kSize);
}

TEST(unit_io_camera_file, an_axis_beside_the_middle_and_pixels_that_are_not_square_stay) {
  const test::TempFolder folder;
  CameraMatrix m;
  m.size = kSize;
  m.k = glm::dmat3(700, 0, 0, 0, 650, 0, 330.5, 201.25, 1);
  const std::vector<PosedCamera> written{
      {.name = "k", .view = view_of_matrix(m, pose()), .size = kSize, .picture = {}}};
  for (const char* name : {"transforms.json", "cameras.json"}) {
    write_cameras(folder / name, written, kSize);
    expect_same(read_cameras(folder / name, kSize)[0].view, written[0].view);
  }
  EXPECT_THROW(write_cameras(folder / "cameras.gltf", written, kSize), Error);
}

TEST(unit_io_camera_file, orthographic_cameras_are_gltf_only) {
  const test::TempFolder folder;
  std::vector<PosedCamera> cameras = two_cameras();
  for (PosedCamera& camera : cameras) camera.view.projection = OrthographicCamera{.xmag = 4.0f, .ymag = 3.0f};
  write_cameras(folder / "cameras.gltf", cameras, kSize);
  expect_same(read_cameras(folder / "cameras.gltf", kSize)[0].view, cameras[0].view);
  EXPECT_THROW(write_cameras(folder / "transforms.json", cameras, kSize), Error);
  EXPECT_EQ(folder.entries(), 1u) << "nothing half written";
}

/// Of a file with this text; reads for 64 x 48 pixels.
std::vector<PosedCamera> read_text(const std::string& text) {
  const test::TempFolder folder;
  write_file(folder / "c.json", text);
  return read_cameras(folder / "c.json", {64, 48});
}
std::string message_of(const std::string& text) {
  try {
    read_text(text);
  } catch (const Error& error) {
    return error.where().substr(error.where().find('#') + 1) + ": " + error.message();
  }
  return "";
}

const std::string kUnit = "[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]";

TEST(unit_io_camera_file, the_array_has_axes_of_opencv_or_opengl_and_pixels_from_a_corner_or_a_middle) {
  const std::string k = R"("K": [[60,0,32],[0,60,24],[0,0,1]], "size": [64,48], "world_from_camera": )";
  const View opencv = read_text("[{" + k + kUnit + "}]")[0].view;
  EXPECT_EQ(vec3(opencv.world_from_camera[2]), vec3(0, 0, -1)) << "it looks along +z";
  EXPECT_EQ(vec3(opencv.world_from_camera[1]), vec3(0, -1, 0));
  const View opengl = read_text("[{\"axes\": \"opengl\", " + k + kUnit + "}]")[0].view;
  EXPECT_EQ(opengl.world_from_camera, mat4(1.0f));
  // The middle of the picture is at 31.5 where that of the first pixel is at 0.
  const View from_middle =
      read_text(
          R"([{"axes": "opengl", "pixel_center": 0, "K": [60,0,31.5,0,60,23.5,0,0,1], "size": [64,48], "world_from_camera": )" +
          kUnit + "}]")[0]
          .view;
  EXPECT_EQ(from_middle.world_from_camera, mat4(1.0f));
  EXPECT_NEAR(std::get<PerspectiveCamera>(opengl.projection).yfov, 2.0f * std::atan(24.0f / 60.0f), 1e-6f);
}

TEST(unit_io_camera_file, transforms_have_an_angle_or_focal_lengths_of_all_or_of_a_frame) {
  const std::string frame = R"({"file_path": "./images/007.png", "transform_matrix": )" + kUnit;
  const PosedCamera angle = read_text(R"({"camera_angle_x": 0.9, "frames": [)" + frame + "}]}")[0];
  EXPECT_EQ(angle.name, "007");
  EXPECT_FALSE(angle.size);
  EXPECT_NEAR(std::get<PerspectiveCamera>(angle.view.projection).yfov,
              2.0f * std::atan(std::tan(0.45f) * 48.0f / 64.0f), 1e-6f);
  const PosedCamera own = read_text(R"({"fl_x": 9, "w": 128, "h": 96, "frames": [)" + frame + R"(, "fl_x": 100}]})")[0];
  EXPECT_EQ(own.size, ivec2(128, 96));
  EXPECT_NEAR(std::get<PerspectiveCamera>(own.view.projection).yfov, 2.0f * std::atan(0.48f), 1e-6f);
}

TEST(unit_io_camera_file, damage_is_one_line_that_says_where) {
  EXPECT_THAT(message_of(""), HasSubstr("is empty"));
  EXPECT_THAT(message_of(" \n"), HasSubstr("is empty"));
  EXPECT_THAT(message_of("[]"), HasSubstr("has no camera"));
  EXPECT_THAT(message_of(R"({"frames": []})"), HasSubstr("has no camera"));
  EXPECT_THAT(message_of("{"), HasSubstr("is no JSON"));
  EXPECT_THAT(message_of("{}"), HasSubstr("neither"));
  const std::string flat = "[[1,0,0,0],[0,1,0,0],[0,0,0,0],[0,0,0,1]]";
  EXPECT_THAT(message_of(R"({"camera_angle_x": 1, "frames": [{"transform_matrix": )" + flat + "}]}"),
              HasSubstr("/frames/0/transform_matrix: the matrix is singular"));
  EXPECT_THAT(message_of(R"([{"K": [[0,0,1],[0,1,1],[0,0,1]], "world_from_camera": )" + kUnit + "}]"),
              HasSubstr("/0/K: K is singular"));
  EXPECT_THAT(message_of(R"({"frames": [{"transform_matrix": )" + kUnit + "}]}"), HasSubstr("camera_angle_x"));
  EXPECT_THAT(message_of(R"({"fl_x": 9, "k1": 0.1, "frames": [{"transform_matrix": )" + kUnit + "}]}"),
              HasSubstr("distorting"));
  EXPECT_THAT(message_of(R"([{"K": [1,2], "world_from_camera": )" + kUnit + "}]"), HasSubstr("/0/K"));
}

}  // namespace
}  // namespace candela::io
