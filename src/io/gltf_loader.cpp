#include "io/gltf_loader.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <iterator>
#include <span>

#include "base/parallel.h"
#include "io/gltf_animation.h"
#include "io/gltf_extensions.h"
#include "io/gltf_info.h"
#include "io/gltf_material_reader.h"
#include "io/gltf_outline.h"

namespace candela::io {

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

/// A mesh as it was read for an earlier scene, in the materials of this one.
std::optional<Mesh> Loader::find_mesh(const MeshReader& reader, const MeshKey& key, Kept* kept) const {
  if (kept == nullptr) return std::nullopt;
  const auto found = kept->meshes.find(key);
  if (found == kept->meshes.end()) return std::nullopt;
  auto& [mesh, needs, sources] = found->second;
  const JsonView json = root_.at("meshes")[std::get<0>(key)];
  if (needs != reader.needs(json)) return std::nullopt;
  const std::vector<int> worn = reader.materials(json);
  bool is_same = true;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    is_same = is_same && mesh.primitives[i].material == worn[sources[i]];
    mesh.primitives[i].material = worn[sources[i]];
  }
  if (!is_same) mesh.identity = std::make_shared<const char>();
  return mesh;
}

/// For later scenes. What an animation morphs would be kept for every moment of it.
void Loader::keep_mesh(const MeshReader& reader, const MeshKey& key, std::vector<std::size_t> sources, Mesh& mesh,
                       Kept* kept) const {
  const auto& [number, weights, skin] = key;
  if (kept == nullptr || !(is_animated_ || kept->has_variants) || skin || !weights.empty()) return;
  mesh.identity = std::make_shared<const char>();
  kept->meshes.insert_or_assign(key, KeptMesh{mesh, reader.needs(root_.at("meshes")[number]), std::move(sources)});
}

Loader::ReadMesh Loader::read_mesh(MeshReader& reader, const MeshKey& key,
                                   std::map<std::size_t, std::vector<mat4>>& skins) {
  const auto& [mesh, weights, skin] = key;
  MeshPose pose{weights, {}};
  if (skin) {
    const auto [found, is_new] = skins.try_emplace(*skin);
    if (is_new) found->second = read_skin(root_.at("skins")[*skin], file_.nodes, reader_);
    pose.joints = found->second;
  }
  ReadMesh read;
  read.mesh = reader.read(root_.at("meshes")[mesh], static_cast<int>(mesh), pose, &read.sources);
  return read;
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

/// By index, on all cores, all but those that are known or have a skin or an outline; none where one of them cannot be
/// read.
std::vector<std::optional<Loader::ReadMesh>> Loader::read_meshes_at_once(
    const MeshReader& reader, const std::vector<std::optional<Mesh>>& known) {
  std::vector<const MeshKey*> keys(mesh_of_key_.size(), nullptr);
  for (const auto& [key, index] : mesh_of_key_) {
    if (!known[index] && !outlines_.contains(index) && !std::get<2>(key)) keys[index] = &key;
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
        read.mesh = own.read(root_.at("meshes")[mesh], static_cast<int>(mesh), MeshPose{weights, {}}, &read.sources);
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
  std::vector<std::optional<Mesh>> known(mesh_of_key_.size());
  for (const auto& [key, index] : mesh_of_key_) known[index] = find_mesh(reader, key, kept);
  std::vector<std::optional<ReadMesh>> at_once(mesh_of_key_.size());
  if (prepare_meshes()) at_once = read_meshes_at_once(reader, known);
  std::map<std::size_t, std::vector<mat4>> skins;
  for (const auto& [key, index] : mesh_of_key_) {
    const auto outline = outlines_.find(index);
    if (outline != outlines_.end()) {
      scene_.meshes.push_back(std::move(outline->second));
      continue;
    }
    if (known[index]) {
      scene_.meshes.push_back(*std::move(known[index]));
      continue;
    }
    ReadMesh read = at_once[index] ? *std::move(at_once[index]) : read_mesh(reader, key, skins);
    warnings_.add(read.diagnostics);
    reader.add_ignored(read.ignored);
    keep_mesh(reader, key, std::move(read.sources), read.mesh, kept);
    scene_.meshes.push_back(std::move(read.mesh));
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

}  // namespace candela::io
