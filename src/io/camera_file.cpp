#include "io/camera_file.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "base/file.h"
#include "base/text.h"
#include "io/gltf.h"
#include "io/json_view.h"

namespace candela::io {

namespace fs = std::filesystem;

namespace {

using nlohmann::json;

constexpr int kMostPixels = 16384;  // per side, as of pictures

/// OpenGL's camera axes in those of OpenCV, and the other way round: y and z change their signs.
glm::dmat4 other_axes(glm::dmat4 pose) {
  pose[1] = -pose[1];
  pose[2] = -pose[2];
  return pose;
}

double number(const JsonView& place) { return static_cast<double>(place.real()); }

/// A square matrix by rows, of arrays or all in one.
template <class M>
M read_matrix(const JsonView& place) {
  constexpr auto kSize = static_cast<std::size_t>(M::length());
  M m(1.0);
  const bool is_nested = place.size() == kSize;
  std::vector<float> flat;
  if (!is_nested) flat = place.reals(kSize * kSize);
  for (std::size_t row = 0; row < kSize; ++row) {
    const std::vector<float> values =
        is_nested ? place[row].reals(kSize)
                  : std::vector<float>(flat.begin() + static_cast<std::ptrdiff_t>(row * kSize),
                                       flat.begin() + static_cast<std::ptrdiff_t>((row + 1) * kSize));
    for (std::size_t column = 0; column < kSize; ++column) {
      m[static_cast<int>(column)][static_cast<int>(row)] = static_cast<double>(values[column]);
    }
  }
  return m;
}

/// Calls `f`; its Error gets a place.
template <class F>
auto at(const JsonView& place, const F& f) {
  try {
    return f();
  } catch (const Error& error) {
    throw error.where().empty() ? place.error(error.message()) : error;
  }
}

ivec2 read_size(const JsonView& width, const JsonView& height) {
  const auto side = [](const JsonView& place) {
    const std::uint64_t value = place.whole();
    if (value < 1 || value > kMostPixels) throw place.error(fmt::format("must be within 1 and {}", kMostPixels));
    return static_cast<int>(value);
  };
  return {side(width), side(height)};
}

/// A frame's member, else that of all.
class Frame {
 public:
  Frame(JsonView frame, JsonView all) : frame_(std::move(frame)), all_(std::move(all)) {}
  std::optional<JsonView> find(const char* key) const {
    auto own = frame_.find(key);
    return own ? own : all_.find(key);
  }
  std::optional<double> number(const char* key) const {
    const auto found = find(key);
    return found ? std::optional(io::number(*found)) : std::nullopt;
  }
  const JsonView& place() const { return frame_; }

 private:
  JsonView frame_, all_;
};

/// The focal length from an angle of view, in pixels.
double focal_length(const JsonView& angle, int pixels) {
  const double value = number(angle);
  if (!(value > 0.0 && value < std::acos(-1.0))) throw angle.error("must be an angle between 0 and pi");
  return 0.5 * pixels / std::tan(0.5 * value);
}

PosedCamera read_frame(const Frame& frame, ivec2 size) {
  for (const char* key : {"k1", "k2", "k3", "k4", "p1", "p2"}) {
    const auto distortion = frame.find(key);
    if (distortion && number(*distortion) != 0.0) {
      throw distortion->error("distorting lenses are not supported: undistort the pictures, and leave it out");
    }
  }
  PosedCamera camera;
  CameraMatrix matrix;
  const auto width = frame.find("w"), height = frame.find("h");
  if (width && height) camera.size = read_size(*width, *height);
  matrix.size = camera.size.value_or(size);
  std::optional<double> fx = frame.number("fl_x"), fy = frame.number("fl_y");
  const auto angle_x = frame.find("camera_angle_x"), angle_y = frame.find("camera_angle_y");
  if (!fx && angle_x) fx = focal_length(*angle_x, matrix.size.x);
  if (!fy && angle_y) fy = focal_length(*angle_y, matrix.size.y);
  if (!fx && !fy) throw frame.place().error("has no camera_angle_x and no fl_x");
  matrix.k[0][0] = fx.value_or(fy.value_or(0.0));
  matrix.k[1][1] = fy.value_or(fx.value_or(0.0));
  matrix.k[2][0] = frame.number("cx").value_or(0.5 * matrix.size.x);
  matrix.k[2][1] = frame.number("cy").value_or(0.5 * matrix.size.y);
  camera.picture = frame.place().string_or("file_path");
  camera.name = fs::path(camera.picture).stem().string();
  const JsonView pose = frame.place().at("transform_matrix");
  const mat4 world_from_camera = at(pose, [&] { return rigid_part(read_matrix<glm::dmat4>(pose)); });
  camera.view = at(frame.place(), [&] { return view_of_matrix(matrix, world_from_camera); });
  return camera;
}

std::vector<PosedCamera> read_transforms(const JsonView& root, ivec2 size) {
  std::vector<PosedCamera> cameras;
  const JsonView frames = root.at("frames");
  for (std::size_t i = 0; i < frames.size(); ++i) cameras.push_back(read_frame({frames[i], root}, size));
  return cameras;
}

PosedCamera read_entry(const JsonView& entry, ivec2 size) {
  PosedCamera camera;
  camera.name = entry.string_or("name");
  if (const auto own = entry.find("size")) {
    if (own->size() != 2) throw own->error("must be [width, height]");
    camera.size = read_size((*own)[0], (*own)[1]);
  }
  const JsonView k = entry.at("K");
  CameraMatrix matrix{read_matrix<glm::dmat3>(k), camera.size.value_or(size)};
  const double center = static_cast<double>(entry.real_or("pixel_center", 0.5f));
  matrix.k[2][0] += 0.5 - center;
  matrix.k[2][1] += 0.5 - center;
  const JsonView pose = entry.at("world_from_camera");
  const std::string axes = entry.string_or("axes", "opencv");
  if (axes != "opencv" && axes != "opengl") throw entry.at("axes").error("must be opencv or opengl");
  const mat4 world_from_camera = at(pose, [&] {
    const auto given = read_matrix<glm::dmat4>(pose);
    return rigid_part(axes == "opencv" ? other_axes(given) : given);
  });
  camera.view = at(k, [&] { return view_of_matrix(matrix, world_from_camera); });
  return camera;
}

std::vector<PosedCamera> read_list(const JsonView& root, ivec2 size) {
  std::vector<PosedCamera> cameras;
  for (std::size_t i = 0; i < root.size(); ++i) cameras.push_back(read_entry(root[i], size));
  return cameras;
}

std::vector<PosedCamera> read_scene_cameras(const fs::path& path, ivec2 size) {
  Diagnostics diagnostics;
  LoadOptions options;
  options.decode_images = false;
  options.unpack_geometry = false;
  options.refuse_unknown_required = false;
  const Scene scene = load_gltf(path, diagnostics, options);
  std::vector<PosedCamera> cameras;
  for (const Node& node : scene.nodes) {
    if (node.camera < 0) continue;
    const std::string& own = scene.cameras[static_cast<std::size_t>(node.camera)].name;
    const float aspect = static_cast<float>(size.x) / static_cast<float>(size.y);
    cameras.push_back({node.name.empty() ? own : node.name, scene_camera(scene, node, aspect), std::nullopt, ""});
  }
  return cameras;
}

std::string read_text(const fs::path& path) {
  const std::vector<std::byte> bytes = read_file(path, std::uint64_t{1} << 28);
  std::string text(bytes.size(), '\0');
  for (std::size_t i = 0; i < bytes.size(); ++i) text[i] = static_cast<char>(bytes[i]);
  return text;
}

}  // namespace

std::vector<PosedCamera> parse_cameras(std::string_view text, const std::string& where, ivec2 size) {
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) throw Error("is empty: there is no camera", where);
  json document;
  try {
    document = json::parse(text);
  } catch (const json::exception& error) {
    throw Error(std::string("is no JSON: ") + error.what(), where);
  }
  const JsonView root(document, where);
  const bool has_frames = document.is_object() && document.contains("frames");
  if (!document.is_array() && !has_frames) {
    throw Error("is neither a transforms.json with frames nor an array of cameras", where);
  }
  std::vector<PosedCamera> cameras = has_frames ? read_transforms(root, size) : read_list(root, size);
  if (cameras.empty()) throw Error("has no camera", where);
  return cameras;
}

std::vector<PosedCamera> read_cameras(const fs::path& path, ivec2 size) {
  if (lower_extension(path) == ".json") return parse_cameras(read_text(path), path.string(), size);
  std::vector<PosedCamera> cameras = read_scene_cameras(path, size);
  if (cameras.empty()) throw Error("has no camera", path.string());
  return cameras;
}

namespace {

enum class Format { gltf, transforms, list };

Format format_of(const fs::path& path) {
  const std::string extension = lower_extension(path);
  if (extension == ".gltf") return Format::gltf;
  if (extension != ".json") {
    throw Error("a list of cameras is a .gltf, a transforms.json or another .json", path.string());
  }
  return lower_case(path.filename().string()).starts_with("transforms") ? Format::transforms : Format::list;
}

template <class M>
json matrix_json(const M& m) {
  json rows = json::array();
  for (int row = 0; row < M::length(); ++row) {
    json values = json::array();
    for (int column = 0; column < M::length(); ++column) values.push_back(m[column][row]);
    rows.push_back(std::move(values));
  }
  return rows;
}

constexpr int kPixelDigits = 8;  ///< of K, which comes of floats: a thousandth of a thousandth of a pixel

/// Rounded numbers of floats: their digits, and no more.
double rounded(double value, int count = 9) { return std::stod(fmt::format("{:.{}g}", value, count)); }
/// As a float is written, without the digits of the double next to it.
double digits(float value) { return std::stod(fmt::format("{}", value)); }

template <class M>
M rounded_matrix(M m, int count = 9) {
  for (int column = 0; column < M::length(); ++column) {
    for (int row = 0; row < M::length(); ++row) m[column][row] = rounded(m[column][row], count);
  }
  return m;
}

json transforms_json(const std::vector<PosedCamera>& cameras, ivec2 size) {
  json root{{"w", size.x}, {"h", size.y}, {"frames", json::array()}};
  for (const PosedCamera& camera : cameras) {
    const RigidCamera rigid = matrix_of_view(camera.view, size);
    const glm::dmat3& k = rigid.matrix.k;
    if (std::abs(k[1][0]) > 1e-4 * k[0][0]) throw Error("a transforms.json has no cameras with skew axes");
    json& frame = root["frames"].emplace_back();
    frame = {{"file_path", camera.picture.empty() ? camera.name : camera.picture},
             {"transform_matrix", matrix_json(rounded_matrix(rigid.world_from_camera))},
             {"fl_x", rounded(k[0][0], kPixelDigits)},
             {"fl_y", rounded(k[1][1], kPixelDigits)},
             {"cx", rounded(k[2][0], kPixelDigits)},
             {"cy", rounded(k[2][1], kPixelDigits)},
             {"camera_angle_x", rounded(2.0 * std::atan(0.5 * size.x / k[0][0]))}};
    if (!camera.depth.empty()) frame["depth_file_path"] = camera.depth;
  }
  // Many readers look for the angle in one place only.
  if (!cameras.empty()) root["camera_angle_x"] = root["frames"][0]["camera_angle_x"];
  return root;
}

json list_json(const std::vector<PosedCamera>& cameras, ivec2 size) {
  json root = json::array();
  for (const PosedCamera& camera : cameras) {
    const RigidCamera rigid = matrix_of_view(camera.view, size);
    root.push_back({{"name", camera.name},
                    {"size", {size.x, size.y}},
                    {"axes", "opencv"},
                    {"pixel_center", 0.5},
                    {"K", matrix_json(rounded_matrix(rigid.matrix.k, kPixelDigits))},
                    {"world_from_camera", matrix_json(rounded_matrix(other_axes(rigid.world_from_camera)))}});
  }
  return root;
}

json gltf_camera(const View& view, ivec2 size) {
  const double far = 1e6;
  if (const auto* o = std::get_if<OrthographicCamera>(&view.projection)) {
    return {
        {"type", "orthographic"},
        {"orthographic",
         {{"xmag", digits(o->xmag)}, {"ymag", digits(o->ymag)}, {"znear", digits(view.near_plane)}, {"zfar", far}}}};
  }
  const RigidCamera rigid = matrix_of_view(view, size);
  const glm::dmat3& k = rigid.matrix.k;
  const double pixel = 1e-3;
  if (std::abs(k[2][0] - 0.5 * size.x) > pixel || std::abs(k[2][1] - 0.5 * size.y) > pixel ||
      std::abs(k[1][0]) > 1e-6 * k[0][0] || std::abs(k[0][0] - k[1][1]) > 1e-4 * k[0][0]) {
    throw Error(
        "glTF has no cameras whose axis is not in the middle, whose pixels are not square or whose axes are skew");
  }
  return {{"type", "perspective"},
          {"perspective",
           {{"yfov", digits(std::get<PerspectiveCamera>(view.projection).yfov)},
            {"aspectRatio", static_cast<double>(size.x) / size.y},
            {"znear", view.near_plane > 0.0f ? digits(view.near_plane) : 1e-3}}}};
}

json gltf_json(const std::vector<PosedCamera>& cameras, ivec2 size) {
  json root{{"asset", {{"version", "2.0"}, {"generator", "candela"}}}, {"scene", 0}};
  json all = json::array();
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    json camera = gltf_camera(cameras[i].view, size);
    camera["name"] = cameras[i].name;
    root["cameras"].push_back(std::move(camera));
    json matrix = json::array();
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 4; ++row)
        matrix.push_back(rounded(static_cast<double>(cameras[i].view.world_from_camera[column][row])));
    }
    root["nodes"].push_back({{"name", cameras[i].name}, {"camera", i}, {"matrix", std::move(matrix)}});
    all.push_back(i);
  }
  root["scenes"] = {{{"nodes", std::move(all)}}};
  return root;
}

}  // namespace

void check_camera_file_name(const fs::path& path) { format_of(path); }

void write_cameras(const fs::path& path, const std::vector<PosedCamera>& cameras, ivec2 size) {
  const Format format = format_of(path);
  json document;
  try {
    document = format == Format::gltf         ? gltf_json(cameras, size)
               : format == Format::transforms ? transforms_json(cameras, size)
                                              : list_json(cameras, size);
  } catch (const Error& error) {
    throw Error(error.message(), path.string());
  }
  write_file(path, document.dump(2, ' ', false, json::error_handler_t::replace) + "\n");
}

}  // namespace candela::io
