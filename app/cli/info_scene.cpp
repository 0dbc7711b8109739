#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "cli/info.h"
#include "math/types.h"
#include "scene/material_table.h"

// What `candela info` says of a scene's textures, cameras, lights and size.
namespace candela::cli {

namespace {

using Json = nlohmann::ordered_json;

Json vec3_json(vec3 v) { return {v.x, v.y, v.z}; }
std::string vec3_text(vec3 v) { return fmt::format("{:.4g} {:.4g} {:.4g}", v.x, v.y, v.z); }

/// Bits and alpha of an image; a file's are known from its header, before it is decoded.
struct Pixels {
  int bits;
  bool has_alpha;
};
Pixels pixels_of(const Scene& scene, const FileSurvey* survey, std::size_t image) {
  if (survey != nullptr && image < survey->images.size()) {
    return {survey->images[image].bits, survey->images[image].has_alpha};
  }
  return {scene.images[image]->bits, scene.images[image]->has_alpha};
}

std::size_t texel_count(int width, int height) {
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

/// All levels down to one texel, each half as wide and high, rounded down.
std::size_t texels_with_mips(int width, int height) {
  std::size_t sum = texel_count(width, height);
  while (width > 1 || height > 1) {
    width = std::max(width / 2, 1);
    height = std::max(height / 2, 1);
    sum += texel_count(width, height);
  }
  return sum;
}

/// Where an image stands.
struct ImageUses {
  std::set<std::string_view> slots;
  std::set<int> materials;   ///< their numbers
  std::set<bool> encodings;  ///< sRGB or not: a GPU holds one texture for each
};
std::vector<ImageUses> uses_of_images(const Scene& scene) {
  std::vector<ImageUses> uses(scene.images.size());
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    const auto slots = texture_slots(scene.materials[m]);
    for (std::size_t i = 0; i < slots.size(); ++i) {
      if (!*slots[i]) continue;
      ImageUses& use =
          uses[static_cast<std::size_t>(scene.textures[static_cast<std::size_t>(slots[i]->texture)].image)];
      use.slots.insert(kTextureRows[i].source.key);
      use.materials.insert(number_of(scene.materials, m));
      use.encodings.insert(kTextureRows[i].is_srgb());
    }
  }
  return uses;
}

std::string slots_text(const ImageUses& use) {
  std::vector<std::string> names;
  for (std::string_view name : use.slots) {
    constexpr std::string_view kTail = "Texture";
    if (name.ends_with(kTail)) name.remove_suffix(kTail.size());
    names.emplace_back(name);
  }
  return fmt::format("{}", fmt::join(names, " + "));
}

std::size_t gpu_bytes(const Scene& scene, const FileSurvey* survey, std::size_t image, const ImageUses& use) {
  const TextureImage& pixels = *scene.images[image];
  const auto texel_bytes = static_cast<std::size_t>(pixels_of(scene, survey, image).bits / 8) * 4;
  return texels_with_mips(pixels.width, pixels.height) * texel_bytes * use.encodings.size();
}

/// Something of that length, for people who read metres and see nothing.
std::string_view size_hint(float longest_side) {
  struct Hint {
    float below;
    std::string_view thing;
  };
  constexpr auto kHints = std::to_array<Hint>({{0.0005f, "a speck of dust"},
                                               {0.003f, "a grain of sand"},
                                               {0.012f, "a pea"},
                                               {0.04f, "a coin"},
                                               {0.12f, "a matchbox to a cup"},
                                               {0.4f, "a shoe"},
                                               {0.8f, "a suitcase"},
                                               {1.4f, "a chair"},
                                               {2.5f, "a person"},
                                               {7.0f, "a car"},
                                               {25.0f, "a house"},
                                               {120.0f, "a large building"},
                                               {700.0f, "a block of a city"},
                                               {10e3f, "a town"},
                                               {300e3f, "a landscape"}});
  for (const Hint& hint : kHints) {
    if (longest_side < hint.below) return hint.thing;
  }
  return "a country and more";
}

std::string light_type(LightType type) {
  switch (type) {
    case LightType::point:
      return "point";
    case LightType::spot:
      return "spot";
    case LightType::directional:
      return "directional";
  }
  return {};
}

Json number_or_null(float value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

/// What EXT_camera_physical says; null without it.
Json describe_lens(const Camera& camera, std::string& text) {
  const auto known = [](float value) { return value > 0.0f ? Json(value) : Json(nullptr); };
  Json lens = {{"f_number", known(camera.f_number)},
               {"focal_length_mm", known(1000.0f * camera.focal_length)},
               {"focus_distance_m", known(camera.focus_distance)}};
  std::string said;
  if (camera.f_number > 0.0f) said += fmt::format(", f/{:.3g}", camera.f_number);
  if (camera.focal_length > 0.0f) said += fmt::format(", a lens of {:.4g} mm", 1000.0f * camera.focal_length);
  if (camera.focus_distance > 0.0f) said += fmt::format(", sharp at {:.4g} m", camera.focus_distance);
  text += said;
  return said.empty() ? Json(nullptr) : lens;
}

}  // namespace

void describe_images(const Scene& scene, const FileSurvey* survey, Json& json, Table& table) {
  json["images"] = Json::array();
  std::vector<std::string> lines;
  std::size_t bytes = 0;
  const std::vector<ImageUses> uses = uses_of_images(scene);
  std::vector<int> numbers;
  for (std::size_t i = 0; i < scene.images.size(); ++i) {
    const TextureImage& image = *scene.images[i];
    const Pixels pixels = pixels_of(scene, survey, i);
    const std::size_t memory = texel_count(image.width, image.height) * 4 * static_cast<std::size_t>(pixels.bits) / 8;
    numbers.push_back(image_number(scene, i));
    Json entry = {{"index", numbers.back()},
                  {"width", image.width},
                  {"height", image.height},
                  {"bits", pixels.bits},
                  {"alpha", pixels.has_alpha},
                  {"bytes", memory},
                  {"gpu_bytes", gpu_bytes(scene, survey, i, uses[i])},
                  {"slots", uses[i].slots},
                  {"materials", uses[i].materials}};
    std::string name, error;
    if (survey != nullptr && i < survey->images.size()) {
      const FileSurvey::Image& file = survey->images[i];
      entry["error"] = file.error.empty() ? Json(nullptr) : Json(file.error);
      entry["name"] = file.name;
      entry["format"] = file.format;
      entry["file_bytes"] = file.file_bytes;
      name = file.name.empty() ? "" : file.name + ": ";
      // Of a file that is not there neither is known.
      if (!file.format.empty()) name += fmt::format("{} ({}), ", file.format, bytes_text(file.file_bytes));
      error = file.error;
    }
    if (!error.empty()) {
      lines.push_back(name + "cannot be read: " + error);
    } else {
      lines.push_back(fmt::format("{}{} x {}, {} bits{}, {}, {} of {} material{}", name, image.width, image.height,
                                  pixels.bits, pixels.has_alpha ? " with alpha" : "", bytes_text(memory),
                                  slots_text(uses[i]), uses[i].materials.size(),
                                  uses[i].materials.size() == 1 ? "" : "s"));
    }
    json["images"].push_back(std::move(entry));
    bytes += memory;
  }
  json["texture_bytes"] = bytes;
  list(table, "images", lines, numbers);
  if (!scene.images.empty()) table.row("texture memory", bytes_text(bytes));
}

/// What `--engine raster` uploads (raster/gpu_scene.cpp): position, normal, tangent, two uvs and colour as floats,
/// 32-bit indices, every image with its mips. Frame buffers and the environment's maps come on top.
void describe_gpu_memory(const Scene& scene, const FileSurvey* survey, Json& json, Table& table) {
  constexpr std::size_t kVertexBytes = 18 * sizeof(float);
  std::size_t vertices = 0, triangles = 0, textures = 0;
  for (const Mesh& mesh : scene.meshes) {
    for (const Primitive& primitive : mesh.primitives) {
      vertices += primitive.positions.size() * kVertexBytes;
      triangles += primitive.triangles.size() * sizeof(uvec3);
    }
  }
  const std::vector<ImageUses> uses = uses_of_images(scene);
  for (std::size_t i = 0; i < scene.images.size(); ++i) textures += gpu_bytes(scene, survey, i, uses[i]);
  const std::size_t total = vertices + triangles + textures;
  json["gpu_bytes"] = {{"vertices", vertices}, {"indices", triangles}, {"textures", textures}, {"total", total}};
  table.row("GPU memory", fmt::format("about {}: {} vertices, {} indices, {} textures with mips", bytes_text(total),
                                      bytes_text(vertices), bytes_text(triangles), bytes_text(textures)));
}

void describe_cameras(const Scene& scene, Json& json, Table& table) {
  json["cameras"] = Json::array();
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
    const Camera& camera = scene.cameras[i];
    Json entry = {{"index", number_of(scene.cameras, i)}, {"name", camera.name}};
    std::string text = or_unnamed(camera.name);
    if (const auto* p = std::get_if<PerspectiveCamera>(&camera.projection)) {
      // Of a sensor 24 mm high, as the renderer's f-numbers.
      const float focal_mm = 12.0f / std::tan(0.5f * p->yfov);
      entry["type"] = "perspective";
      entry["yfov_deg"] = degrees(p->yfov);
      entry["aspect_ratio"] = p->aspect_ratio ? Json(*p->aspect_ratio) : Json(nullptr);
      entry["focal_length_mm"] = focal_mm;
      text += fmt::format(", {:.4g} degrees ({:.3g} mm on 24 mm)", degrees(p->yfov), focal_mm);
    } else if (const auto* o = std::get_if<OrthographicCamera>(&camera.projection)) {
      entry["type"] = "orthographic";
      entry["width_m"] = 2.0f * o->xmag;
      entry["height_m"] = 2.0f * o->ymag;
      text += fmt::format(", orthographic, {:.4g} x {:.4g} m", 2.0f * o->xmag, 2.0f * o->ymag);
    }
    entry["near_m"] = camera.near_plane;
    entry["far_m"] = number_or_null(camera.far_plane);
    if (camera.far_plane < kInfinity) {
      text += fmt::format(", sees {:.4g} to {:.4g} m", camera.near_plane, camera.far_plane);
    } else if (camera.near_plane > 0.0f) {
      text += fmt::format(", sees from {:.4g} m", camera.near_plane);
    }
    entry["lens"] = describe_lens(camera, text);
    json["cameras"].push_back(std::move(entry));
    lines.push_back(std::move(text));
  }
  list(table, "cameras", lines, numbers_of(scene.cameras));
}

void describe_lights(const Scene& scene, Json& json, Table& table) {
  json["lights"] = Json::array();
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const Light& light = scene.lights[i];
    const bool is_profile = light.ies >= 0;
    const std::string type = is_profile ? "IES profile" : light_type(light.type);
    Json entry = {{"index", number_of(scene.lights, i)},
                  {"name", light.name},
                  {"type", type},
                  {"intensity", light.intensity},
                  {"unit", is_profile                             ? "factor"
                           : light.type == LightType::directional ? "lux"
                                                                  : "cd"},
                  {"color", vec3_json(light.color)}};
    std::string strength;
    if (light.type == LightType::directional) {
      strength = fmt::format("{:.4g} lux", light.intensity);
    } else {
      const double lumens = static_cast<double>(light.intensity) / intensity_from_lumens(scene, light, 1.0f);
      entry["lumens"] = std::isfinite(lumens) ? Json(lumens) : Json(nullptr);
      entry["range_m"] = number_or_null(light.range);
      if (!is_profile) strength = fmt::format("{:.4g} cd, ", light.intensity);
      strength += fmt::format("{:.4g} lm", lumens);
    }
    if (light.type == LightType::spot) {
      entry["inner_cone_deg"] = degrees(light.inner_cone);
      entry["outer_cone_deg"] = degrees(light.outer_cone);
      strength += fmt::format(", cone {:.3g} to {:.3g} degrees", degrees(light.inner_cone), degrees(light.outer_cone));
    }
    if (light.color != vec3(1.0f)) strength += ", colour " + vec3_text(light.color);
    json["lights"].push_back(std::move(entry));
    lines.push_back(fmt::format("{}, {}, {}", or_unnamed(light.name), type, strength));
  }
  std::vector<int> numbers = numbers_of(scene.lights);
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    if (!is_lamp(scene, scene.nodes[n])) continue;
    const Mesh& mesh = scene.meshes[static_cast<std::size_t>(scene.nodes[n].mesh)];
    const vec3 nits = scene.materials[static_cast<std::size_t>(mesh.primitives[0].material)].emission;
    double area = 0.0;
    for (const uvec3& t : mesh.primitives[0].triangles) {
      const auto corner = [&](std::uint32_t i) {
        return transform_point(scene.nodes[n].world_from_node, mesh.primitives[0].positions[i]);
      };
      area += 0.5 * static_cast<double>(glm::length(glm::cross(corner(t.y) - corner(t.x), corner(t.z) - corner(t.x))));
    }
    const double lumens = static_cast<double>(luminance(nits)) * area * static_cast<double>(kPi);
    json["lights"].push_back({{"index", number_of(scene.nodes, n)},
                              {"name", mesh.name},
                              {"type", "area"},
                              {"luminance_cd_m2", vec3_json(nits)},
                              {"area_m2", area},
                              {"lumens", lumens}});
    lines.push_back(fmt::format("{}, area light of node {}, {} cd/m2 on {:.4g} m2, {:.4g} lm", or_unnamed(mesh.name),
                                number_of(scene.nodes, n), vec3_text(nits), area, lumens));
    numbers.push_back(number_of(scene.nodes, n));
  }
  list(table, "lights", lines, numbers);
}

void describe_image_light(const Scene& scene, Json& json, Table& table) {
  json["image_light"] = nullptr;
  if (!scene.image_light) return;
  const ImageLight& light = *scene.image_light;
  json["image_light"] = {{"index", light.file_index},
                         {"name", light.environment.name},
                         {"size", light.size},
                         {"levels", light.levels},
                         {"intensity", light.environment.intensity}};
  table.row("environment", fmt::format("{}, image-based light {}, a cube of {} x {}, {} level{}, intensity {:.4g}",
                                       light.environment.name, light.file_index, light.size, light.size, light.levels,
                                       light.levels == 1 ? "" : "s", light.environment.intensity));
}

void describe_size(const Scene& scene, Json& json, Table& table) {
  const Box3 bounds = world_bounds(scene);
  json["bounds"] = nullptr;
  if (bounds.empty()) return;
  const vec3 size = bounds.size();
  const std::string_view hint = size_hint(max_component(size));
  json["bounds"] = {{"lower", vec3_json(bounds.lower)}, {"upper", vec3_json(bounds.upper)}};
  json["size"] = vec3_json(size);
  json["size_hint"] = hint;
  table.row("bounds", vec3_text(bounds.lower) + " to " + vec3_text(bounds.upper) + " m");
  table.row("size", fmt::format("{:.3g} x {:.3g} x {:.3g} m, as large as {}", size.x, size.y, size.z, hint));
}

}  // namespace candela::cli
