#include "io/gltf_lights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/ies.h"
#include "math/spectrum.h"

namespace candela::io {

namespace {

/// Of all profiles together, so that a file that names one many times stays small in memory.
constexpr std::size_t kMostProfileBytes = std::size_t{32} << 20;

/// A number outside its limits is brought to the nearer one and told. `title` names the light, where that helps.
float within(const JsonView& json, const char* key, float fallback, float low, float high, const std::string& title,
             Warnings& warnings) {
  const float value = json.real_or(key, fallback);
  const float result = std::clamp(value, low, high);
  if (result != value) warnings.warn(fmt::format("{}{} {} becomes {}", title, key, value, result), json);
  return result;
}

float at_least_0(const JsonView& json, const char* key, float fallback, Warnings& warnings) {
  return within(json, key, fallback, 0.0f, std::numeric_limits<float>::max(), "", warnings);
}

void read_cone(const JsonView& spot, Light& light, Warnings& warnings) {
  light.inner_cone = at_least_0(spot, "innerConeAngle", 0.0f, warnings);
  light.outer_cone = at_least_0(spot, "outerConeAngle", kPi / 4, warnings);
  const float widest = kPi / 2;
  if (light.outer_cone <= widest && light.outer_cone != 0 && light.inner_cone < light.outer_cone) return;
  // KHR_lights_punctual: 0 ≤ inner < outer ≤ π/2. Exporters write π/2 rounded up, and inner = outer.
  if (light.outer_cone > widest * 1.0001f || light.outer_cone == 0 || light.inner_cone > light.outer_cone * 1.0001f) {
    warnings.warn(fmt::format("spot angles {} and {} are out of range", light.inner_cone, light.outer_cone), spot);
  }
  light.outer_cone = std::clamp(light.outer_cone, 1e-3f, widest);
  light.inner_cone = std::min(light.inner_cone, 0.999f * light.outer_cone);
}

Light read_light(const JsonView& json, Warnings& warnings) {
  Light light;
  light.name = json.string_or("name");
  light.color = json.vector_or("color", vec3(1));
  if (glm::any(glm::lessThan(light.color, vec3(0)))) {
    warnings.warn("a light has a negative colour; clamped to 0", json);
    light.color = glm::max(light.color, vec3(0));
  }
  light.intensity = at_least_0(json, "intensity", 1.0f, warnings);
  if (const auto range = json.find("range")) {
    light.range = range->real();
    if (!(light.range > 0)) throw range->error("must be positive");
  }
  const std::string type = json.at("type").string();
  if (type == "directional") {
    light.type = LightType::directional;
  } else if (type == "spot") {
    light.type = LightType::spot;
    if (const auto spot = json.find("spot")) read_cone(*spot, light, warnings);
  } else if (type != "point") {
    throw json.at("type").error("must be point, spot or directional");
  }
  return light;
}

}  // namespace

int LightReader::add_punctual(std::size_t file_index) {
  const JsonView json = root_.extension("KHR_lights_punctual")->at("lights")[file_index];
  Light light = read_light(json, warnings_);
  light.file_index = static_cast<int>(file_index);
  if (const auto extras = json.extras("candela")) {
    const std::string title =
        light.name.empty() ? fmt::format("light {}: ", file_index) : fmt::format("light '{}': ", light.name);
    read_candela(*extras, title, light);
  }
  scene_.lights.push_back(std::move(light));
  return static_cast<int>(scene_.lights.size()) - 1;
}

void LightReader::read_candela(const JsonView& extras, const std::string& title, Light& light) {
  if (!extras.is_object()) {
    warnings_.warn(title + "extras.candela is no object and is ignored", extras);
    return;
  }
  for (const std::string& key : extras.keys()) {
    const auto known = {"temperature_k", "falloff", "polynomial", "lumens", "ies"};
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      warnings_.warn(fmt::format("{}'{}' is unknown and ignored", title, key), extras);
    }
  }
  if (extras.find("temperature_k")) {
    const float kelvin = within(extras, "temperature_k", 0.0f, 1000.0f, 40000.0f, title, warnings_);
    light.color *= blackbody_color(static_cast<double>(kelvin));
  }
  if (light.type == LightType::directional) {
    for (const char* key : {"falloff", "polynomial", "lumens", "ies"}) {
      if (extras.find(key)) warnings_.warn(fmt::format("{}a directional light has no {}", title, key), extras);
    }
    return;
  }
  read_falloff(extras, title, light);
  if (const auto ies = extras.find("ies")) {
    if (light.type == LightType::spot) warnings_.warn(title + "its profile replaces the cone", extras);
    light.type = LightType::point;
    light.ies = profile_at(*ies);
  }
  if (extras.find("lumens")) set_lumens(extras, title, light);
}

void LightReader::read_falloff(const JsonView& extras, const std::string& title, Light& light) {
  const std::string name = extras.string_or("falloff", "gltf");
  if (name == "inverse-square") {
    light.falloff = Falloff::inverse_square;
  } else if (name == "ue4") {
    light.falloff = Falloff::ue4;
  } else if (name == "polynomial") {
    light.falloff = Falloff::polynomial;
  } else if (name != "gltf") {
    warnings_.warn(fmt::format("{}falloff '{}' is unknown; gltf taken", title, name), extras);
  }
  if (!extras.find("polynomial")) return;
  if (light.falloff != Falloff::polynomial) {
    warnings_.warn(title + "polynomial has no effect without the falloff of that name", extras);
  }
  const vec3 given = extras.vector_or("polynomial", vec3(1, 0, 0));
  light.polynomial = glm::max(given, vec3(0));
  if (light.polynomial != given) warnings_.warn(title + "polynomial has a negative coefficient; clamped to 0", extras);
  if (!(max_component(light.polynomial) > 0.0f)) {
    warnings_.warn(title + "polynomial is 0; the inverse square taken", extras);
    light.polynomial = vec3(1, 0, 0);
  }
}

void LightReader::set_lumens(const JsonView& extras, const std::string& title, Light& light) {
  const float lumens = within(extras, "lumens", 0.0f, 0.0f, std::numeric_limits<float>::max(), title, warnings_);
  const float intensity = intensity_from_lumens(scene_, light, lumens);
  if (!std::isfinite(intensity)) {
    warnings_.warn(title + "its profile is dark and cannot be brought to the lumens asked for", extras);
    return;
  }
  light.intensity = intensity;
}

int LightReader::add_ies(const IesUse& use) {
  Light light;
  light.ies = profile_of_file(use.profile);
  light.name = scene_.ies_profiles[static_cast<std::size_t>(light.ies)].name;
  light.file_index = static_cast<int>(use.profile);
  light.intensity = use.multiplier;
  light.color = use.color;
  scene_.lights.push_back(std::move(light));
  return static_cast<int>(scene_.lights.size()) - 1;
}

int LightReader::profile_of_file(std::size_t index) {
  const auto [found, is_new] = profile_of_file_.try_emplace(index, -1);
  if (!is_new) return found->second;
  const JsonView json = root_.extension("EXT_lights_ies")->at("lights")[index];
  const std::string name = json.string_or("name");
  if (const auto uri = json.find("uri")) {
    const std::vector<std::byte> bytes = uris_.read(*uri);
    return found->second = add_profile(bytes, *uri, name);
  }
  const JsonView view = json.at("bufferView");
  if (json.string_or("mimeType") != "application/x-ies-lm-63") {
    warnings_.warn("the mimeType of a profile in a buffer view must be application/x-ies-lm-63", json);
  }
  return found->second = add_profile(buffers_.view(view).bytes, view, name);
}

int LightReader::profile_at(const JsonView& uri) {
  const auto [found, is_new] = profile_of_uri_.try_emplace(uri.string(), -1);
  if (is_new) found->second = add_profile(uris_.read(uri), uri, "");
  return found->second;
}

int LightReader::add_profile(std::span<const std::byte> bytes, const JsonView& place, std::string name) {
  profile_bytes_ += bytes.size();
  if (profile_bytes_ > kMostProfileBytes) throw place.error("the IES profiles are larger than 32 MiB together");
  Diagnostics oddities;
  IesProfile profile = parse_ies({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, place.where(), oddities);
  for (const Diagnostic& oddity : oddities.warnings()) warnings_.warn(oddity.message, place);
  profile.name = std::move(name);
  scene_.ies_profiles.push_back(std::move(profile));
  return static_cast<int>(scene_.ies_profiles.size()) - 1;
}

}  // namespace candela::io
