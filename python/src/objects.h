#pragma once

#include <fmt/format.h>
#include <nanobind/nanobind.h>

#include <functional>
#include <optional>
#include <string>

#include "base/error.h"
#include "scene.h"

/// The objects of a scene as Python has them: by their places, so that they are what the scene says at any time.
namespace candela::python {

template <class R>
struct Kind;
template <>
struct Kind<NodeRef> {
  static constexpr const char* kName = "node";
  static auto& of(const Scene& s) { return s.nodes; }
};
template <>
struct Kind<MeshRef> {
  static constexpr const char* kName = "mesh";
  static auto& of(const Scene& s) { return s.meshes; }
};
template <>
struct Kind<MaterialRef> {
  static constexpr const char* kName = "material";
  static auto& of(const Scene& s) { return s.materials; }
};
template <>
struct Kind<TextureRef> {
  static constexpr const char* kName = "texture";
  static auto& of(const Scene& s) { return s.textures; }
};
template <>
struct Kind<LightRef> {
  static constexpr const char* kName = "light";
  static auto& of(const Scene& s) { return s.lights; }
};
template <>
struct Kind<CameraRef> {
  static constexpr const char* kName = "camera";
  static auto& of(const Scene& s) { return s.cameras; }
};

template <class R>
const auto& get(const R& ref) {
  return Kind<R>::of(ref.scene->live.scene())[ref.index];
}

template <class R>
struct List {
  SharedScene scene;
};

template <class R>
R item(const List<R>& list, nb::handle key) {
  const auto& objects = Kind<R>::of(list.scene->live.scene());
  if (nb::isinstance<nb::str>(key)) {
    const std::string name = nb::cast<std::string>(key);
    std::string known;
    for (std::size_t i = 0; i < objects.size(); ++i) {
      if (objects[i].name == name) return {list.scene, i};
      if (!objects[i].name.empty()) known += (known.empty() ? "" : ", ") + objects[i].name;
    }
    throw Error(fmt::format("there is no {} '{}'; the scene has: {}", Kind<R>::kName, name,
                            known.empty() ? "none with a name" : known));
  }
  const auto count = static_cast<std::int64_t>(objects.size());
  std::int64_t index = nb::cast<std::int64_t>(key);
  if (index < 0) index += count;
  if (index < 0 || index >= count) {
    throw nb::index_error(fmt::format("the scene has {} of these", count).c_str());
  }
  return {list.scene, static_cast<std::size_t>(index)};
}

template <class R>
nb::list items(const List<R>& list) {
  nb::list result;
  for (std::size_t i = 0; i < Kind<R>::of(list.scene->live.scene()).size(); ++i) result.append(R{list.scene, i});
  return result;
}

template <class R>
void bind_list(nb::module_& module, const char* list_name, const std::string& item_name) {
  const std::string get_sig = "def __getitem__(self, key: int | str) -> " + item_name;
  const std::string iter_sig = "def __iter__(self) -> collections.abc.Iterator[" + item_name + "]";
  nb::class_<List<R>>(module, list_name)
      .def("__len__", [](const List<R>& l) { return Kind<R>::of(l.scene->live.scene()).size(); })
      .def("__getitem__", &item<R>, nb::sig(get_sig.c_str()), "By number, or the first of that name. Raises Error.")
      .def(
          "__iter__", [](const List<R>& l) { return nb::iter(items(l)); }, nb::sig(iter_sig.c_str()))
      .def("__repr__", [](const List<R>& l) { return nb::repr(items(l)); });
}

template <class R>
nb::class_<R> bind_ref(nb::module_& module, const char* name, const char* doc) {
  const std::string class_name = name;
  nb::class_<R> type(module, name, doc);
  type.def_ro("index", &R::index, "Its place in the scene's list.")
      .def("__eq__", [](const R& a, const nb::object& b) { return nb::isinstance<R>(b) && a == nb::cast<R>(b); })
      .def("__hash__",
           [](const R& a) { return std::hash<const void*>()(a.scene.get()) ^ (a.index * 0x9E3779B97F4A7C15u); })
      .def("__repr__",
           [class_name](const R& ref) { return fmt::format("{}({}, '{}')", class_name, ref.index, get(ref).name); });
  return type;
}

/// Where a node is put: a transform, or a position and what its -z points to. None = at its parent.
struct Placed {
  nb::object transform;
  nb::object position;
  nb::object target;
};
mat4 transform_of(const Placed& placed);

NodeRef add_node(const SharedScene& scene, Node node, const std::optional<NodeRef>& parent, Change change);

/// A mesh's arrays; all but the first two may be None.
struct MeshArrays {
  nb::object positions, triangles, normals, uvs, colors;
};
MeshRef add_mesh(const SharedScene& scene, const MeshArrays& arrays, const std::optional<MaterialRef>& material,
                 const std::string& name);

NodeRef add_light(const SharedScene& scene, const std::string& kind, nb::handle color, const nb::kwargs& numbers,
                  const Placed& placed, const std::string& name);

TextureRef add_texture(const SharedScene& scene, nb::handle source, const std::string& wrap, const std::string& filter,
                       const std::string& name);

/// The number of a matt grey, for meshes without a material; a scene has to have one.
int add_plain_material(const SharedScene& scene);

/// Radians, of degrees that make sense for a camera.
float read_fov(float fov_deg);

bool is_path(nb::handle source);
std::string path_of(nb::handle source);

void bind_objects(nb::module_& module);

}  // namespace candela::python
