#include "candela/objects.h"

#include <nlohmann/json.hpp>

#include "scene/surface_layers.h"

namespace candela {

namespace {

using Json = nlohmann::ordered_json;

/// What a file says may be no UTF-8.
std::string text_of(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

std::string category_of(const Scene& scene, const Node& node) {
  const auto mesh = static_cast<std::size_t>(node.mesh);
  const std::string& name = scene.meshes[mesh].name;
  return name.empty() ? "mesh " + std::to_string(number_of(scene.meshes, mesh)) : name;
}

template <class T>
Json list_json(const std::vector<T>& list, const char* key) {
  Json json = Json::array();
  for (std::size_t i = 0; i < list.size(); ++i) {
    json.push_back({{key, number_of(list, i) + 1}, {"name", list[i].name}});
  }
  return json;
}

}  // namespace

std::vector<Instance> instances_of(const Scene& scene, InstanceKind kind, const std::string& scene_name) {
  std::vector<Instance> instances;
  if (kind == InstanceKind::scene) instances.push_back({1, scene_name, scene_name, {}});
  for (const auto& [node, name] : matte_names(scene, MatteKind::object)) {
    if (kind == InstanceKind::scene) {
      instances[0].nodes.push_back(static_cast<int>(node));
    } else {
      instances.push_back({node + 1, name, category_of(scene, scene.nodes[node]), {static_cast<int>(node)}});
    }
  }
  return instances;
}

std::string objects_json(const Scene& scene) {
  Json json{{"instances", Json::array()},
            {"meshes", list_json(scene.meshes, "mesh")},
            {"materials", list_json(scene.materials, "material")}};
  for (const auto& [node, name] : matte_names(scene, MatteKind::object)) {
    json["instances"].push_back(
        {{"instance", node + 1},
         {"id", number_of(scene.nodes, node) + 1},
         {"name", name},
         {"mesh", number_of(scene.meshes, static_cast<std::size_t>(scene.nodes[node].mesh)) + 1}});
  }
  return text_of(json);
}

}  // namespace candela
