#include "content/make_environment.h"

#include <array>
#include <charconv>
#include <filesystem>

#include "base/error.h"
#include "base/text.h"
#include "content/builtin_environment.h"
#include "image/cube_file.h"

namespace candela {
namespace {

constexpr float kDefaultSunElevation = 35.0f;

bool is_kind_of_studio(const std::string& name) { return name == "studio:dark" || name == "studio:three-point"; }

/// Degrees after "sky:".
float parse_sun_elevation(const std::string& name) {
  float value = 0.0f;
  const char* const begin = name.data() + std::string("sky:").size();
  const char* const end = name.data() + name.size();
  const auto parsed = std::from_chars(begin, end, value);
  if (parsed.ec != std::errc() || parsed.ptr != end || !(value >= -5.0f && value <= 90.0f))
    throw Error("the sun's elevation is a number of degrees from -5 to 90", name);
  return value;
}

Image without_alpha(Image image) {
  if (image.channels == 3) return image;
  Image result(image.width, image.height, 3);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) result.set_rgb(x, y, image.rgb(x, y));
  return result;
}

Environment load_environment(const std::string& path, Diagnostics* diagnostics) {
  check_environment_name(path);
  EnvironmentFile file = read_clean_environment(path);
  if (file.cube.empty()) {
    check_panorama(file.panorama, path);
  } else {
    file.panorama = panorama_of_cube(file.cube.levels[0], path);
  }
  if (diagnostics != nullptr)
    for (Diagnostic& warning : file.warnings) diagnostics->warn(std::move(warning.message), std::move(warning.where));
  Environment environment;
  environment.name = std::filesystem::path(path).filename().string();
  environment.map = std::make_shared<Image>(without_alpha(std::move(file.panorama)));
  return environment;
}

}  // namespace

std::span<const std::string> built_in_environments() {
  static const std::array<std::string, 7> names{"studio",  "studio:dark", "studio:three-point", "sky", "sky:DEG",
                                                "furnace", "none"};
  return names;
}

void check_environment_name(const std::string& name) {
  std::error_code ignored;
  const bool is_word = name.find_first_of("./%:") == std::string::npos;
  if (!is_word || is_built_in_environment(name) || std::filesystem::exists(name, ignored)) return;
  std::string known;
  for (const std::string& built_in : built_in_environments()) known += (known.empty() ? "" : ", ") + built_in;
  throw Error("is neither a file nor one of " + known + did_you_mean(name, built_in_environments()), name);
}

bool is_built_in_environment(const std::string& name) {
  return name == "studio" || is_kind_of_studio(name) || name == "sky" || name.starts_with("sky:") ||
         name == "furnace" || name == "none";
}

Environment make_environment(const std::string& name_or_path, Diagnostics* diagnostics) {
  if (name_or_path == "none") return {};
  if (name_or_path == "furnace") {
    Environment environment;
    environment.name = "furnace";
    environment.constant = vec3(1.0f);
    environment.exposure = 1.0f;
    return environment;
  }
  if (name_or_path == "studio") return content::make_studio();
  if (is_kind_of_studio(name_or_path)) return content::make_studio(std::string_view(name_or_path).substr(7));
  if (name_or_path == "sky") return content::make_sky(kDefaultSunElevation);
  if (name_or_path.starts_with("sky:")) return content::make_sky(parse_sun_elevation(name_or_path));
  return load_environment(name_or_path, diagnostics);
}

}  // namespace candela
