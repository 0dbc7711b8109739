#include "objects.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "arrays.h"
#include "base/file.h"
#include "base/named_row.h"
#include "image/image_file.h"
#include "io/vertex_frames.h"

namespace candela::python {

bool is_path(nb::handle source) { return nb::isinstance<nb::str>(source) || nb::hasattr(source, "__fspath__"); }
std::string path_of(nb::handle source) {
  return nb::cast<std::string>(nb::module_::import_("os").attr("fspath")(source));
}

float read_fov(float fov_deg) {
  constexpr float kLeast = 0.01f, kMost = 179.0f;
  if (!(fov_deg >= kLeast && fov_deg <= kMost)) throw Error("lies outside 0.01 to 179", "fov_deg");
  return fov_deg * kPi / 180.0f;
}

namespace {

// ----- nodes

std::vector<bool> below(const Scene& scene, std::size_t node) {
  std::vector<bool> is_below(scene.nodes.size(), false);
  is_below[node] = true;
  // Parents may come after children.
  for (bool has_grown = true; has_grown;) {
    has_grown = false;
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
      const int parent = scene.nodes[i].parent;
      if (is_below[i] || parent < 0 || !is_below[static_cast<std::size_t>(parent)]) continue;
      is_below[i] = has_grown = true;
    }
  }
  return is_below;
}

/// What changes where a node moves.
Change change_of(const Scene& scene, std::size_t node) {
  Change change = Change::cameras;
  const std::vector<bool> moves = below(scene, node);
  for (std::size_t i = 0; i < moves.size(); ++i) {
    if (!moves[i]) continue;
    if (scene.nodes[i].mesh >= 0) return Change::all;
    if (scene.nodes[i].light >= 0) change = Change::lamps;
  }
  return change;
}

mat4 inverse_of_parent(const Scene& scene, const Node& node, const char* name) {
  if (node.parent < 0) return mat4(1.0f);
  const mat4& parent = scene.nodes[static_cast<std::size_t>(node.parent)].world_from_node;
  if (glm::determinant(mat3(parent)) == 0.0f) throw Error("the parent's transform has no inverse", name);
  return glm::inverse(parent);
}

void move_node(const NodeRef& ref, const mat4& parent_from_node) {
  Scene& scene = ref.scene->live.change(change_of(ref.scene->live.scene(), ref.index));
  scene.nodes[ref.index].parent_from_node = parent_from_node;
  update_world_transforms(scene);
}

void place_node(const NodeRef& ref, const mat4& world_from_node, const char* name) {
  const Scene& scene = ref.scene->live.scene();
  move_node(ref, inverse_of_parent(scene, scene.nodes[ref.index], name) * world_from_node);
}

/// Turns its -z towards a point, where lamps shine and cameras look; it is not scaled afterwards.
void aim_node(const NodeRef& ref, vec3 target) {
  const vec3 eye(get(ref).world_from_node[3]);
  if (eye == target) throw Error("is where the node is", "target");
  place_node(ref, look_at(eye, target, 1.0f).world_from_camera, "target");
}

template <class R>
void hold(const NodeRef& ref, int Node::*member, const std::optional<R>& held, Change change, const char* name) {
  if (held && held->scene != ref.scene) throw Error("is of another scene", name);
  ref.scene->live.change(change).nodes[ref.index].*member = held ? static_cast<int>(held->index) : -1;
}

template <class R>
std::optional<R> held(const NodeRef& ref, int Node::*member) {
  const int index = get(ref).*member;
  return index < 0 ? std::nullopt : std::optional(R{ref.scene, static_cast<std::size_t>(index)});
}

}  // namespace

mat4 transform_of(const Placed& placed) {
  if (!placed.transform.is_none()) {
    if (!placed.position.is_none() || !placed.target.is_none())
      throw Error("excludes position and target", "transform");
    return mat4(read_transform(placed.transform, "transform"));
  }
  const vec3 position = placed.position.is_none() ? vec3(0.0f) : read_vec3(placed.position, "position");
  mat4 transform(1.0f);
  transform[3] = vec4(position, 1.0f);
  if (placed.target.is_none()) return transform;
  const vec3 target = read_vec3(placed.target, "target");
  if (target == position) throw Error("is the position", "target");
  return look_at(position, target, 1.0f).world_from_camera;
}

NodeRef add_node(const SharedScene& scene, Node node, const std::optional<NodeRef>& parent, Change change) {
  if (parent) {
    if (parent->scene != scene) throw Error("is of another scene", "parent");
    node.parent = static_cast<int>(parent->index);
  }
  Scene& changed = scene->live.change(change);
  changed.nodes.push_back(std::move(node));
  update_world_transforms(changed);
  return {scene, changed.nodes.size() - 1};
}

int add_plain_material(const SharedScene& scene) {
  constexpr const char* kName = "plain";
  const auto& materials = scene->live.scene().materials;
  for (std::size_t i = 0; i < materials.size(); ++i) {
    if (materials[i].name == kName && materials[i].file_index < 0) return static_cast<int>(i);
  }
  Material material;
  material.name = kName;
  material.base_color = vec3(0.8f);
  material.metallic = 0.0f;
  Scene& changed = scene->live.change(Change::materials);
  changed.materials.push_back(std::move(material));
  return static_cast<int>(changed.materials.size() - 1);
}

namespace {

// ----- meshes

Primitive primitive_of(const MeshArrays& arrays) {
  Primitive primitive;
  primitive.positions = read_vec3s(arrays.positions, "positions");
  const std::size_t count = primitive.positions.size();
  primitive.triangles = read_triangles(arrays.triangles, "triangles", count);
  if (!arrays.uvs.is_none()) primitive.uvs[0] = read_vec2s(arrays.uvs, "uvs", count);
  if (!arrays.colors.is_none()) {
    Floats colors;
    try {
      colors = read_floats(arrays.colors, "colors", {static_cast<int>(count), 4});
    } catch (const Error&) {
      colors = read_floats(arrays.colors, "colors", {static_cast<int>(count), 3});
    }
    const std::size_t channels = colors.shape[1];
    for (std::size_t i = 0; i < count; ++i) {
      const float* c = colors.values.data() + channels * i;
      primitive.colors.emplace_back(c[0], c[1], c[2], channels == 4 ? c[3] : 1.0f);
    }
  }
  const bool is_named = nb::isinstance<nb::str>(arrays.normals);
  const std::string name = is_named ? nb::cast<std::string>(arrays.normals) : "";
  if (arrays.normals.is_none() || name == "flat") {
    io::make_flat(primitive);
    return primitive;
  }
  if (is_named && name != "smooth") throw Error("is neither \"flat\" nor \"smooth\": \"" + name + "\"", "normals");
  // Those without a direction become those of the triangles around.
  primitive.normals = is_named ? std::vector<vec3>(count, vec3(0.0f)) : read_vec3s(arrays.normals, "normals", count);
  io::normalize_normals(primitive);
  return primitive;
}

int material_index(const SharedScene& scene, const std::optional<MaterialRef>& material) {
  if (!material) return add_plain_material(scene);
  if (material->scene != scene) throw Error("is of another scene", "material");
  return static_cast<int>(material->index);
}

const Primitive& part_of(const MeshRef& ref, std::size_t part) {
  const std::vector<Primitive>& parts = get(ref).primitives;
  if (part >= parts.size()) throw nb::index_error(fmt::format("the mesh has {} parts", parts.size()).c_str());
  return parts[part];
}

}  // namespace

MeshRef add_mesh(const SharedScene& scene, const MeshArrays& arrays, const std::optional<MaterialRef>& material,
                 const std::string& name) {
  Mesh mesh;
  mesh.name = name;
  mesh.primitives.push_back(primitive_of(arrays));
  mesh.primitives[0].material = material_index(scene, material);
  mesh.identity = std::make_shared<const int>(0);
  Scene& changed = scene->live.change(Change::all);
  changed.meshes.push_back(std::move(mesh));
  return {scene, changed.meshes.size() - 1};
}

namespace {

nb::dict arrays_of(const MeshRef& ref, std::size_t part) {
  const Primitive& primitive = part_of(ref, part);
  nb::dict result;
  result["positions"] = array_of_vectors(primitive.positions);
  result["triangles"] = array_of(primitive.triangles);
  result["normals"] = array_of_vectors(primitive.normals);
  if (!primitive.uvs[0].empty()) result["uvs"] = array_of_vectors(primitive.uvs[0]);
  if (!primitive.colors.empty()) result["colors"] = array_of_vectors(primitive.colors);
  return result;
}

// ----- lights

struct LightTypeRow {
  LightType type;
  std::string_view name;
};
constexpr auto kLightTypes = std::to_array<LightTypeRow>(
    {{LightType::point, "point"}, {LightType::spot, "spot"}, {LightType::directional, "directional"}});

float number(nb::handle value, const char* name, float low, float high) {
  const double x = PyFloat_AsDouble(value.ptr());
  if (PyErr_Occurred() != nullptr) {
    PyErr_Clear();
    throw Error("is no number", name);
  }
  if (!(x >= static_cast<double>(low) && x <= static_cast<double>(high))) {
    throw Error(fmt::format("{} lies outside {:g} to {:g}", x, low, high), name);
  }
  return static_cast<float>(x);
}

constexpr float kHuge = 1e30f;

/// The numbers of a light, by the names that Python has for them.
struct LightNumber {
  const char* name;
  float Light::*member;
  float low, high;
  float unit;  ///< of Python's number
  const char* doc;
};
const auto kLightNumbers = std::to_array<LightNumber>({
    {"intensity", &Light::intensity, -kHuge, kHuge, 1.0f,
     "Candela of point and spot, lux of directional; with an IES profile its factor."},
    {"range", &Light::range, 1e-6f, kInfinity, 1.0f, "Metres; inf = none."},
    {"inner_cone_deg", &Light::inner_cone, 0.0f, 90.0f, kPi / 180.0f, "Of a spot: full light within, from its axis."},
    {"outer_cone_deg", &Light::outer_cone, 1e-3f, 90.0f, kPi / 180.0f, "Of a spot: no light beyond."},
});

void set_light_number(const LightNumber& row, nb::handle value, Light& light) {
  light.*row.member = number(value, row.name, row.low, row.high) * row.unit;
  if (!(light.inner_cone < light.outer_cone))
    throw Error("the cones must be 0 <= inner < outer <= 90 degrees", row.name);
}

}  // namespace

NodeRef add_light(const SharedScene& scene, const std::string& kind, nb::handle color, const nb::kwargs& numbers,
                  const Placed& placed, const std::string& name) {
  Light light;
  light.name = name;
  light.type = row_named(kLightTypes, kind, "kind: unknown").type;
  light.color = read_color(color, "color");
  for (const auto& [key, value] : numbers) {
    const std::string given = nb::cast<std::string>(key);
    const auto* const row =
        std::find_if(kLightNumbers.begin(), kLightNumbers.end(), [&](const LightNumber& r) { return r.name == given; });
    if (row == kLightNumbers.end()) throw Error("no light has a number of this name", given);
    set_light_number(*row, value, light);
  }
  Node node;
  node.name = name;
  node.parent_from_node = transform_of(placed);
  Scene& changed = scene->live.change(Change::lamps);
  changed.lights.push_back(std::move(light));
  node.light = static_cast<int>(changed.lights.size() - 1);
  return add_node(scene, std::move(node), std::nullopt, Change::lamps);
}

namespace {

// ----- textures

struct WrapRow {
  Wrap wrap;
  std::string_view name;
};
constexpr auto kWraps = std::to_array<WrapRow>(
    {{Wrap::repeat, "repeat"}, {Wrap::clamp_to_edge, "clamp"}, {Wrap::mirrored_repeat, "mirror"}});
struct FilterRow {
  Filter filter;
  std::string_view name;
};
constexpr auto kFilters = std::to_array<FilterRow>({{Filter::nearest, "nearest"}, {Filter::linear, "linear"}});

}  // namespace

TextureRef add_texture(const SharedScene& scene, nb::handle source, const std::string& wrap, const std::string& filter,
                       const std::string& name) {
  Texture texture;
  texture.name = name;
  texture.wrap_u = texture.wrap_v = row_named(kWraps, wrap, "wrap: unknown").wrap;
  texture.filter = row_named(kFilters, filter, "filter: unknown").filter;
  auto image = std::make_shared<TextureImage>(
      is_path(source) ? decode_texture(read_file(path_of(source)), path_of(source)) : read_texture(source, "texture"));
  Scene& changed = scene->live.change(Change::materials);
  changed.images.push_back(std::move(image));
  if (!changed.image_file_indices.empty()) {
    changed.image_file_indices.push_back(static_cast<int>(changed.images.size()) - 1);
  }
  texture.image = static_cast<int>(changed.images.size()) - 1;
  changed.textures.push_back(std::move(texture));
  return {scene, changed.textures.size() - 1};
}

int texture_of(const SharedScene& scene, nb::handle source, const std::string& name) {
  if (!nb::isinstance<TextureRef>(source)) {
    try {
      return static_cast<int>(add_texture(scene, source, "repeat", "linear", name).index);
    } catch (const Error& error) {
      throw is_path(source) ? error : Error(error.message(), name);
    }
  }
  const auto texture = nb::cast<TextureRef>(source);
  if (texture.scene != scene) throw Error("is of another scene", name);
  return static_cast<int>(texture.index);
}

namespace {

void bind_node(nb::module_& module) {
  bind_ref<NodeRef>(module, "Node", "A place in the scene, which may hold a mesh, a light, a camera.")
      .def_prop_rw(
          "name", [](const NodeRef& n) { return get(n).name; },
          [](const NodeRef& n, const std::string& name) {
            n.scene->live.change(Change::cameras).nodes[n.index].name = name;
          })
      .def_prop_ro("parent", [](const NodeRef& n) { return held<NodeRef>(n, &Node::parent); })
      .def_prop_rw(
          "transform", [](const NodeRef& n) { return array_of(glm::dmat4(get(n).parent_from_node)); },
          [](const NodeRef& n, const nb::object& t) { move_node(n, mat4(read_transform(t, "transform"))); },
          nb::for_getter(nb::sig("def transform(self) -> numpy.typing.NDArray[numpy.float64]")),
          nb::for_setter(nb::sig("def transform(self, value: numpy.typing.ArrayLike) -> None")),
          "(4, 4), parent from node, metres. What is read is a copy.")
      .def_prop_rw(
          "world_from_node", [](const NodeRef& n) { return array_of(glm::dmat4(get(n).world_from_node)); },
          [](const NodeRef& n, const nb::object& t) {
            place_node(n, mat4(read_transform(t, "world_from_node")), "world_from_node");
          },
          nb::for_getter(nb::sig("def world_from_node(self) -> numpy.typing.NDArray[numpy.float64]")),
          nb::for_setter(nb::sig("def world_from_node(self, value: numpy.typing.ArrayLike) -> None")),
          "(4, 4), metres. What is read is a copy.")
      .def_prop_rw(
          "position",
          [](const NodeRef& n) {
            const vec3 p(get(n).world_from_node[3]);
            return nb::make_tuple(p.x, p.y, p.z);
          },
          [](const NodeRef& n, const nb::object& p) {
            mat4 moved = get(n).world_from_node;
            moved[3] = vec4(read_vec3(p, "position"), 1.0f);
            place_node(n, moved, "position");
          },
          nb::for_getter(nb::sig("def position(self) -> tuple[float, float, float]")),
          nb::for_setter(nb::sig("def position(self, value: numpy.typing.ArrayLike) -> None")), "In the world, metres.")
      .def(
          "look_at", [](const NodeRef& n, const nb::object& target) { aim_node(n, read_vec3(target, "target")); },
          nb::arg("target"), nb::sig("def look_at(self, target: numpy.typing.ArrayLike) -> None"),
          "Turns the node's -z, where lamps shine and cameras look, towards a point of the world.")
      .def_prop_rw(
          "mesh", [](const NodeRef& n) { return held<MeshRef>(n, &Node::mesh); },
          [](const NodeRef& n, const std::optional<MeshRef>& m) { hold(n, &Node::mesh, m, Change::all, "mesh"); },
          nb::arg("value").none(), "None takes it away.")
      .def_prop_rw(
          "light", [](const NodeRef& n) { return held<LightRef>(n, &Node::light); },
          [](const NodeRef& n, const std::optional<LightRef>& l) { hold(n, &Node::light, l, Change::lamps, "light"); },
          nb::arg("value").none(), "None takes it away.")
      .def_prop_rw(
          "camera", [](const NodeRef& n) { return held<CameraRef>(n, &Node::camera); },
          [](const NodeRef& n, const std::optional<CameraRef>& c) {
            hold(n, &Node::camera, c, Change::cameras, "camera");
          },
          nb::arg("value").none(), "None takes it away.")
      .def_prop_ro(
          "number", [](const NodeRef& n) { return number_of(n.scene->live.scene().nodes, n.index); },
          "Its file's, else its place: what the layer \"id\" holds, less 1.");
}

void bind_mesh(nb::module_& module) {
  bind_ref<MeshRef>(module, "Mesh", "Triangles, in parts of one material each. Nodes place it.")
      .def_prop_ro("name", [](const MeshRef& m) { return get(m).name; })
      .def(
          "__len__", [](const MeshRef& m) { return get(m).primitives.size(); }, "The number of its parts.")
      .def("arrays", &arrays_of, nb::arg("part") = 0,
           nb::sig("def arrays(self, part: int = 0) -> dict[str, numpy.typing.NDArray[typing.Any]]"),
           "Copies: positions (n, 3), normals (n, 3) float32, triangles (m, 3) uint32, and uvs (n, 2), colors (n, 4) "
           "float32 where it has "
           "them.")
      .def(
          "set",
          [](const MeshRef& m, const nb::object& positions, const nb::object& triangles, const nb::object& normals,
             const nb::object& uvs, const nb::object& colors, std::size_t part) {
            Primitive primitive = primitive_of({positions, triangles, normals, uvs, colors});
            primitive.material = part_of(m, part).material;
            m.scene->live.change_mesh(m.index).primitives[part] = std::move(primitive);
          },
          nb::arg("positions"), nb::arg("triangles"), nb::kw_only(), nb::arg("normals") = nb::none(),
          nb::arg("uvs") = nb::none(), nb::arg("colors") = nb::none(), nb::arg("part") = 0,
          nb::sig("def set(self, positions: numpy.typing.ArrayLike, triangles: numpy.typing.ArrayLike, *, normals: "
                  "numpy.typing.ArrayLike | None = None, uvs: numpy.typing.ArrayLike | None = None, colors: "
                  "numpy.typing.ArrayLike | None = None, part: int = 0) -> None"),
          "Another shape for a part; its material stays. Arrays as of Scene.add_mesh().")
      .def(
          "material",
          [](const MeshRef& m, std::size_t part) {
            return MaterialRef{m.scene, static_cast<std::size_t>(part_of(m, part).material)};
          },
          nb::arg("part") = 0, "That of a part.")
      .def(
          "set_material",
          [](const MeshRef& m, const MaterialRef& material, std::size_t part) {
            part_of(m, part);
            const int index = material_index(m.scene, material);
            m.scene->live.change_mesh(m.index).primitives[part].material = index;
          },
          nb::arg("material"), nb::arg("part") = 0, "Gives a part another material of the same scene.");
}

void bind_light(nb::module_& module) {
  auto type =
      bind_ref<LightRef>(module, "Light", "A lamp without a size; its node says where it is and shines along its -z.");
  type.def_prop_ro("name", [](const LightRef& l) { return get(l).name; })
      .def_prop_ro(
          "kind",
          [](const LightRef& l) {
            for (const LightTypeRow& row : kLightTypes) {
              if (row.type == get(l).type) return std::string(row.name);
            }
            return std::string();
          },
          "\"point\", \"spot\" or \"directional\".")
      .def_prop_rw(
          "color",
          [](const LightRef& l) {
            const vec3 c = get(l).color;
            return nb::make_tuple(c.x, c.y, c.z);
          },
          [](const LightRef& l, const nb::object& color) {
            const vec3 read = read_color(color, "color");
            l.scene->live.change(Change::lamps).lights[l.index].color = read;
          },
          nb::for_getter(nb::sig("def color(self) -> tuple[float, float, float]")),
          nb::for_setter(nb::sig("def color(self, value: numpy.typing.ArrayLike) -> None")), "Linear.");
  for (const LightNumber& row : kLightNumbers) {
    const std::string setter = std::string("def ") + row.name + "(self, value: float) -> None";
    type.def_prop_rw(
        row.name, [&row](const LightRef& l) { return get(l).*row.member / row.unit; },
        [&row](const LightRef& l, const nb::object& value) {
          Light changed = get(l);
          set_light_number(row, value, changed);
          l.scene->live.change(Change::lamps).lights[l.index] = std::move(changed);
        },
        nb::for_setter(nb::sig(setter.c_str())), row.doc);
  }
}

void bind_camera(nb::module_& module) {
  bind_ref<CameraRef>(module, "Camera", "A camera of the scene; its node says where it is and looks along its -z.")
      .def_prop_ro("name", [](const CameraRef& c) { return get(c).name; })
      .def_prop_rw(
          "fov_deg",
          [](const CameraRef& c) -> std::optional<float> {
            const auto* perspective = std::get_if<PerspectiveCamera>(&get(c).projection);
            return perspective == nullptr ? std::nullopt : std::optional(degrees(perspective->yfov));
          },
          [](const CameraRef& c, float fov_deg) {
            const float yfov = read_fov(fov_deg);
            c.scene->live.change(Change::cameras).cameras[c.index].projection =
                PerspectiveCamera{.yfov = yfov, .aspect_ratio = {}};
          },
          "The full vertical angle; None of an orthographic camera.");
}

}  // namespace

void bind_objects(nb::module_& module) {
  auto material = bind_ref<MaterialRef>(module, "Material",
                                        "What a surface does with light: glTF's metallic-roughness and its extensions. "
                                        "Colours are linear.");
  bind_ref<TextureRef>(module, "Texture", "An image as materials use it.")
      .def_prop_ro("name", [](const TextureRef& t) { return get(t).name; })
      .def_prop_ro(
          "size",
          [](const TextureRef& t) {
            const Scene& scene = t.scene->live.scene();
            const TextureImage& image = *scene.images[static_cast<std::size_t>(get(t).image)];
            return std::pair(image.width, image.height);
          },
          nb::sig("def size(self) -> tuple[int, int]"), "(width, height), texels.");
  material.def_prop_ro("name", [](const MaterialRef& m) { return get(m).name; });
  bind_material(material);
  bind_light(module);
  bind_camera(module);
  bind_mesh(module);
  bind_node(module);
  bind_list<NodeRef>(module, "NodeList", "Node");
  bind_list<MeshRef>(module, "MeshList", "Mesh");
  bind_list<MaterialRef>(module, "MaterialList", "Material");
  bind_list<TextureRef>(module, "TextureList", "Texture");
  bind_list<LightRef>(module, "LightList", "Light");
  bind_list<CameraRef>(module, "CameraList", "Camera");
}

}  // namespace candela::python
