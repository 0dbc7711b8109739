#include "scene.h"

#include <fmt/format.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <utility>

#include "arrays.h"
#include "background.h"
#include "io/gltf.h"
#include "objects.h"
#include "scene/environment.h"

namespace candela::python {

namespace {

std::shared_ptr<LiveStage>& stage_slot() {
  static auto* const stage = new std::shared_ptr<LiveStage>(std::make_shared<LiveStage>());  // outlives static objects
  return *stage;
}

// ----- environments

EnvironmentOf environment_from(nb::handle source, const std::string& name) {
  auto environment = std::make_shared<Environment>();
  Floats floats = read_floats(source, name, {-1, -1, 3});
  const float lowest = floats.values.empty() ? 0.0f : *std::min_element(floats.values.begin(), floats.values.end());
  if (lowest < 0.0f) throw Error("has negative radiance", name);
  auto map = std::make_shared<Image>();
  map->height = static_cast<int>(floats.shape[0]);
  map->width = static_cast<int>(floats.shape[1]);
  map->channels = 3;
  map->pixels = std::move(floats.values);
  check_panorama(*map, name);
  environment->name = "array";
  environment->map = std::move(map);
  return {std::move(environment)};
}

EnvironmentOf load_environment(nb::handle source) {
  if (nb::isinstance<EnvironmentOf>(source)) return nb::cast<EnvironmentOf>(source);
  if (!is_path(source)) return environment_from(source, "environment");
  const std::string path = path_of(source);
  EnvironmentOf result;
  Diagnostics diagnostics;
  run_in_background(nb::none(), [&](const Job&) { result.environment = the_stage()->environment(path, &diagnostics); });
  tell_warnings(diagnostics);
  return result;
}

// ----- files

struct LoadArguments {
  std::string variant, scene, root;
  std::optional<std::string> animation;
  std::optional<double> time;
  std::uint64_t texture_memory = 0;
};

SharedScene load_scene(nb::handle source, const LoadArguments& arguments, const nb::object& progress) {
  LoadOptions options;
  options.variant = arguments.variant;
  options.scene = arguments.scene;
  options.root = arguments.root;
  options.texture_memory = arguments.texture_memory;
  std::optional<Pose> pose;
  if (arguments.time || arguments.animation)
    pose = Pose{arguments.animation.value_or(""), arguments.time.value_or(0.0)};
  std::vector<std::byte> bytes;
  const bool is_memory = !is_path(source);
  if (is_memory) {
    Py_buffer view;
    if (PyObject_GetBuffer(source.ptr(), &view, PyBUF_SIMPLE) != 0) {
      PyErr_Clear();
      throw Error("is neither a path nor bytes", "source");
    }
    const auto* const begin = static_cast<const std::byte*>(view.buf);
    bytes.assign(begin, begin + view.len);
    PyBuffer_Release(&view);
  }
  const std::string path = is_memory ? "" : path_of(source);
  Diagnostics diagnostics;
  io::FileInfo info;
  std::optional<Scene> scene;
  run_in_background(progress, [&](const Job&) {
    if (is_memory) {
      io::GltfFile file(std::move(bytes), {}, "glTF in memory", diagnostics, options, &info);
      scene = file.scene(diagnostics, pose);
    } else {
      Asset asset(path, &diagnostics, options);
      scene = asset.scene(pose);
      info = asset.info();
    }
  });
  auto result = std::make_shared<SceneOf>(std::move(*scene), the_stage());
  result->file = path;
  result->variants = info.variants;
  for (const io::AnimationInfo& animation : info.animations) result->animations.push_back(animation.name);
  tell_warnings(diagnostics);
  return result;
}

}  // namespace

std::shared_ptr<LiveStage> the_stage() {
  refuse_after_the_end();
  return stage_slot();
}
void forget_stage() { stage_slot().reset(); }

namespace {

#define CANDELA_PLACE                                                                                         \
  "position: numpy.typing.ArrayLike | None = None, target: numpy.typing.ArrayLike | None = None, transform: " \
  "numpy.typing.ArrayLike | None = None, name: str = ''"

void bind_scene_class(nb::module_& module) {
  nb::class_<SceneOf> type(
      module, "Scene",
      "What there is to see: nodes that hold meshes, lights and cameras; materials. Metres, "
      "right-handed, +y up. It may be changed between pictures; what a change does not touch is not "
      "prepared again. One thread at a time may change it; others may render it meanwhile, and see "
      "it as it was.");
  type.def(nb::new_([](const std::string& name) {
             Scene scene;
             scene.name = name;
             auto made = std::make_shared<SceneOf>(std::move(scene), the_stage());
             add_plain_material(made);
             return made;
           }),
           nb::arg("name") = "", "A scene without anything in it but a material, a matt grey.")
      .def(
          "copy",
          [](const SharedScene& s) {
            auto copy = std::make_shared<SceneOf>(s->live.scene(), the_stage());
            copy->environment = s->environment;
            copy->environment_name = s->environment_name;
            copy->variants = s->variants;
            copy->animations = s->animations;
            copy->file = s->file;
            return copy;
          },
          "Another scene that is the same.")
      .def_prop_ro("name", [](const SharedScene& s) { return s->live.scene().name; })
      .def_prop_ro("nodes", [](const SharedScene& s) { return List<NodeRef>{s}; })
      .def_prop_ro("meshes", [](const SharedScene& s) { return List<MeshRef>{s}; })
      .def_prop_ro("materials", [](const SharedScene& s) { return List<MaterialRef>{s}; })
      .def_prop_ro("textures", [](const SharedScene& s) { return List<TextureRef>{s}; })
      .def_prop_ro("lights", [](const SharedScene& s) { return List<LightRef>{s}; })
      .def_prop_ro("cameras", [](const SharedScene& s) { return List<CameraRef>{s}; })
      .def_prop_ro(
          "variants", [](const SharedScene& s) { return s->variants; }, "The looks that its file has: load(variant=…).")
      .def_prop_ro(
          "animations", [](const SharedScene& s) { return s->animations; },
          "The animations that its file has: load(animation=…, time=…).")
      .def_prop_ro(
          "bounds",
          [](const SharedScene& s) {
            const Box3 box = world_bounds(s->live.scene());
            if (box.empty()) throw Error("nothing in the scene has a mesh", "bounds");
            return nb::make_tuple(nb::make_tuple(box.lower.x, box.lower.y, box.lower.z),
                                  nb::make_tuple(box.upper.x, box.upper.y, box.upper.z));
          },
          nb::sig("def bounds(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]"),
          "The lowest and the highest corner of all meshes, in the world, metres. Raises Error where there is none.")
      .def_prop_rw(
          "environment",
          [](const SharedScene& s) -> nb::object {
            if (s->environment) return nb::cast(*s->environment);
            return s->environment_name ? nb::object(nb::str(s->environment_name->c_str())) : nb::object(nb::none());
          },
          [](const SharedScene& s, const nb::object& source) {
            std::optional<std::string> name;
            std::optional<EnvironmentOf> environment;
            if (!source.is_none() && is_path(source)) {
              name = path_of(source);
              check_environment_name(*name);
            } else if (!source.is_none()) {
              environment = load_environment(source);
            }
            s->environment_name = std::move(name);
            s->environment = std::move(environment);
          },
          nb::arg("value").none(), nb::for_getter(nb::sig("def environment(self) -> Environment | str | None")),
          nb::for_setter(nb::sig("def environment(self, value: Environment | str | os.PathLike[str] | "
                                 "numpy.typing.ArrayLike | None) -> None")),
          "What render() is lit by unless it is told otherwise; None: what the file asks for, else a studio.")
      .def("__repr__", [](const SharedScene& s) {
        const Scene& scene = s->live.scene();
        return fmt::format("Scene('{}': {} nodes, {} meshes, {} materials, {} lights, {} cameras)", scene.name,
                           scene.nodes.size(), scene.meshes.size(), scene.materials.size(), scene.lights.size(),
                           scene.cameras.size());
      });
  type.def(
          "add_mesh",
          [](const SharedScene& s, const nb::object& positions, const nb::object& triangles, const nb::object& normals,
             const nb::object& uvs, const nb::object& colors, const std::optional<MaterialRef>& material,
             const std::string& name) {
            return add_mesh(s, {positions, triangles, normals, uvs, colors}, material, name);
          },
          nb::arg("positions"), nb::arg("triangles"), nb::kw_only(), nb::arg("normals") = nb::none(),
          nb::arg("uvs") = nb::none(), nb::arg("colors") = nb::none(), nb::arg("material") = nb::none(),
          nb::arg("name") = "",
          nb::sig(
              "def add_mesh(self, positions: numpy.typing.ArrayLike, triangles: numpy.typing.ArrayLike, *, normals: "
              "numpy.typing.ArrayLike | None = None, uvs: numpy.typing.ArrayLike | None = None, colors: "
              "numpy.typing.ArrayLike | None = None, material: Material | None = None, name: str = '') -> Mesh"),
          "A mesh of arrays, which are copied. Scene.add() places it.\n\n"
          "positions: (n, 3), metres. triangles: (m, 3), indices, counter-clockwise seen from outside.\n"
          "normals: (n, 3), \"flat\" or \"smooth\"; None = flat: every triangle gets vertices of its own.\n"
          "uvs: (n, 2), v downwards. colors: (n, 3) or (n, 4), linear, multiply the base colour.\n"
          "material: None = a matt grey.\n\n"
          "Raises Error that names the array for a wrong shape or dtype, and for numbers that are not finite.")
      .def(
          "add",
          [](const SharedScene& s, const MeshRef& mesh, const nb::object& transform, const nb::object& position,
             const std::optional<NodeRef>& parent, const std::string& name) {
            if (mesh.scene != s) throw Error("is of another scene", "mesh");
            Node node;
            node.name = name.empty() ? get(mesh).name : name;
            node.mesh = static_cast<int>(mesh.index);
            node.parent_from_node = transform_of({transform, position, nb::none()});
            return add_node(s, std::move(node), parent, Change::all);
          },
          nb::arg("mesh"), nb::kw_only(), nb::arg("transform") = nb::none(), nb::arg("position") = nb::none(),
          nb::arg("parent") = nb::none(), nb::arg("name") = "",
          nb::sig("def add(self, mesh: Mesh, *, transform: numpy.typing.ArrayLike | None = None, position: "
                  "numpy.typing.ArrayLike | None = None, parent: Node | None = None, name: str = '') -> Node"),
          "Places a mesh: a node with it, at a (4, 4) transform, or a position, of its parent. A mesh may have many.")
      .def(
          "add_node",
          [](const SharedScene& s, const nb::object& transform, const nb::object& position,
             const std::optional<NodeRef>& parent, const std::string& name) {
            Node node;
            node.name = name;
            node.parent_from_node = transform_of({transform, position, nb::none()});
            return add_node(s, std::move(node), parent, Change::cameras);
          },
          nb::kw_only(), nb::arg("transform") = nb::none(), nb::arg("position") = nb::none(),
          nb::arg("parent") = nb::none(), nb::arg("name") = "",
          nb::sig("def add_node(self, *, transform: numpy.typing.ArrayLike | None = None, position: "
                  "numpy.typing.ArrayLike | None = None, parent: Node | None = None, name: str = '') -> Node"),
          "A node that holds nothing, to be a parent.")
      .def(
          "add_material",
          [](const SharedScene& s, const std::string& name, const nb::kwargs& properties) {
            Material material;
            material.name = name;
            material.metallic = 0.0f;
            set_properties(s, material, properties);
            Scene& changed = s->live.change(Change::materials);
            changed.materials.push_back(std::move(material));
            return MaterialRef{s, changed.materials.size() - 1};
          },
          nb::arg("name") = "", nb::arg("properties"),
          nb::sig("def add_material(self, name: str = '', **properties: object) -> Material"),
          "A material; what it may be told is Material's properties. What it is not told is glTF's default, except "
          "metallic, which is 0. Raises Error.")
      .def(
          "add_texture",
          [](const SharedScene& s, const nb::object& source, const std::string& wrap, const std::string& filter,
             const std::string& name) { return add_texture(s, source, wrap, filter, name); },
          nb::arg("source"), nb::kw_only(), nb::arg("wrap") = "repeat", nb::arg("filter") = "linear",
          nb::arg("name") = "",
          nb::sig(
              "def add_texture(self, source: str | os.PathLike[str] | numpy.typing.ArrayLike, *, wrap: str = 'repeat', "
              "filter: str = 'linear', name: str = '') -> Texture"),
          "A texture of an image file, or of an array (h, w), (h, w, 3) or (h, w, 4) of uint8, uint16 or floats from 0 "
          "to 1, row 0 at the top; encoded as files are: colours in sRGB.\n\n"
          "wrap: \"repeat\", \"clamp\" or \"mirror\". filter: \"linear\" or \"nearest\".")
      .def(
          "add_light",
          [](const SharedScene& s, const std::string& kind, const nb::object& color, const nb::object& position,
             const nb::object& target, const nb::object& transform, const std::string& name,
             const nb::kwargs& numbers) {
            return add_light(s, kind, color, numbers, {transform, position, target}, name);
          },
          nb::arg("kind") = "point", nb::kw_only(), nb::arg("color") = nb::make_tuple(1.0, 1.0, 1.0),
          nb::arg("position") = nb::none(), nb::arg("target") = nb::none(), nb::arg("transform") = nb::none(),
          nb::arg("name") = "", nb::arg("numbers"),
          nb::sig("def add_light(self, kind: str = 'point', *, color: numpy.typing.ArrayLike = (1.0, 1.0, "
                  "1.0), " CANDELA_PLACE ", **numbers: float) -> Node"),
          "A lamp and its node: \"point\", \"spot\" or \"directional\", at a position, or shining from there to a "
          "target, or "
          "by a (4, 4) transform along its -z. numbers: intensity, range, inner_cone_deg, outer_cone_deg, as Light has "
          "them.")
      .def(
          "add_camera",
          [](const SharedScene& s, const std::string& name, float fov_deg, const nb::object& position,
             const nb::object& target, const nb::object& transform) {
            Camera camera;
            camera.name = name;
            camera.projection = PerspectiveCamera{.yfov = read_fov(fov_deg), .aspect_ratio = {}};
            Node node;
            node.name = name;
            node.parent_from_node = transform_of({transform, position, target});
            Scene& changed = s->live.change(Change::cameras);
            changed.cameras.push_back(std::move(camera));
            node.camera = static_cast<int>(changed.cameras.size() - 1);
            return add_node(s, std::move(node), std::nullopt, Change::cameras);
          },
          nb::arg("name"), nb::kw_only(), nb::arg("fov_deg") = 45.0f, nb::arg("position") = nb::none(),
          nb::arg("target") = nb::none(), nb::arg("transform") = nb::none(),
          nb::sig(
              "def add_camera(self, name: str, *, fov_deg: float = 45.0, position: numpy.typing.ArrayLike | None = "
              "None, target: numpy.typing.ArrayLike | None = None, transform: numpy.typing.ArrayLike | None = None) "
              "-> Node"),
          "A camera and its node, for render(camera=name).");
}

}  // namespace

void bind_scene(nb::module_& module) {
  nb::class_<EnvironmentOf>(module, "Environment", "Light from infinitely far away.")
      .def_prop_ro("name", [](const EnvironmentOf& e) { return e.environment->name; })
      .def("__repr__", [](const EnvironmentOf& e) { return "Environment('" + e.environment->name + "')"; });
  bind_objects(module);
  bind_scene_class(module);

  module.def(
      "load",
      [](const nb::object& source, const std::string& variant, const std::string& scene,
         const std::optional<std::string>& animation, std::optional<double> time, const std::string& root,
         std::uint64_t texture_memory) {
        return load_scene(source, {variant, scene, root, animation, time, texture_memory}, nb::none());
      },
      nb::arg("source"), nb::arg("variant"), nb::arg("scene"), nb::arg("animation").none(), nb::arg("time").none(),
      nb::arg("root"), nb::arg("texture_memory"),
      nb::sig("def load(source: str | os.PathLike[str] | bytes | bytearray | memoryview, variant: str, scene: str, "
              "animation: "
              "str | None, time: float | "
              "None, root: str, texture_memory: int) -> Scene"));
  module.def(
      "environment", &load_environment, nb::arg("source"),
      nb::sig("def environment(source: Environment | str | os.PathLike[str] | numpy.typing.ArrayLike) -> Environment"));
}

}  // namespace candela::python
