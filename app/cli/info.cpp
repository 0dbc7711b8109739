#include "cli/info.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/diagnostics.h"
#include "base/error.h"
#include "base/text.h"
#include "candela/candela.h"
#include "cli/json_text.h"
#include "cli/option.h"
#include "cli/values.h"
#include "cli/verbs.h"
#include "image/image_file.h"
#include "io/gltf.h"
#include "io/gltf_survey.h"
#include "io/scene_files.h"

namespace candela::cli {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kNameColumn = 14;

struct Counts {
  std::size_t primitives = 0;
  std::size_t vertices = 0;
  std::size_t triangles = 0;         ///< stored once per mesh
  std::size_t placed_triangles = 0;  ///< as often as nodes show them
  std::size_t placed_meshes = 0;
  std::size_t hidden_nodes = 0;
};

Counts count(const Scene& scene) {
  Counts total;
  std::vector<std::size_t> of_mesh;
  for (const Mesh& mesh : scene.meshes) {
    std::size_t triangles = 0;
    for (const Primitive& primitive : mesh.primitives) {
      triangles += primitive.triangles.size();
      total.vertices += primitive.positions.size();
      ++total.primitives;
    }
    of_mesh.push_back(triangles);
    total.triangles += triangles;
  }
  for (const Node& node : scene.nodes) {
    total.hidden_nodes += node.is_hidden ? 1 : 0;
    if (node.mesh < 0) continue;
    total.placed_triangles += of_mesh[static_cast<std::size_t>(node.mesh)];
    ++total.placed_meshes;
  }
  return total;
}

void describe_materials(const Scene& scene, Json& json, Table& table) {
  json["materials"] = Json::array();
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    const Material& material = scene.materials[i];
    if (material.is_lamp) continue;
    const std::vector<std::string_view> lobes = material_lobes(material);
    json["materials"].push_back({{"index", number_of(scene.materials, i)}, {"name", material.name}, {"lobes", lobes}});
    lines.push_back(fmt::format("{}: {}", or_unnamed(material.name), fmt::join(lobes, ", ")));
  }
  std::vector<int> numbers;
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    if (!scene.materials[i].is_lamp) numbers.push_back(number_of(scene.materials, i));
  }
  list(table, "materials", lines, numbers);
}

bool contains(const std::vector<std::string>& list, const std::string& name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

/// Each extension and what is done with it.
void describe_extensions(const io::FileInfo& file, Json& json, Table& table) {
  Json& all = json["extensions"]["all"] = Json::array();
  std::vector<std::string> names = file.extensions_used;
  for (const std::string& name : file.extensions_required) {
    if (!contains(names, name)) names.push_back(name);
  }
  std::vector<std::string> lines;
  for (const std::string& name : names) {
    const bool is_required = contains(file.extensions_required, name);
    const char* status = contains(file.extensions_missing, name)   ? "missing"
                         : contains(file.extensions_ignored, name) ? "ignored"
                         : contains(file.extensions_unseen, name)  ? "no effect on pixels"
                                                                   : "supported";
    all.push_back({{"name", name}, {"required", is_required}, {"status", status}});
    lines.push_back(fmt::format("{}: {}{}", name, is_required ? "required, " : "", status));
  }
  if (!lines.empty()) list(table, "extensions", lines);
}

/// The scenes of a file that has several.
void describe_scenes(const io::FileInfo& file, Json& json, Table& table) {
  json["scene_index"] = file.scenes.empty() ? Json(nullptr) : Json(file.scene);
  json["scenes"] = file.scenes;
  if (file.scenes.size() < 2) return;
  std::vector<std::string> lines;
  lines.reserve(file.scenes.size());
  for (std::size_t i = 0; i < file.scenes.size(); ++i) {
    lines.push_back(or_unnamed(file.scenes[i]) + (i == file.scene ? ", the one described here" : ""));
  }
  list(table, "scenes", lines);
}

/// What the scene does not keep.
void describe_file(const io::FileInfo& file, Json& json, Table& table) {
  json["format"] = file.format;
  json["bytes"] = file.file_bytes;
  json["archive_entry"] = file.archive_entry;
  json["generator"] = file.generator;
  json["copyright"] = file.copyright;
  json["extensions"] = {{"used", file.extensions_used},
                        {"required", file.extensions_required},
                        {"unsupported", file.extensions_ignored},
                        {"required_unsupported", file.extensions_missing}};
  json["variants"] = file.variants;
  json["animations"] = file.animations.size();
  json["animation_list"] = Json::array();
  std::vector<std::string> animations, moved;  // the latter by KHR_animation_pointer
  for (const io::AnimationInfo& animation : file.animations) {
    json["animation_list"].push_back({{"name", animation.name},
                                      {"duration_s", animation.duration_s},
                                      {"channels", animation.channels},
                                      {"pointers", animation.pointers}});
    for (const std::string& pointer : animation.pointers) {
      if (std::find(moved.begin(), moved.end(), pointer) == moved.end()) moved.push_back(pointer);
    }
    animations.push_back(fmt::format("{}, {:.4g} s, {} {}", or_unnamed(animation.name), animation.duration_s,
                                     animation.channels, animation.channels == 1 ? "channel" : "channels"));
  }
  json["skins"] = file.skins;
  table.row("format", file.format);
  if (!file.archive_entry.empty()) table.row("in archive", file.archive_entry);
  table.row("file size", bytes_text(file.file_bytes));
  if (!file.generator.empty()) table.row("generator", file.generator);
  if (!file.copyright.empty()) table.row("copyright", file.copyright);
  describe_extensions(file, json, table);
  describe_scenes(file, json, table);
  if (!file.variants.empty()) list(table, "variants", file.variants);
  if (!file.extensions_missing.empty()) {
    table.row("unsupported",
              fmt::format("{}: required, so the scene cannot be rendered", fmt::join(file.extensions_missing, " ")));
  }
  if (!animations.empty()) list(table, "animations", animations);
  if (!moved.empty()) list(table, "animated", moved);
  if (file.skins > 0) table.row("skins", fmt::format("{}", file.skins));
}

void describe_content(const Scene& scene, const FileSurvey* survey, Json& json, Table& table) {
  const Counts counts = count(scene);
  json["name"] = scene.name;
  json["nodes"] = scene.nodes.size();
  json["hidden_nodes"] = counts.hidden_nodes;
  json["meshes"] = scene.meshes.size();
  json["primitives"] = counts.primitives;
  json["vertices"] = counts.vertices;
  json["triangles"] = counts.triangles;
  json["instances"] = counts.placed_meshes;
  json["instanced_triangles"] = counts.placed_triangles;
  json["textures"] = scene.textures.size();
  if (!scene.name.empty()) table.row("name", scene.name);
  table.row("nodes", fmt::format("{}, {} with a mesh{}", scene.nodes.size(), counts.placed_meshes,
                                 counts.hidden_nodes > 0 ? fmt::format(", {} hidden", counts.hidden_nodes) : ""));
  table.row("meshes", fmt::format("{} of {}", scene.meshes.size(), counted(counts.primitives, "primitive")));
  table.row("triangles",
            fmt::format("{}, {} as placed; {} vertices", counts.triangles, counts.placed_triangles, counts.vertices));
  describe_materials(scene, json, table);
  describe_images(scene, survey, json, table);
  describe_gpu_memory(scene, survey, json, table);
  describe_cameras(scene, json, table);
  describe_lights(scene, json, table);
  describe_image_light(scene, json, table);
}

/// The scene of a file, or nothing where an extension that it requires and we lack stands in the way.
std::optional<Scene> look_into(const std::string& name, const io::LoadOptions& options, Diagnostics& diagnostics,
                               io::FileInfo& file) {
  try {
    return io::load_gltf(name, diagnostics, options, &file);
  } catch (const Error& error) {
    if (file.extensions_missing.empty()) throw;
    diagnostics.warn("the scene cannot be read: " + error.message(), error.where());
    return std::nullopt;
  }
}

/// What a picture without options would be warned of.
void tell_of_views(const Scene& scene, const std::string& file, Diagnostics& diagnostics) {
  if (const auto emptiness = find_emptiness(scene)) diagnostics.warn(emptiness->message, file);
  constexpr float kAspect = 16.0f / 9.0f;  // of a picture whose size nobody asks for
  default_camera(scene, kAspect, &diagnostics);
}

}  // namespace

std::string or_unnamed(const std::string& name) { return name.empty() ? "(no name)" : name; }

void list(Table& table, const std::string& name, const std::vector<std::string>& items,
          const std::vector<int>& numbers) {
  constexpr std::size_t kMostItems = 20;  // --json lists all
  table.row(name, fmt::format("{}", items.size()));
  for (std::size_t i = 0; i < std::min(items.size(), kMostItems); ++i) {
    table.item(fmt::format("{} {}", numbers.empty() ? static_cast<int>(i) : numbers[i], items[i]));
  }
  if (items.size() > kMostItems) table.item(fmt::format("and {} more (--json lists all)", items.size() - kMostItems));
}

void Table::row(const std::string& name, const std::string& value) {
  text_ += fmt::format("{:<{}} {}\n", one_line(name), kNameColumn, one_line(value));
}
void Table::item(const std::string& value) { row("", value); }

std::string bytes_text(std::size_t bytes) {
  constexpr double kKibi = 1024.0;
  const auto size = static_cast<double>(bytes);
  if (size < kKibi) return fmt::format("{} B", bytes);
  if (size < kKibi * kKibi) return fmt::format("{:.1f} KiB", size / kKibi);
  return fmt::format("{:.1f} MiB", size / (kKibi * kKibi));
}

Report scene_report(const std::string& name, const io::LoadOptions& chosen) {
  Diagnostics diagnostics;
  io::FileInfo file;
  const bool built_in = name.starts_with("demo:");
  // Sizes are in the images' headers, counts in the accessors: a big file answers at once.
  io::LoadOptions options = chosen;
  options.decode_images = options.refuse_unknown_required = options.unpack_geometry = false;
  const std::optional<Scene> scene =
      built_in ? load(name, nullptr, options) : look_into(name, options, diagnostics, file);

  Json json{{"file", name}, {"kind", "scene"}};
  Table table;
  table.row("scene", name);
  std::optional<FileSurvey> survey;
  if (scene && !built_in)
    survey = io::survey_gltf(
        name, {.read_geometry = false, .root = options.root, .scene = options.scene, .measures = options.measures});
  if (scene) describe_content(*scene, survey ? &*survey : nullptr, json, table);
  if (!built_in) describe_file(file, json, table);
  if (scene) describe_size(*scene, json, table);
  if (scene) tell_of_views(*scene, name, diagnostics);
  const auto add = [&](const char* kind, const char* key, const std::vector<Diagnostic>& told) {
    json[key] = Json::array();
    for (const Diagnostic& one : told) {
      json[key].push_back(one.text());
      table.row(kind, one.text());
    }
  };
  add("warning", "warnings", diagnostics.warnings());
  add("note", "notes", diagnostics.notes());
  return {table.text(), json_text(json)};
}

Verb add_info(Command& command) {
  struct Options {
    std::string file;
    std::string root;
    std::string scene;
    foreign::Measures measures;
    bool json = false;
  };
  const auto options = std::make_shared<Options>();
  command
      .text("FILE", options->file,
            "A scene (.glb, .gltf, .obj, .fbx, .stl, .ply, .dae, .3ds, .3mf, a .zip with one of them), a demo:NAME, "
            "an .exr (:LAYER), .hdr, .png, .jpg, .webp or .avif image, or a .ktx2, .ktx or .dds texture")
      .choices(demo_words())
      .required();
  add_root(command, options->root);
  add_scene_choice(command, options->scene);
  add_measures(command, options->measures);
  command.flag("--json", options->json, "For a machine: one JSON object");
  command.footer("Examples:\n  candela info helmet.glb\n  candela info picture.exr --json");
  return [options] {
    if (options->file.empty()) throw UsageError("FILE: the name is empty");
    const bool built_in = options->file.starts_with("demo:");
    if (!built_in) io::check_inside(parse_image_name(options->file).path, options->root);
    const bool is_image = is_image_file(options->file), is_texture = !is_image && is_texture_file(options->file);
    if ((is_image || is_texture) && !options->measures.empty()) {
      throw UsageError("--unit and --up are of scenes, and " + options->file + " is none");
    }
    const Report report =
        is_image     ? image_report(options->file)
        : is_texture ? texture_report(options->file)
                     : scene_report(options->file,
                                    {.root = options->root, .scene = options->scene, .measures = options->measures});
    print(options->json ? report.json : report.text);
  };
}

}  // namespace candela::cli
