#pragma once

#include <nanobind/nanobind.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "candela/live_scene.h"

namespace candela::python {

namespace nb = nanobind;

/// What lights a scene from far away, where it is no name.
struct EnvironmentOf {
  std::shared_ptr<const Environment> environment;
};

/// A scene as Python has it.
struct SceneOf {
  SceneOf(Scene scene, std::shared_ptr<LiveStage> stage) : live(std::move(scene), std::move(stage)) {}

  LiveScene live;
  std::optional<std::string> environment_name;  ///< what render() is lit by unless it is told otherwise
  std::optional<EnvironmentOf> environment;
  std::vector<std::string> variants;  ///< of the file
  std::vector<std::string> animations;
  std::string file;  ///< that it was read from; empty = made in memory
};
using SharedScene = std::shared_ptr<SceneOf>;

/// An object of a scene, by its place.
template <int Kind>
struct Ref {
  SharedScene scene;
  std::size_t index = 0;

  bool operator==(const Ref&) const = default;
};
using NodeRef = Ref<0>;
using MeshRef = Ref<1>;
using MaterialRef = Ref<2>;
using TextureRef = Ref<3>;
using LightRef = Ref<4>;
using CameraRef = Ref<5>;

inline const Material& get(const MaterialRef& ref) { return ref.scene->live.scene().materials[ref.index]; }
inline Material& edit(const MaterialRef& ref) { return ref.scene->live.change(Change::materials).materials[ref.index]; }

/// A texture of the scene that stands for whatever was given: a Texture, a file, an array.
int texture_of(const SharedScene& scene, nb::handle source, const std::string& name);

/// Sets what keywords name: rows of the material table, alpha_mode, double_sided, unlit, textures.
void set_properties(const SharedScene& scene, Material& material, const nb::kwargs& properties);

/// Shared by all scenes of the process.
std::shared_ptr<LiveStage> the_stage();
void forget_stage();

void bind_material(nb::class_<MaterialRef>& type);
void bind_scene(nb::module_& module);

}  // namespace candela::python
