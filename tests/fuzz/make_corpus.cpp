#include <cstring>
#include <filesystem>
#include <iostream>

#include "base/error.h"
#include "base/file.h"
#include "image/develop.h"
#include "image/film.h"
#include "image/image_file.h"
#include "unit/foreign/old_picture_files.h"
#include "unit/image/webp_avif_files.h"
#include "unit/io/draco_files.h"
#include "unit/io/gltf_seeds.h"
#include "unit/io/meshopt_files.h"
#include "unit/io/zip_builder.h"

namespace {

using namespace candela;
namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;

Bytes bytes_of(std::string_view text) {
  Bytes bytes(text.size());
  std::memcpy(bytes.data(), text.data(), text.size());
  return bytes;
}

/// What decode_meshopt_fuzz reads.
std::vector<Bytes> meshopt_seeds() {
  std::vector<Bytes> seeds;
  for (const io::test::Packed& packed : io::test::kPacked) {
    const auto count = static_cast<unsigned>(packed.count);
    Bytes bytes = {static_cast<std::byte>(packed.mode), static_cast<std::byte>(packed.filter),
                   static_cast<std::byte>(count & 255), static_cast<std::byte>(count >> 8),
                   static_cast<std::byte>(packed.stride)};
    const Bytes stream = packed.bytes();
    bytes.insert(bytes.end(), stream.begin(), stream.end());
    seeds.push_back(std::move(bytes));
  }
  return seeds;
}

std::vector<Bytes> zip_seeds() {
  std::vector<Bytes> seeds;
  for (const auto& seed : io::test::seed_files()) {
    seeds.push_back(io::test::zip_of({{"model/scene.glb", seed.glb()}, {"readme.txt", bytes_of("a scene")}}));
    seeds.push_back(io::test::zip_of({{"scene.gltf", bytes_of(seed.gltf())}}, seeds.size() % 4 == 1));
    if (seeds.size() > 12) break;
  }
  seeds.push_back(io::test::zip_of({{"a.glb", bytes_of("glTF")}, {"b/c.gltf", bytes_of("{}")}}, false));
  // The end of an empty archive.
  seeds.push_back(bytes_of("PK\5\6"));
  seeds.back().resize(22);
  return seeds;
}

std::vector<Bytes> draco_seeds() {
  return {io::test::draco_strip(12, 10, true), io::test::draco_strip(12, 0, true), io::test::draco_strip(30, 5, false),
          io::test::draco_strip(30, 7, true)};
}

std::vector<Bytes> ies_seeds() {
  return {bytes_of("IESNA:LM-63-2002\n[TEST] a\nTILT=NONE\n1 1000 1 3 1 1 2 0 0 0\n1 1 100\n0 45 90\n0\n1000 500 0\n"),
          bytes_of("IESNA91\nTILT=INCLUDE\n1\n2\n0 90\n1 0.9\n2 500 2 2 3 2 1 -0.1 0.1 0.2\n1 1 10\n0 180\n0 90 180\n"
                   "1 2 3 4 5 6\n")};
}

/// What a file holds, which is gone then.
Bytes taken(const fs::path& path) {
  Bytes bytes = read_file(path);
  fs::remove(path);
  return bytes;
}

std::vector<Bytes> written_pictures(const std::string& extension) {
  const DisplayImage image{9, 5, std::vector<std::uint8_t>(9 * 5 * 4, 200)};
  const fs::path path = fs::temp_directory_path() / ("candela-seed" + extension);
  extension == ".png" ? write_png(path, image) : write_jpeg(path, image);
  return {taken(path)};
}

std::vector<Bytes> linear_seeds() {
  const fs::path path = fs::temp_directory_path() / "candela-seed";
  Film film;
  film.beauty = Image(9, 5, 4);
  film.layers[Layer::normal] = Image(9, 5, 3);
  for (float& value : film.beauty.pixels) value = 0.25f;
  write_exr(path, film);
  std::vector<Bytes> seeds = {taken(path)};
  write_hdr(path, Image(9, 5, 3));
  seeds.push_back(taken(path));
  seeds.push_back(
      bytes_of("#?RADIANCE\nFORMAT=32-bit_rle_xyze\nEXPOSURE=2\nCOLORCORR=1 2 1\n\n+X 1 -Y 2\n"
               "abcdefgh"));
  return seeds;
}

/// One triangle as each format has it.
std::vector<Bytes> foreign_seeds() {
  const std::string model =
      R"(<model unit="millimeter" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources>)"
      R"(<object id="1" type="model"><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/>)"
      R"(<vertex x="0" y="1" z="0"/></vertices><triangles><triangle v1="0" v2="1" v3="2"/></triangles></mesh></object>)"
      R"(</resources><build><item objectid="1"/></build></model>)";
  const std::string collada =
      R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>)"
      R"(<unit meter="0.01"/><up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g"><mesh><source id="p">)"
      R"(<float_array id="a" count="9">0 0 0 1 0 0 0 1 0</float_array><technique_common><accessor source="#a" count="3" )"
      R"(stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor>)"
      R"(</technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles )"
      R"(count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry>)"
      R"(</library_geometries><library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"/></node>)"
      R"(</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  Bytes stl(84 + 50);
  stl[80] = std::byte{1};
  return {bytes_of("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nusemtl a\nf 1/1/1 2/1/1 3/1/1\n"),
          bytes_of("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
                   "endfacet\nendsolid a\n"),
          std::move(stl),
          bytes_of(header + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
          bytes_of(collada),
          io::test::zip_of({{"3D/3dmodel.model", bytes_of(model)}})};
}

std::vector<Bytes> camera_seeds() {
  return {
      bytes_of(R"({"camera_angle_x": 0.8, "w": 640, "h": 480, "frames": [{"file_path": "a.png", "transform_matrix": )"
               R"([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 3], [0, 0, 0, 1]]}, {"fl_x": 700, "fl_y": 710, "cx": 300, )"
               R"("cy": 240, "k1": 0, "transform_matrix": [2, 0, 0, 1, 0, 2, 0, 1, 0, 0, 2, 1, 0, 0, 0, 1]}]})"),
      bytes_of(R"([{"name": "left", "size": [640, 480], "K": [[700, 1, 320], [0, 710, 240], [0, 0, 1]], )"
               R"("world_from_camera": [[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 3], [0, 0, 0, 1]]}, )"
               R"({"K": [500, 0, 320, 0, 500, 240, 0, 0, 1], "axes": "opengl", "pixel_center": 0, )"
               R"("world_from_camera": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 3], [0, 0, 0, 1]]}])")};
}

std::vector<Bytes> seeds_of(const std::string& kind) {
  if (kind == "webp") return test::webp_seeds();
  if (kind == "avif") return test::avif_seeds();
  if (kind == "png" || kind == "jpg") return written_pictures("." + kind);
  if (kind == "old_picture") return foreign::test::old_picture_seeds();
  if (kind == "meshopt") return meshopt_seeds();
  if (kind == "draco") return draco_seeds();
  if (kind == "zip") return zip_seeds();
  if (kind == "ies") return ies_seeds();
  if (kind == "linear") return linear_seeds();
  if (kind == "cameras") return camera_seeds();
  if (kind == "foreign") return foreign_seeds();
  throw Error("no such corpus", kind);
}

}  // namespace

/// Writes the files of a kind that fuzzing starts from into the folder given.
int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: make_corpus webp|avif|png|jpg|meshopt|draco|zip|ies|cameras|linear|foreign FOLDER\n";
    return 2;
  }
  try {
    const fs::path folder = argv[2];
    fs::create_directories(folder);
    int i = 0;
    for (const Bytes& seed : seeds_of(argv[1])) write_file(folder / ("seed_" + std::to_string(i++)), seed);
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
  return 0;
}
