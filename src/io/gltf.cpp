#include "io/gltf.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <exception>
#include <iterator>
#include <map>
#include <set>
#include <span>
#include <tuple>

#include "base/file.h"
#include "base/parallel.h"
#include "io/foreign_scene.h"
#include "io/gltf_animation.h"
#include "io/gltf_areas.h"
#include "io/gltf_extensions.h"
#include "io/gltf_files.h"
#include "io/gltf_image_light.h"
#include "io/gltf_lights.h"
#include "io/gltf_material.h"
#include "io/gltf_material_reader.h"
#include "io/gltf_mesh.h"
#include "io/gltf_nodes.h"
#include "io/gltf_outline.h"
#include "io/gltf_pointer.h"
#include "io/scene_files.h"

namespace candela::io {

namespace fs = std::filesystem;

namespace {

std::vector<std::string> read_names(const JsonView& root, const char* key) {
  std::vector<std::string> result;
  const auto list = root.find(key);
  for (std::size_t i = 0; list && i < list->size(); ++i) result.push_back((*list)[i].string());
  return result;
}

std::vector<std::string> read_variants(const JsonView& root) {
  std::vector<std::string> result;
  const auto extension = root.extension("KHR_materials_variants");
  if (!extension) return result;
  const JsonView list = extension->at("variants");
  for (std::size_t i = 0; i < list.size(); ++i) result.push_back(list[i].at("name").string());
  return result;
}

/// The variant of that name, the first where several share it.
std::optional<Variant> find_variant(const JsonView& root, const FileInfo& info, const std::string& name) {
  if (name.empty()) return std::nullopt;
  const auto found = std::find(info.variants.begin(), info.variants.end(), name);
  if (found == info.variants.end()) {
    const std::string names = info.variants.empty() ? "none" : fmt::format("{}", fmt::join(info.variants, ", "));
    throw root.error(fmt::format("there is no variant '{}'; the file has: {}", name, names));
  }
  return Variant{static_cast<std::size_t>(found - info.variants.begin()), info.variants.size()};
}

FileInfo read_info(const GltfDocument& document, std::size_t file_bytes, const std::string& scene) {
  const JsonView root = document.root();
  FileInfo info;
  const auto asset = root.find("asset");
  if (!asset || !asset->find("version")) throw root.error("not a glTF 2.0 file: it has no asset version");
  info.version = asset->at("version").string();
  if (!info.version.starts_with("2.")) {
    throw asset->at("version").error(fmt::format("glTF {} is not supported (only 2.x)", info.version.substr(0, 20)));
  }
  const std::string minimum = asset->string_or("minVersion", "2.0");
  if (minimum != "2.0")
    throw asset->at("minVersion").error(fmt::format("glTF {} is not supported", minimum.substr(0, 20)));
  info.generator = asset->string_or("generator");
  info.copyright = asset->string_or("copyright");
  info.extensions_used = read_names(root, "extensionsUsed");
  info.extensions_required = read_names(root, "extensionsRequired");
  sort_extensions(document, info);
  info.variants = read_variants(root);
  info.animations = read_animation_list(root);
  info.scenes = read_scene_names(root);
  info.scene = find_scene(root, scene);
  info.skins = static_cast<int>(count_of(root, "skins"));
  info.file_bytes = file_bytes;
  return info;
}

/// The planes between which a camera sees (glTF 2.0 §5.13.3 and §5.14); what makes no sense is left out.
void read_planes(const JsonView& projection, bool is_perspective, Camera& camera, Warnings& warnings) {
  const float near = projection.real_or("znear", 0.0f);
  const auto zfar = projection.find("zfar");
  const float far = zfar ? zfar->real() : kInfinity;
  const bool has_near = near > 0.0f || (near == 0.0f && (!is_perspective || !projection.find("znear")));
  if (!has_near) {
    warnings.warn(fmt::format("a znear of {} is out of range; the camera sees what is near, too", near), projection);
  } else {
    camera.near_plane = near;
  }
  if (far > camera.near_plane) {
    camera.far_plane = far;
  } else {
    warnings.warn(
        fmt::format("a zfar of {} is not beyond the znear of {}; the camera sees what is far, too", far, near),
        projection);
  }
}

/// The lens of EXT_camera_physical; how far it sees to the sides is the core's own to say.
void read_lens(const JsonView& json, Camera& camera, Warnings& warnings) {
  const auto read = [&](const char* key, float fallback) {
    const float value = json.real_or(key, fallback);
    if (value >= 0.0f && (value > 0.0f || !json.find(key))) return value;
    warnings.warn(fmt::format("a {} of {} is out of range and is left out", key, value), json);
    return 0.0f;
  };
  camera.focal_length = read("focalLength", 0.0f);
  camera.f_number = read("fStop", 0.0f);
  camera.focus_distance = read("focusDistance", 0.0f);
}

Camera read_camera(const JsonView& json, Warnings& warnings) {
  Camera camera;
  camera.name = json.string_or("name");
  const std::string type = json.at("type").string();
  if (type == "perspective") {
    const JsonView perspective = json.at("perspective");
    PerspectiveCamera result;
    result.yfov = perspective.at("yfov").real();
    if (!(result.yfov > 0 && result.yfov < kPi)) throw perspective.at("yfov").error("must lie between 0 and pi");
    if (const auto ratio = perspective.find("aspectRatio")) {
      result.aspect_ratio = ratio->real();
      if (!(*result.aspect_ratio > 0)) throw ratio->error("must be positive");
    }
    camera.projection = result;
    read_planes(perspective, true, camera, warnings);
    if (const auto lens = json.extension("EXT_camera_physical")) read_lens(*lens, camera, warnings);
  } else if (type == "orthographic") {
    const JsonView orthographic = json.at("orthographic");
    OrthographicCamera result;
    // A negative value mirrors the picture; glTF 2.0 §5.12.1 asks not to write one.
    result.xmag = std::fabs(orthographic.at("xmag").real());
    result.ymag = std::fabs(orthographic.at("ymag").real());
    if (result.xmag == 0 || result.ymag == 0) throw orthographic.error("xmag and ymag must not be 0");
    camera.projection = result;
    read_planes(orthographic, false, camera, warnings);
  } else {
    throw json.at("type").error("must be perspective or orthographic");
  }
  return camera;
}

/// What one node shows: a mesh of the file with its weights, and, where skinned, the node whose skin moves it.
using MeshKey = std::tuple<std::size_t, std::vector<float>, std::optional<std::size_t>>;

/// A mesh, and what the materials of its primitives wanted when it was read.
struct KeptMesh {
  Mesh mesh;
  std::vector<VertexNeeds> needs;
};

/// What one scene of a file leaves to the next.
struct Kept {
  std::map<int, std::shared_ptr<const TextureImage>> images;  ///< by the file's index
  std::set<int> lost_images;                                  ///< that could not be read
  std::map<MeshKey, KeptMesh> meshes;                         ///< without a skin: the same wherever the nodes are
  std::vector<std::optional<Material>> materials;             ///< by the file's index, as they stand at rest
  KeptPanoramas panoramas;
};

class Loader {
 public:
  Loader(GltfDocument& document, const UriReader& uris, GltfBuffers& buffers, const LoadOptions& options,
         std::size_t file_bytes, Diagnostics& diagnostics)
      : document_(document),
        root_(document.root()),
        uris_(uris),
        options_(options),
        warnings_(diagnostics),
        buffers_(buffers),
        reader_(root_, buffers_, file_bytes, warnings_) {}

  /// With `kept` what is there is not read again, and what may serve again is put there.
  Scene load(const FileInfo& info, const std::optional<Pose>& pose, Kept* kept);

 private:
  /// A mesh that another thread has read, and what it had to say.
  struct ReadMesh {
    Mesh mesh = {};
    Diagnostics diagnostics = {};
    std::size_t ignored = 0;
  };

  void collect_meshes();
  void collect_materials(const MovedDocument& moved, Kept* kept);
  void outline_meshes(MeshReader& reader);
  std::vector<JsonView> draco_views() const;
  void read_meshes_and_images(Kept* kept);
  void read_meshes(Kept* kept);
  bool prepare_meshes();
  std::vector<std::optional<ReadMesh>> read_meshes_at_once(const MeshReader& reader);
  void take_images(Kept& kept);
  void plan_images();
  void lose_image(std::size_t image, const Error& cause);
  Mesh find_mesh(MeshReader& reader, const MeshKey& key, std::map<std::size_t, std::vector<mat4>>& skins, Kept* kept);
  Mesh read_mesh(MeshReader& reader, const MeshKey& key, std::map<std::size_t, std::vector<mat4>>& skins);
  void place_nodes();
  void read_cameras_and_lights();
  void place_mesh(std::size_t file_index, int mesh, const Box3& box, int scene_node, Node& node,
                  std::vector<Node>& appended);
  void place_area_light(std::size_t file_index, std::vector<Node>& appended);
  void check_extent(const mat4& world_from_mesh, std::size_t file_index, const Box3& box) const;
  void check_scale(const mat4& world_from_mesh, std::size_t file_index);

  GltfDocument& document_;
  JsonView root_;
  const UriReader& uris_;
  const LoadOptions& options_;
  Warnings warnings_;
  GltfBuffers& buffers_;
  AccessorReader reader_;
  FileScene file_;
  std::optional<Variant> variant_;
  std::map<MeshKey, std::size_t> mesh_of_key_;            ///< ordered, and so are the scene's meshes
  std::map<std::size_t, Mesh> outlines_;                  ///< of those that are not unpacked
  std::vector<std::optional<std::size_t>> mesh_of_node_;  ///< of the file
  std::map<std::size_t, int> camera_of_file_, light_of_file_, ies_light_of_node_;
  std::map<std::size_t, int> mesh_of_area_light_;
  MaterialSet materials_;
  std::vector<Reduction> reductions_;                    ///< by image
  std::vector<std::vector<std::size_t>> image_batches_;  ///< of images to be decoded, one after the other
  bool is_animated_ = false;                             ///< the file: there may be other moments
  bool is_posed_ = false;                                ///< by an animation, which may hide things by a scale of 0
  Scene scene_;
};

void Loader::collect_meshes() {
  mesh_of_node_.resize(file_.nodes.size());
  std::vector<std::pair<std::size_t, std::map<MeshKey, std::size_t>::iterator>> uses;
  std::map<std::size_t, std::vector<float>> default_weights;
  for (std::size_t i = 0; i < file_.nodes.size(); ++i) {
    FileNode& node = file_.nodes[i];
    if (!node.is_used || !node.mesh) continue;
    const JsonView mesh = root_.at("meshes")[*node.mesh];
    std::vector<float> weights = node.weights ? *node.weights : read_weights(root_.at("nodes")[i]);
    if (weights.empty()) {
      const auto [found, is_new] = default_weights.try_emplace(*node.mesh);
      if (is_new) found->second = read_weights(mesh);
      weights = found->second;
    }
    // Targets without weight change nothing: equal poses share a mesh.
    while (!weights.empty() && weights.back() == 0.0f) weights.pop_back();
    const auto found = mesh_of_key_.try_emplace(MeshKey(*node.mesh, std::move(weights), node.skin)).first;
    uses.emplace_back(i, found);
  }
  std::size_t count = 0;
  for (auto& [key, index] : mesh_of_key_) index = count++;
  for (const auto& [node, found] : uses) mesh_of_node_[node] = found->second;
}

/// Finds the meshes whose accessors say as much as unpacking them would; of the boxes of those that are turned, the
/// scene's would be too large.
void Loader::outline_meshes(MeshReader& reader) {
  std::vector<bool> is_exact(mesh_of_key_.size(), true);
  for (std::size_t i = 0; i < file_.nodes.size(); ++i) {
    if (!mesh_of_node_[i]) continue;
    const FileNode& node = file_.nodes[i];
    const bool is_instanced = root_.at("nodes")[i].extension("EXT_mesh_gpu_instancing").has_value();
    if (node.skin || is_instanced || !is_along_axes(node.world_from_node)) is_exact[*mesh_of_node_[i]] = false;
  }
  for (const auto& [key, index] : mesh_of_key_) {
    const auto& [mesh, weights, skin] = key;
    if (!is_exact[index] || !weights.empty()) continue;
    auto outline = reader.read_outline(root_.at("meshes")[mesh], static_cast<int>(mesh), root_, buffers_);
    if (outline) outlines_.emplace(index, *std::move(outline));
  }
}

/// References to the Draco data of all meshes that the scene uses and that are to be unpacked.
std::vector<JsonView> Loader::draco_views() const {
  std::vector<JsonView> views;
  for (const auto& entry : mesh_of_key_) {
    if (outlines_.contains(entry.second)) continue;
    const JsonView primitives = root_.at("meshes")[std::get<0>(entry.first)].at("primitives");
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      const auto draco = primitives[i].extension("KHR_draco_mesh_compression");
      if (draco) views.push_back(draco->at("bufferView"));
    }
  }
  return views;
}

void Loader::collect_materials(const MovedDocument& moved, Kept* kept) {
  std::vector<bool> used(count_of(root_, "materials"), false);
  bool want_default = false;
  std::vector<bool> seen(count_of(root_, "meshes"), false);
  for (const auto& entry : mesh_of_key_) {
    const std::size_t index = std::get<0>(entry.first);
    if (seen[index]) continue;
    seen[index] = true;
    const JsonView primitives = root_.at("meshes")[index].at("primitives");
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      const JsonView primitive = primitives[i];
      if (primitive.whole_or("mode", 4) < 4) continue;
      if (const auto material = material_of_primitive(primitive, used.size(), variant_)) {
        used[*material] = true;
      } else {
        want_default = true;
      }
    }
  }
  if (kept != nullptr) kept->materials.resize(used.size());
  const auto read = [&](std::size_t index) {
    const bool rests = kept != nullptr && !moved.has_moved_material(index);
    if (rests && kept->materials[index]) return *kept->materials[index];
    Material material = read_material(root_, root_.at("materials")[index], index, warnings_);
    if (rests) kept->materials[index] = material;
    return material;
  };
  materials_ = read_materials(root_, used, want_default, read, buffers_, warnings_);
  scene_.materials = materials_.materials;
  scene_.textures = materials_.textures;
  for (const ImageSource& image : materials_.images) scene_.image_file_indices.push_back(image.file_index);
}

/// A mesh as it was read for an earlier scene, where it can serve again.
Mesh Loader::find_mesh(MeshReader& reader, const MeshKey& key, std::map<std::size_t, std::vector<mat4>>& skins,
                       Kept* kept) {
  const auto& [mesh, weights, skin] = key;
  // What an animation morphs would be kept for every moment of it.
  if (kept == nullptr || !is_animated_ || skin || !weights.empty()) return read_mesh(reader, key, skins);
  std::vector<VertexNeeds> needs = reader.needs(root_.at("meshes")[mesh]);
  const auto found = kept->meshes.find(key);
  if (found != kept->meshes.end() && found->second.needs == needs) return found->second.mesh;
  Mesh result = read_mesh(reader, key, skins);
  result.identity = std::make_shared<const char>();
  kept->meshes.insert_or_assign(key, KeptMesh{result, std::move(needs)});
  return result;
}

Mesh Loader::read_mesh(MeshReader& reader, const MeshKey& key, std::map<std::size_t, std::vector<mat4>>& skins) {
  const auto& [mesh, weights, skin] = key;
  MeshPose pose{weights, {}};
  if (skin) {
    const auto [found, is_new] = skins.try_emplace(*skin);
    if (is_new) found->second = read_skin(root_.at("skins")[*skin], file_.nodes, reader_);
    pose.joints = found->second;
  }
  return reader.read(root_.at("meshes")[mesh], static_cast<int>(mesh), pose);
}

/// What cannot be read is replaced by what changes nothing: one white texel, which no material asks for any more.
void Loader::lose_image(std::size_t image, const Error& cause) {
  TextureImage white;
  white.width = white.height = 1;
  if (options_.decode_images) white.pixels.assign(4, 0xFF);
  scene_.images[image] = std::make_shared<const TextureImage>(std::move(white));
  const bool is_dark = drop_image(static_cast<int>(image), scene_.textures, scene_.materials);
  warnings_.warn(
      cause.message() + (is_dark ? "; shown without it, dark where it would say what glows" : "; shown without it"),
      cause.where());
}

/// Whether threads may share what the meshes' accessors lie in.
bool Loader::prepare_meshes() {
  // What moments leave to each other is read one by one.
  if (is_animated_ || mesh_of_key_.size() < 2) return false;
  try {
    for (const auto& [key, index] : mesh_of_key_) {
      if (outlines_.contains(index)) continue;
      const JsonView primitives = root_.at("meshes")[std::get<0>(key)].at("primitives");
      for (std::size_t i = 0; i < primitives.size(); ++i) reader_.prepare(primitives[i]);
    }
  } catch (const Error&) {
    return false;  // reading them in order finds out which is the first that cannot be read
  }
  return true;
}

/// By index, on all cores, all but those with a skin or an outline; none where one of them cannot be read.
std::vector<std::optional<Loader::ReadMesh>> Loader::read_meshes_at_once(const MeshReader& reader) {
  std::vector<const MeshKey*> keys(mesh_of_key_.size(), nullptr);
  for (const auto& [key, index] : mesh_of_key_) {
    if (!outlines_.contains(index) && !std::get<2>(key)) keys[index] = &key;
  }
  std::vector<std::optional<ReadMesh>> meshes(keys.size());
  std::atomic<bool> has_failed = false;
  const std::uint64_t charged = reader_.charged();
  parallel_for(0, keys.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end && !has_failed; ++i) {
      if (keys[i] == nullptr) continue;
      const auto& [mesh, weights, skin] = *keys[i];
      ReadMesh read;
      Warnings warnings(read.diagnostics);
      AccessorReader accessors(reader_, warnings);
      MeshReader own(reader, accessors, warnings);
      try {
        read.mesh = own.read(root_.at("meshes")[mesh], static_cast<int>(mesh), MeshPose{weights, {}});
        read.ignored = own.ignored();
        meshes[i] = std::move(read);
      } catch (const Error&) {
        has_failed = true;
      }
    }
  });
  if (!has_failed) return meshes;
  reader_.set_charged(charged);
  return std::vector<std::optional<ReadMesh>>(keys.size());
}

void Loader::read_meshes(Kept* kept) {
  MeshReader reader(reader_, warnings_, materials_.materials, materials_.material_of_file, materials_.default_material,
                    variant_);
  if (!options_.unpack_geometry) outline_meshes(reader);
  buffers_.decode_draco(draco_views());
  std::vector<std::optional<ReadMesh>> at_once(mesh_of_key_.size());
  if (prepare_meshes()) at_once = read_meshes_at_once(reader);
  std::map<std::size_t, std::vector<mat4>> skins;
  for (const auto& [key, index] : mesh_of_key_) {
    const auto outline = outlines_.find(index);
    if (outline != outlines_.end()) {
      scene_.meshes.push_back(std::move(outline->second));
    } else if (auto& read = at_once[index]) {
      warnings_.add(read->diagnostics);
      reader.add_ignored(read->ignored);
      scene_.meshes.push_back(std::move(read->mesh));
    } else {
      scene_.meshes.push_back(find_mesh(reader, key, skins, kept));
    }
  }
  reader.report_ignored(root_);
}

/// Those that an earlier scene has left.
void Loader::take_images(Kept& kept) {
  for (std::size_t i = 0; i < scene_.images.size(); ++i) {
    const auto found = kept.images.find(materials_.images[i].file_index);
    if (found != kept.images.end()) scene_.images[i] = found->second;
  }
}

/// How small images are to be, and which are decoded at a time.
void Loader::plan_images() {
  const std::size_t count = materials_.images.size();
  reductions_.resize(count);
  image_batches_.resize(1);
  if (options_.texture_memory == 0 || !options_.decode_images) {
    for (std::size_t i = 0; i < count; ++i) {
      if (scene_.images[i] == nullptr) image_batches_[0].push_back(i);
    }
    return;
  }
  const ImageUses uses = uses_of_images(materials_.materials, materials_.textures, count);
  std::vector<TextureExtent> extents(count);
  parallel_for(0, count, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (const auto& image = scene_.images[i]) {
        extents[i] = {.size = {image->width, image->height}, .bits = image->bits, .is_here = true};
      } else {
        extents[i] = measure_image(materials_.images[i], uris_);
      }
      if (options_.counts_texture_levels) extents[i].copies = uses.copies[i];
    }
  });
  TexturePlan plan;
  try {
    plan = plan_textures(extents, {options_.texture_memory, options_.counts_texture_levels}, thread_count());
  } catch (const Error& cause) {
    throw root_.at("images").error(cause.message());
  }
  for (std::size_t i = 0; i < count; ++i) reductions_[i] = {plan.levels[i], uses.kinds[i]};
  if (!plan.batches.empty()) image_batches_ = std::move(plan.batches);
  if (!plan.told.empty()) warnings_.warn(plan.told, root_.at("images"));
}

/// Geometry is one task, each image another. Of several oddities the geometry's, then the first image's comes first.
void Loader::read_meshes_and_images(Kept* kept) {
  const std::size_t image_count = materials_.images.size();
  scene_.images.resize(image_count);
  std::vector<std::optional<Error>> lost(image_count);
  std::vector<std::string> odd(image_count);
  if (kept != nullptr) take_images(*kept);
  plan_images();
  std::exception_ptr error;
  std::atomic<std::uint64_t> texels = 0;
  const auto read_image = [&](std::size_t i) {
    try {
      scene_.images[i] =
          load_image(materials_.images[i], uris_, options_.decode_images, reductions_[i], texels, odd[i]);
    } catch (const Error& cause) {
      lost[i] = cause;
    }
  };
  bool has_meshes = false;
  for (const std::vector<std::size_t>& batch : image_batches_) {
    const std::size_t first = has_meshes ? 0 : 1;
    parallel_for(0, first + batch.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t task = begin; task < end; ++task) {
        if (task >= first) {
          read_image(batch[task - first]);
          continue;
        }
        try {
          read_meshes(kept);
        } catch (...) {
          error = std::current_exception();
        }
      }
    });
    has_meshes = true;
    if (error) std::rethrow_exception(error);
  }
  if (texels > kMostTexels) {
    throw root_.at("images").error(fmt::format(
        "the textures have more than {} texels in total; limit what they take (--texture-memory)", kMostTexels));
  }
  for (std::size_t i = 0; i < image_count; ++i) {
    const int number = materials_.images[i].file_index;
    if (!odd[i].empty()) warnings_.warn(odd[i], materials_.images[i].label);
    if (lost[i]) {
      lose_image(i, *lost[i]);
    } else if (kept != nullptr && kept->lost_images.contains(number)) {
      drop_image(static_cast<int>(i), scene_.textures, scene_.materials);
    }
    if (kept == nullptr) continue;
    kept->images.emplace(number, scene_.images[i]);
    if (lost[i]) kept->lost_images.insert(number);
  }
}

void Loader::read_cameras_and_lights() {
  for (const FileNode& node : file_.nodes) {
    if (node.in_scene && node.camera) camera_of_file_[*node.camera] = 0;
    if (node.is_used && node.light) light_of_file_[*node.light] = 0;
  }
  for (auto& [file_index, index] : camera_of_file_) {
    index = static_cast<int>(scene_.cameras.size());
    scene_.cameras.push_back(read_camera(root_.at("cameras")[file_index], warnings_));
    scene_.cameras.back().file_index = static_cast<int>(file_index);
  }
  LightReader lights(root_, buffers_, uris_, warnings_, scene_);
  for (auto& [file_index, index] : light_of_file_) index = lights.add_punctual(file_index);
  for (std::size_t i = 0; i < file_.nodes.size(); ++i) {
    const FileNode& node = file_.nodes[i];
    if (node.is_used && node.ies) ies_light_of_node_[i] = lights.add_ies(*node.ies);
  }
}

/// World coordinates obey the limit of a mesh's own.
void Loader::check_extent(const mat4& world_from_mesh, std::size_t file_index, const Box3& box) const {
  for (int corner = 0; corner < 8; ++corner) {
    const vec3 p((corner & 1) != 0 ? box.upper.x : box.lower.x, (corner & 2) != 0 ? box.upper.y : box.lower.y,
                 (corner & 4) != 0 ? box.upper.z : box.lower.z);
    const vec3 world = glm::abs(transform_point(world_from_mesh, p));
    if (!(max_component(world) <= kLargestCoordinate)) {
      throw root_.at("nodes")[file_index].error(
          fmt::format("the mesh reaches beyond {:g} metres from the origin", kLargestCoordinate));
    }
  }
}

/// A mesh that is flat because of a scale of 0, its node's own or one above it, and that nobody hides on purpose.
void Loader::check_scale(const mat4& world_from_mesh, std::size_t file_index) {
  if (is_posed_) return;
  glm::dmat3 linear(world_from_mesh);
  bool is_flat = false;
  for (int i = 0; i < 3; ++i) {
    const double length = glm::length(linear[i]);
    is_flat |= !(length > 0.0);
    if (length > 0.0) linear[i] /= length;
  }
  // Below what rounding leaves of three axes in one plane.
  if (!is_flat && std::fabs(glm::determinant(linear)) > 1e-9) return;
  const std::string& name = file_.nodes[file_index].name;
  warnings_.warn(fmt::format("node {}{}: a scale of 0 flattens its mesh", file_index,
                             name.empty() ? "" : fmt::format(" '{}'", name)),
                 root_.at("nodes")[file_index]);
}

/// Puts a mesh into its node, or where it hangs on other transforms than the node's into nodes of its own.
void Loader::place_mesh(std::size_t file_index, int mesh, const Box3& box, int scene_node, Node& node,
                        std::vector<Node>& appended) {
  const FileNode& source = file_.nodes[file_index];
  const JsonView json = root_.at("nodes")[file_index];
  if (const auto instancing = json.extension("EXT_mesh_gpu_instancing")) {
    const Instances instances = read_instances(*instancing, reader_, warnings_);
    for (std::size_t i = 0; i < instances.node_from_instance.size(); ++i) {
      Node instance;
      instance.name = source.name;
      instance.parent = scene_node;
      instance.parent_from_node = instances.node_from_instance[i];
      instance.mesh = mesh;
      instance.file_index = static_cast<int>(file_index);
      if (!instances.colors.empty()) instance.color = instances.colors[i];
      const mat4 world_from_mesh = source.world_from_node * instance.parent_from_node;
      check_extent(world_from_mesh, file_index, box);
      check_scale(world_from_mesh, file_index);
      appended.push_back(std::move(instance));
    }
  } else if (source.skin) {
    Node posed;
    posed.name = source.name;
    posed.mesh = mesh;
    posed.file_index = static_cast<int>(file_index);
    appended.push_back(std::move(posed));
  } else {
    check_extent(source.world_from_node, file_index, box);
    check_scale(source.world_from_node, file_index);
    node.mesh = mesh;
  }
}

/// As a mesh that glows, of a node of its own: it grows with its node to all sides alike.
void Loader::place_area_light(std::size_t file_index, std::vector<Node>& appended) {
  const FileNode& source = file_.nodes[file_index];
  const auto place = place_of_area_light(source.world_from_node);
  if (!place) return;
  const std::size_t light = *source.area_light;
  const auto [found, is_new] = mesh_of_area_light_.try_emplace(light, -1);
  if (is_new) {
    found->second = add_area_light(root_.extension("EXT_lights_area")->at("lights")[light], scene_, warnings_);
  }
  const Mesh& mesh = scene_.meshes[static_cast<std::size_t>(found->second)];
  if (mesh.primitives.empty()) return;
  Box3 box;
  for (const vec3 p : mesh.primitives[0].positions) box.extend(p);
  check_extent(*place, file_index, box);
  Node lamp;
  lamp.name = source.name;
  lamp.parent_from_node = *place;
  lamp.mesh = found->second;
  lamp.file_index = static_cast<int>(file_index);
  appended.push_back(std::move(lamp));
}

void Loader::place_nodes() {
  std::vector<int> node_of_file(file_.nodes.size(), -1);
  int count = 0;
  for (std::size_t i = 0; i < file_.nodes.size(); ++i) {
    if (file_.nodes[i].in_scene) node_of_file[i] = count++;
  }
  std::vector<Box3> boxes(scene_.meshes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (const Primitive& primitive : scene_.meshes[i].primitives) {
      for (const vec3 p : primitive.positions) boxes[i].extend(p);
    }
  }
  std::vector<Node> appended;
  for (std::size_t i = 0; i < file_.nodes.size(); ++i) {
    const FileNode& source = file_.nodes[i];
    if (!source.in_scene) continue;
    Node node;
    node.name = source.name;
    node.parent = source.parent ? node_of_file[*source.parent] : -1;
    node.parent_from_node = source.parent_from_node;
    node.file_index = static_cast<int>(i);
    if (source.camera) node.camera = camera_of_file_.at(*source.camera);
    node.is_hidden = !source.is_shown;
    if (!source.is_shown) {
      scene_.nodes.push_back(std::move(node));
      continue;
    }
    if (source.light) node.light = light_of_file_.at(*source.light);
    if (source.area_light) place_area_light(i, appended);
    const auto mesh = mesh_of_node_[i];
    if (mesh && !scene_.meshes[*mesh].primitives.empty()) {
      place_mesh(i, static_cast<int>(*mesh), boxes[*mesh], node_of_file[i], node, appended);
    }
    if (source.ies && node.light < 0) {
      node.light = ies_light_of_node_.at(i);
    } else if (source.ies) {
      Node second;
      second.name = source.name;
      second.parent = node_of_file[i];
      second.file_index = static_cast<int>(i);
      second.light = ies_light_of_node_.at(i);
      appended.push_back(second);
    }
    scene_.nodes.push_back(std::move(node));
  }
  scene_.nodes.insert(scene_.nodes.end(), appended.begin(), appended.end());
}

Scene Loader::load(const FileInfo& info, const std::optional<Pose>& pose, Kept* kept) {
  check_extensions(root_, info, options_.refuse_unknown_required, warnings_);
  variant_ = find_variant(root_, info, options_.variant);
  is_posed_ = pose.has_value();
  is_animated_ = !info.animations.empty();
  check_channels(root_, document_.json(), warnings_);
  std::vector<AnimatedMoment> moments;
  for (const std::size_t index : pose ? find_animations(root_, pose->animation) : std::vector<std::size_t>()) {
    moments.emplace_back(root_, document_.json(), index, pose->time_s, reader_, warnings_);
  }
  MovedDocument moved(document_.json());
  for (const AnimatedMoment& moment : moments) moment.move_properties(moved);
  file_ = read_nodes(root_, info.scene, warnings_, [&](std::vector<FileNode>& nodes) {
    for (const AnimatedMoment& moment : moments) moment.pose_nodes(nodes);
  });
  scene_.name = file_.name;
  collect_meshes();
  collect_materials(moved, kept);
  read_meshes_and_images(kept);
  read_cameras_and_lights();
  scene_.image_light = read_image_light(root_, info.scene, buffers_, uris_, options_.decode_images,
                                        kept != nullptr ? &kept->panoramas : nullptr, warnings_);
  place_nodes();
  update_world_transforms(scene_);
  if (options_.decode_images && options_.unpack_geometry) validate(scene_);
  return std::move(scene_);
}

}  // namespace

struct GltfFile::Parts {
  std::vector<std::byte> bytes;
  LoadOptions options;
  GltfDocument document;
  UriReader uris;
  GltfBuffers buffers;
  FileInfo info;
  Kept kept;
  std::string scene_name;  ///< where the file gives none

  Parts(SceneSource source, LoadOptions load_options, Diagnostics& diagnostics)
      : bytes(std::move(source.bytes)),
        options(std::move(load_options)),
        document(bytes, std::move(source.label), diagnostics),
        uris(std::move(source.files)),
        buffers(document, uris),
        info(read_info(document, bytes.size(), options.scene)) {
    check_references(document.root(), document.json(), uris);
    info.files = referenced_files(document.json(), uris);
    info.archive_entry = std::move(source.entry);
  }
};

GltfFile::GltfFile(std::vector<std::byte> bytes, const fs::path& base_folder, std::string label,
                   Diagnostics& diagnostics, const LoadOptions& options, FileInfo* info)
    : parts_(std::make_unique<Parts>(open_scene(std::move(bytes), base_folder, std::move(label), options.root), options,
                                     diagnostics)) {
  if (info) *info = parts_->info;
}

GltfFile::GltfFile(const fs::path& path, Diagnostics& diagnostics, const LoadOptions& options, FileInfo* info) {
  SceneSource source = open_gltf(path, options.root, options.measures, diagnostics);
  const std::string format = source.format;
  const std::size_t file_bytes = source.file_bytes;
  std::vector<ReferencedFile> read = files_of_source(path, source);
  parts_ = std::make_unique<Parts>(std::move(source), options, diagnostics);
  parts_->scene_name = path.stem().string();
  parts_->info.format = format;
  parts_->info.file_bytes = file_bytes;
  parts_->info.files.insert(parts_->info.files.begin(), read.begin(), read.end());
  if (info) *info = parts_->info;
}

GltfFile::~GltfFile() = default;

const FileInfo& GltfFile::info() const { return parts_->info; }

std::vector<std::size_t> GltfFile::find_animations(const std::string& name) const {
  return io::find_animations(parts_->document.root(), name);
}

Scene GltfFile::scene(Diagnostics& diagnostics, const std::optional<Pose>& pose,
                      const std::optional<std::string>& variant) {
  Parts& p = *parts_;
  if (variant && *variant != p.options.variant) {
    p.options.variant = *variant;
    p.kept.meshes.clear();  // they name materials of another
  }
  Loader loader(p.document, p.uris, p.buffers, p.options, p.bytes.size(), diagnostics);
  Scene scene = loader.load(p.info, pose, &p.kept);
  if (scene.name.empty()) scene.name = p.scene_name;
  return scene;
}

Scene load_gltf(const fs::path& path, Diagnostics& diagnostics) { return load_gltf(path, diagnostics, LoadOptions()); }

Scene load_gltf(const fs::path& path, Diagnostics& diagnostics, const LoadOptions& options, FileInfo* info) {
  return GltfFile(path, diagnostics, options, info).scene(diagnostics);
}

Scene load_gltf(std::span<const std::byte> bytes, const fs::path& base_folder, Diagnostics& diagnostics) {
  return load_gltf(bytes, base_folder, diagnostics, LoadOptions());
}

Scene load_gltf(std::span<const std::byte> bytes, const fs::path& base_folder, Diagnostics& diagnostics,
                const LoadOptions& options, FileInfo* info) {
  return GltfFile({bytes.begin(), bytes.end()}, base_folder, "glTF in memory", diagnostics, options, info)
      .scene(diagnostics);
}

}  // namespace candela::io
