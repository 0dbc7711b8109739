#include "candela/bake_gltf.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/file.h"
#include "image/cube_layout.h"
#include "image/image_file.h"
#include "image/rgbd.h"

// A bake as a glTF file whose scene is lit by it: EXT_lights_image_based.
namespace candela {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

EncodingLoss write_gltf_light(const fs::path& folder, const BakeResult& result) {
  constexpr const char* kExtension = "EXT_lights_image_based";
  constexpr std::size_t kHarmonics = 9;
  EncodingLoss loss;
  Json images = Json::array(), levels = Json::array();
  const Cubemap& cube = result.bake->specular;
  for (std::size_t level = 0; level < cube.levels.size(); ++level) {
    Json faces = Json::array();
    for (std::size_t i = 0; i < 6; ++i) {
      const std::string name = fmt::format("specular_m{}_{}.png", level, kFaceNames[i]);
      write_file(folder / name, encode_png(rgbd_from_image(mirrored(cube.levels[level][i]), loss)));
      faces.push_back(images.size());
      images.push_back({{"uri", name}});
    }
    levels.push_back(std::move(faces));
  }
  Json harmonics = Json::array();
  for (std::size_t i = 0; i < kHarmonics; ++i) {
    const vec3 c(result.bake->sh.coefficients.at(i));
    harmonics.push_back({c.x, c.y, c.z});
  }
  const Json light = {{"name", result.name},
                      {"irradianceCoefficients", std::move(harmonics)},
                      {"specularImageSize", cube.size()},
                      {"specularImages", std::move(levels)}};
  const Json document = {{"asset", {{"version", "2.0"}, {"generator", "candela bake"}}},
                         {"extensionsUsed", Json::array({kExtension})},
                         {"extensions", {{kExtension, {{"lights", Json::array({light})}}}}},
                         {"scene", 0},
                         {"scenes", Json::array({{{"extensions", {{kExtension, {{"light", 0}}}}}}})},
                         {"images", std::move(images)}};
  write_file(folder / "environment.gltf", document.dump(1) + "\n");
  return loss;
}

}  // namespace candela
