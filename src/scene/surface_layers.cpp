#include "scene/surface_layers.h"

#include <algorithm>
#include <set>
#include <string>

#include "base/error.h"
#include "base/parallel.h"
#include "scene/posed_camera.h"

namespace candela {

namespace {

const Primitive& primitive_of(const Scene& scene, int node, int primitive) {
  const Node& n = scene.nodes[static_cast<std::size_t>(node)];
  return scene.meshes[static_cast<std::size_t>(n.mesh)].primitives[static_cast<std::size_t>(primitive)];
}

template <class V>
V mean_at(const std::vector<V>& values, const uvec3& t, vec2 b) {
  return values[t.x] * (1.0f - b.x - b.y) + values[t.y] * b.x + values[t.z] * b.y;
}

/// Where a view has points of the world.
class Projector {
 public:
  Projector(const View& view, ivec2 size)
      : camera_from_world_(glm::inverse(glm::dmat4(view.world_from_camera))), size_(size) {
    const double aspect = static_cast<double>(size.x) / static_cast<double>(size.y);
    if (const auto* perspective = std::get_if<PerspectiveCamera>(&view.projection)) {
      const double half = std::tan(0.5 * static_cast<double>(perspective->yfov));
      half_ = {half * aspect, half};
    } else {
      const auto& orthographic = std::get<OrthographicCamera>(view.projection);
      half_ = {orthographic.xmag, orthographic.ymag};
      is_orthographic_ = true;
    }
  }

  /// Pixels from the top left corner; nothing behind the eye.
  std::optional<dvec2> operator()(vec3 world) const {
    const dvec3 p(camera_from_world_ * glm::dvec4(world, 1.0));
    if (!is_orthographic_ && !(p.z < 0.0)) return std::nullopt;
    const dvec2 ndc = dvec2(p) / half_ / (is_orthographic_ ? 1.0 : -p.z);
    return 0.5 * dvec2(size_) * dvec2(1.0 + ndc.x, 1.0 - ndc.y);
  }

 private:
  glm::dmat4 camera_from_world_;
  dvec2 half_{1.0};
  ivec2 size_;
  bool is_orthographic_ = false;
};

/// The number that each index of a list has in a layer.
template <class T>
float layer_number(const std::vector<T>& list, int index) {
  return static_cast<float>(number_of(list, static_cast<std::size_t>(index)) + 1);
}

/// Of what is met, in the channels of the layer.
vec3 value_of(const Scene& scene, const SurfaceSample& s, Layer layer) {
  const auto mesh = [&] { return scene.nodes[static_cast<std::size_t>(s.node)].mesh; };
  switch (layer) {
    case Layer::position:
      return s.position;
    case Layer::uv:
      return {s.uv, 0.0f};
    case Layer::object_id:
      return vec3(layer_number(scene.nodes, s.node));
    case Layer::instance:
      return vec3(static_cast<float>(s.node + 1));
    case Layer::mesh:
      return vec3(layer_number(scene.meshes, mesh()));
    case Layer::material:
      return vec3(layer_number(scene.materials, material_of(scene, s)));
    case Layer::face:
      return vec3(static_cast<float>(s.triangle + 1));
    default:
      return vec3(0.0f);
  }
}

}  // namespace

vec3 position_at(const Scene& scene, int node, int primitive, std::uint32_t triangle, vec2 barycentric) {
  const Primitive& p = primitive_of(scene, node, primitive);
  const vec3 local = mean_at(p.positions, p.triangles[triangle], barycentric);
  return transform_point(scene.nodes[static_cast<std::size_t>(node)].world_from_node, local);
}

vec2 uv_at(const Scene& scene, int node, int primitive, std::uint32_t triangle, vec2 barycentric) {
  const Primitive& p = primitive_of(scene, node, primitive);
  return p.uvs[0].empty() ? vec2(0.0f) : mean_at(p.uvs[0], p.triangles[triangle], barycentric);
}

int material_of(const Scene& scene, const SurfaceSample& s) {
  return primitive_of(scene, s.node, s.primitive).material;
}

void add_surface_layers(const Scene& scene, const View& view, const SurfaceMap& map, const std::set<Layer>& layers,
                        Film& film) {
  const dvec3 eye(view.world_from_camera[3]), back(camera_rotation(view)[2]);
  const bool is_orthographic = std::holds_alternative<OrthographicCamera>(view.projection);
  const auto value = [&](const SurfaceSample& s, Layer layer) {
    const dvec3 from_eye = dvec3(s.position) - eye;
    const bool is_along_axis = layer == Layer::depth || (layer == Layer::distance && is_orthographic);
    if (is_along_axis) return vec3(static_cast<float>(-glm::dot(from_eye, back)));
    if (layer == Layer::distance) return vec3(static_cast<float>(glm::length(from_eye)));
    return value_of(scene, s, layer);
  };
  for (const Layer layer : layers) {
    const LayerInfo& info = layer_info(layer);
    if (info.has_mean || layer == Layer::motion) continue;
    const int channels = layer_channels(layer);
    Image image(map.width, map.height, channels);
    parallel_for(0, static_cast<std::size_t>(map.height), 4, [&](std::size_t begin, std::size_t end) {
      for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
        for (int x = 0; x < map.width; ++x) {
          const SurfaceSample& s = map.at(x, y);
          const vec3 v = s.node < 0 ? vec3(info.nothing) : value(s, layer);
          for (int c = 0; c < channels; ++c) image.at(x, y)[static_cast<std::size_t>(c)] = v[c];
        }
      }
    });
    film.layers[layer] = std::move(image);
  }
}

Image motion_layer(const Scene& scene, const View& view, const SurfaceMap& map, const Scene& next,
                   const View& next_view) {
  const ivec2 size(map.width, map.height);
  const Projector here(view, size), there(next_view, size);
  Image motion(map.width, map.height, 2);
  const auto has = [&](const SurfaceSample& s) {
    if (static_cast<std::size_t>(s.node) >= next.nodes.size()) return false;
    const int mesh = next.nodes[static_cast<std::size_t>(s.node)].mesh;
    if (mesh < 0) return false;
    const auto& primitives = next.meshes[static_cast<std::size_t>(mesh)].primitives;
    return static_cast<std::size_t>(s.primitive) < primitives.size() &&
           s.triangle < primitives[static_cast<std::size_t>(s.primitive)].triangles.size();
  };
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      const SurfaceSample& s = map.at(x, y);
      if (s.node < 0 || !has(s)) continue;
      // A relief goes along with the surface that it stands on.
      const vec3 moved = s.position + (position_at(next, s.node, s.primitive, s.triangle, s.barycentric) -
                                       position_at(scene, s.node, s.primitive, s.triangle, s.barycentric));
      const auto from = here(s.position), to = there(moved);
      if (!from || !to) continue;
      motion.at(x, y)[0] = static_cast<float>(to->x - from->x);
      motion.at(x, y)[1] = static_cast<float>(to->y - from->y);
    }
  }
  return motion;
}

void turn_to_camera(const View& view, Image& normals) { turn(glm::transpose(mat3(camera_rotation(view))), normals); }

void turn(const mat3& rotation, Image& normals) {
  for (int y = 0; y < normals.height; ++y) {
    for (int x = 0; x < normals.width; ++x) normals.set_rgb(x, y, rotation * normals.rgb(x, y));
  }
}

namespace {

/// `known`: which of a list need a name.
template <class T, class Known>
std::map<std::uint32_t, std::string> names_of_list(const std::vector<T>& list, const std::string& kind, Known known) {
  std::map<std::string, int> uses;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (known(list[i])) ++uses[list[i].name];
  }
  std::map<std::uint32_t, std::string> names;
  std::set<std::string> taken;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (!known(list[i])) continue;
    const std::string number = std::to_string(number_of(list, i));
    std::string name = list[i].name;
    if (name.empty()) name = kind + " " + number;
    if (!list[i].name.empty() && uses[list[i].name] > 1) name += "." + number;
    // The instances of a node have one number, and a name may look like a number.
    for (std::string base = name; !taken.insert(name).second;) name = base + "." + std::to_string(taken.size());
    names[static_cast<std::uint32_t>(i)] = name;
  }
  return names;
}

}  // namespace

std::map<std::uint32_t, std::string> matte_names(const Scene& scene, MatteKind kind) {
  if (kind == MatteKind::material)
    return names_of_list(scene.materials, "material", [](const Material&) { return true; });
  return names_of_list(scene.nodes, "node", [](const Node& node) { return node.mesh >= 0; });
}

void check_numbers(const Scene& scene, const std::set<Layer>& layers) {
  const auto check = [&](Layer layer, std::size_t most) {
    if (layers.contains(layer) && most > kLargestNumber) {
      throw Error("layer \"" + std::string(layer_name(layer)) + "\" has numbers up to " + std::to_string(most) +
                      ", of which floats hold those up to " + std::to_string(kLargestNumber),
                  scene.name);
    }
  };
  const auto largest = [](const auto& list) {
    std::size_t most = list.size();
    for (std::size_t i = 0; i < list.size(); ++i)
      most = std::max(most, static_cast<std::size_t>(number_of(list, i)) + 1);
    return most;
  };
  check(Layer::object_id, largest(scene.nodes));
  check(Layer::instance, scene.nodes.size());
  check(Layer::mesh, largest(scene.meshes));
  check(Layer::material, largest(scene.materials));
  for (const Mesh& mesh : scene.meshes) {
    for (const Primitive& p : mesh.primitives) check(Layer::face, p.triangles.size());
  }
}

}  // namespace candela
