#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "image/image.h"
#include "io/gltf.h"
#include "scene/file_survey.h"
#include "scene/scene.h"

namespace candela::cli {

/// What `candela info` says: the same facts for a reader and for a machine.
struct Report {
  std::string text;
  std::string json;
};

bool is_image_file(const std::string& name);  ///< a picture, or FILE:LAYER of one
Report image_report(const std::string& name);
bool is_texture_file(const std::filesystem::path& path);
Report texture_report(const std::filesystem::path& path);  ///< KTX and DDS
Report scene_report(const std::string& name, const io::LoadOptions& options);

/// Luminance of a picture's finite pixels, each counting the same.
struct Luminance {
  float least = kInfinity;
  float most = -kInfinity;
  double sum = 0.0;
  std::size_t count = 0;
  std::size_t non_finite = 0;

  double mean() const { return count > 0 ? sum / static_cast<double>(count) : 0.0; }
};
Luminance measure(const Image& image);

/// Name and value in two columns, one line each.
class Table {
 public:
  void row(const std::string& name, const std::string& value);
  void item(const std::string& value);  ///< one more line under the last name
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

std::string bytes_text(std::size_t bytes);
std::string or_unnamed(const std::string& name);
/// A heading with its number, and one line for each of the first few, with the number by which it is known: its place
/// where `numbers` is empty.
void list(Table& table, const std::string& name, const std::vector<std::string>& items,
          const std::vector<int>& numbers = {});
/// What number_of says of a list of the scene.
template <class T>
std::vector<int> numbers_of(const std::vector<T>& list) {
  std::vector<int> numbers;
  numbers.reserve(list.size());
  for (std::size_t i = 0; i < list.size(); ++i) numbers.push_back(number_of(list, i));
  return numbers;
}

// Parts of a scene's report. `survey` is null for built-in scenes.
void describe_images(const Scene& scene, const FileSurvey* survey, nlohmann::ordered_json& json, Table& table);
void describe_cameras(const Scene& scene, nlohmann::ordered_json& json, Table& table);
void describe_lights(const Scene& scene, nlohmann::ordered_json& json, Table& table);
/// The light from everywhere that the file brings.
void describe_image_light(const Scene& scene, nlohmann::ordered_json& json, Table& table);
void describe_size(const Scene& scene, nlohmann::ordered_json& json, Table& table);
void describe_gpu_memory(const Scene& scene, const FileSurvey* survey, nlohmann::ordered_json& json, Table& table);

}  // namespace candela::cli
