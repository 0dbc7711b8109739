#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "candela/dataset_parts.h"
#include "scene/framing.h"
#include "scene/posed_camera.h"

namespace candela {

namespace fs = std::filesystem;

namespace {

constexpr double kMillimetres = 1e3;  // a metre

/// The rotation of a linear map, and what is left: rotation * stretch. Higham 1986, "Computing the Polar
/// Decomposition". Of a map that flattens all is stretch.
struct Polar {
  glm::dmat3 rotation{1.0};
  glm::dmat3 stretch{1.0};
};
Polar polar(const glm::dmat3& linear) {
  constexpr int kSteps = 60;
  const double scale = std::cbrt(std::abs(glm::determinant(linear)));
  if (!(scale > 1e-12)) return {glm::dmat3(1.0), linear};
  glm::dmat3 q = linear / scale;
  for (int i = 0; i < kSteps; ++i) q = 0.5 * (q + glm::transpose(glm::inverse(q)));
  if (glm::determinant(q) < 0.0) q = -q;  // the stretch mirrors
  return {q, glm::transpose(q) * linear};
}

Json numbers(const glm::dmat3& m) {
  Json json = Json::array();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) json.push_back(m[column][row]);
  }
  return json;
}

Json box_or_none(const PixelMask& mask) {
  const auto box = box_of(mask);
  return box ? Json(*box) : Json({-1, -1, -1, -1});
}

/// Smallest power of ten of a millimetre in which 16 bits hold every depth.
double depth_unit(const Image& depth) {
  double most = 0.0;
  for (const float d : depth.pixels) {
    if (std::isfinite(d)) most = std::max(most, static_cast<double>(d) * kMillimetres);
  }
  return most > 0.0 ? std::pow(10.0, std::ceil(std::log10(most / 65535.0))) : 1.0;
}

/// Triangles in millimetres.
struct Model {
  std::vector<vec3> positions, normals;
  std::vector<uvec3> triangles;

  void add(const Mesh& mesh, const glm::dmat4& model_from_mesh) {
    const glm::dmat3 linear(model_from_mesh);
    const bool is_mirrored = glm::determinant(linear) < 0.0;
    const glm::dmat3 cofactor(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                              glm::cross(linear[0], linear[1]));
    for (const Primitive& p : mesh.primitives) {
      const auto first = static_cast<std::uint32_t>(positions.size());
      for (std::size_t i = 0; i < p.positions.size(); ++i) {
        positions.emplace_back(kMillimetres * dvec3(model_from_mesh * glm::dvec4(p.positions[i], 1.0)));
        const dvec3 n = cofactor * dvec3(p.normals[i]) * (is_mirrored ? -1.0 : 1.0);
        normals.emplace_back(glm::length(n) > 0.0 ? glm::normalize(n) : dvec3(0, 1, 0));
      }
      for (const uvec3& t : p.triangles) {
        triangles.push_back(first + (is_mirrored ? uvec3(t.x, t.z, t.y) : t));
      }
    }
  }

  void write(const fs::path& path) const {
    std::string text = fmt::format(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float "
        "z\n"
        "property float nx\nproperty float ny\nproperty float nz\nelement face {}\n"
        "property list uchar int vertex_indices\nend_header\n",
        positions.size(), triangles.size());
    const auto append = [&](const auto& value) { text.append(reinterpret_cast<const char*>(&value), sizeof value); };
    for (std::size_t i = 0; i < positions.size(); ++i) append(positions[i]), append(normals[i]);
    for (const uvec3& t : triangles) {
      text += '\3';
      append(t);
    }
    write_made(path, std::as_bytes(std::span(text)));
  }

  /// Bounds and the largest distance of two vertices, found among those that are outermost in some direction.
  Json info() const {
    constexpr int kDirections = 1000;
    if (positions.empty()) return {{"diameter", 0}};
    const Extent extent(positions);
    const std::vector<vec3> outline = extent.outline(kDirections);
    double diameter = 0.0;
    for (const vec3& a : outline) {
      for (const vec3& b : outline) diameter = std::max(diameter, glm::distance(dvec3(a), dvec3(b)));
    }
    const vec3 low = extent.bounds().lower, size = extent.bounds().size();
    return {{"diameter", diameter}, {"min_x", low.x},   {"min_y", low.y},  {"min_z", low.z},
            {"size_x", size.x},     {"size_y", size.y}, {"size_z", size.z}};
  }
};

}  // namespace

fs::path BopWriter::scene_folder(const fs::path& folder, std::size_t scene) {
  return folder / "train_pbr" / fmt::format("{:06}", scene);
}

/// The number of the model that an instance is of; a new one is written.
int BopWriter::object_of(const Scene& scene, std::size_t number, const Instance& instance, const glm::dmat3& stretch) {
  constexpr double kSame = 1e-4;  // of the largest number
  const bool is_node = instance.nodes.size() == 1;
  const int mesh = is_node ? scene.nodes[static_cast<std::size_t>(instance.nodes[0])].mesh : -1;
  std::vector<long> key{static_cast<long>(number), mesh};
  double most = 0.0;
  for (int i = 0; i < 9; ++i) most = std::max(most, std::abs(stretch[i / 3][i % 3]));
  key.push_back(std::lround(std::log(std::max(most, 1e-30)) / kSame));
  for (int i = 0; i < 9; ++i) key.push_back(std::lround(stretch[i / 3][i % 3] / (most * kSame)));
  const auto [found, is_new] = objects_.try_emplace(key, static_cast<int>(objects_.size()) + 1);
  if (!is_new) return found->second;
  Model model;
  for (const int node : instance.nodes) {
    const Node& n = scene.nodes[static_cast<std::size_t>(node)];
    model.add(scene.meshes[static_cast<std::size_t>(n.mesh)],
              is_node ? glm::dmat4(stretch) : glm::dmat4(n.world_from_node));
  }
  model.write(folder_ / "models" / fmt::format("obj_{:06}.ply", found->second));
  Json info = model.info();
  info["name"] = instance.category;
  models_[std::to_string(found->second)] = info;
  return found->second;
}

void BopWriter::add(const TakenPicture& picture, const fs::path& file, std::size_t number,
                    const std::vector<Instance>& instances) {
  SceneFiles& files = scenes_[number];
  const std::string image = std::to_string(files.cameras.size());
  const ivec2 size(picture.film.width(), picture.film.height());
  const RigidCamera rigid = matrix_of_view(picture.view, size);
  // OpenCV's axes: right, down, forwards.
  const glm::dmat4 turn(glm::dmat3({1, 0, 0}, {0, -1, 0}, {0, 0, -1}));
  const glm::dmat4 camera_from_world = turn * glm::inverse(rigid.world_from_camera);
  const Image& depth = picture.film.layers.at(Layer::depth);
  const double unit = depth_unit(depth);
  const fs::path folder = scene_folder(folder_, number);
  write_depth(folder / "depth" / file.filename(), depth, unit / kMillimetres);
  // The format's own tools take the middle of the first pixel for (0, 0).
  glm::dmat3 k = rigid.matrix.k;
  k[2] -= dvec3(0.5, 0.5, 0.0);
  const dvec3 t = kMillimetres * dvec3(camera_from_world[3]);
  files.cameras[image] = {{"cam_K", numbers(k)},
                          {"depth_scale", unit},
                          {"cam_R_w2c", numbers(glm::dmat3(camera_from_world))},
                          {"cam_t_w2c", {t.x, t.y, t.z}}};
  if (camera_.is_null()) {
    camera_ = {{"cx", k[2][0]}, {"cy", k[2][1]},    {"depth_scale", unit}, {"fx", k[0][0]},
               {"fy", k[1][1]}, {"height", size.y}, {"width", size.x}};
  }
  Json poses = Json::array(), infos = Json::array();
  for_instances(picture, instances, [&](const InstanceView& view) {
    const Scene& scene = *picture.scene;
    const bool is_node = view.instance->nodes.size() == 1;
    const glm::dmat4 world =
        is_node ? glm::dmat4(scene.nodes[static_cast<std::size_t>(view.instance->nodes[0])].world_from_node)
                : glm::dmat4(1.0);
    const Polar parts = polar(glm::dmat3(world));
    const dvec3 place = kMillimetres * dvec3(camera_from_world * glm::dvec4(dvec3(world[3]), 1.0));
    const std::string name = fmt::format("{}_{:06}.png", file.stem().string(), poses.size());
    write_mask(folder / "mask" / name, view.amodal);
    write_mask(folder / "mask_visib" / name, view.visible);
    poses.push_back({{"cam_R_m2c", numbers(glm::dmat3(camera_from_world) * parts.rotation)},
                     {"cam_t_m2c", {place.x, place.y, place.z}},
                     {"obj_id", object_of(scene, number, *view.instance, parts.stretch)}});
    const std::size_t all = count(view.amodal), seen = count(view.visible);
    std::size_t valid = 0;
    for (std::size_t i = 0; i < depth.pixels.size(); ++i)
      valid += view.amodal.bits[i] && std::isfinite(depth.pixels[i]);
    infos.push_back({{"bbox_obj", box_or_none(view.amodal)},
                     {"bbox_visib", box_or_none(view.visible)},
                     {"px_count_all", all},
                     {"px_count_valid", valid},
                     {"px_count_visib", seen},
                     {"visib_fract", all > 0 ? static_cast<double>(seen) / static_cast<double>(all) : 0.0}});
  });
  files.poses[image] = std::move(poses);
  files.infos[image] = std::move(infos);
}

void BopWriter::finish() {
  if (scenes_.empty()) return;
  for (const auto& [number, files] : scenes_) {
    const fs::path folder = scene_folder(folder_, number);
    write_json(folder / "scene_camera.json", files.cameras);
    write_json(folder / "scene_gt.json", files.poses);
    write_json(folder / "scene_gt_info.json", files.infos);
  }
  write_json(folder_ / "models" / "models_info.json", models_);
  write_json(folder_ / "camera.json", camera_);
}

}  // namespace candela
