#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "candela/dataset.h"
#include "candela/instance_view.h"

// What data sets of several kinds have in common. Private to this folder.
namespace candela {

using Json = nlohmann::ordered_json;

/// Into a folder that is made for it.
void write_made(const std::filesystem::path& path, std::span<const std::byte> bytes);
void write_json(const std::filesystem::path& path, const Json& json);
/// 255 where the mask is set.
void write_mask(const std::filesystem::path& path, const PixelMask& mask);
/// Depths in metres as multiples of `unit`; 0 where there is none or too large a one. Returns whether one was too
/// large.
bool write_depth(const std::filesystem::path& path, const Image& depth, double unit);

/// The two parts of which BOP consists that last longer than a picture.
class BopWriter {
 public:
  explicit BopWriter(std::filesystem::path folder) : folder_(std::move(folder)) {}
  static std::filesystem::path scene_folder(const std::filesystem::path& folder, std::size_t scene);
  void add(const TakenPicture& picture, const std::filesystem::path& file, std::size_t scene,
           const std::vector<Instance>& instances);
  void finish();

 private:
  struct SceneFiles {
    Json cameras = Json::object(), poses = Json::object(), infos = Json::object();
  };
  int object_of(const Scene& scene, std::size_t number, const Instance& instance, const glm::dmat3& stretch);

  std::filesystem::path folder_;
  std::map<std::size_t, SceneFiles> scenes_;
  std::map<std::vector<long>, int> objects_;  ///< by scene, mesh and stretch
  Json models_ = Json::object();
  Json camera_;
};

}  // namespace candela
