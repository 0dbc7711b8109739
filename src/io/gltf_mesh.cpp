#include "io/gltf_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "io/gltf_outline.h"
#include "io/triangles.h"
#include "io/vertex_frames.h"
#include "scene/material_table.h"

namespace candela::io {

namespace {

// Beyond this a float has no fraction worth looking up; the limit keeps texture transforms finite.
constexpr float kLargestUv = 1e6f;

template <class V>
void add_scaled(std::vector<V>& values, const std::vector<V>& deltas, float weight) {
  for (std::size_t i = 0; i < values.size() && i < deltas.size(); ++i) values[i] += weight * deltas[i];
}

/// Whether some were out of range.
bool clamp_colors(std::vector<vec4>& colors) {
  bool is_any = false;
  for (vec4& c : colors) {
    const vec4 clamped = glm::clamp(c, vec4(0), vec4(1));
    is_any |= clamped != c;
    c = clamped;
  }
  return is_any;
}

void check_coordinates(const Primitive& primitive, const JsonView& json) {
  for (const vec3 p : primitive.positions) {
    // Written so that a NaN fails, too.
    if (!(max_component(glm::abs(p)) <= kLargestCoordinate)) {
      throw json.error(fmt::format("a position is beyond {:g} metres or not finite", kLargestCoordinate));
    }
  }
}

void clamp_uvs(std::vector<vec2>& uvs, const JsonView& json, Warnings& warnings) {
  bool clamped = false;
  for (vec2& uv : uvs) {
    for (int i = 0; i < 2; ++i) {
      if (std::fabs(uv[i]) <= kLargestUv) continue;
      uv[i] = std::isnan(uv[i]) ? 0.0f : std::copysign(kLargestUv, uv[i]);
      clamped = true;
    }
  }
  if (clamped) warnings.warn(fmt::format("texture coordinates beyond {:g} are clamped", kLargestUv), json);
}

/// Transposed adjugate: how normals turn, also under singular matrices; its sign makes mirrors keep the outside out.
mat3 normal_matrix(const mat3& m) {
  const mat3 cofactor(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  return glm::dot(m[0], cofactor[0]) < 0 ? -cofactor : cofactor;
}

}  // namespace

std::string uv_set_name(std::size_t set) { return fmt::format("TEXCOORD_{}", set); }

std::vector<mat4> read_skin(const JsonView& skin, const std::vector<FileNode>& nodes, AccessorReader& reader) {
  const JsonView joints = skin.at("joints");
  const std::size_t count = joints.size();
  if (count == 0) throw joints.error("a skin needs a joint");
  reader.charge(count * sizeof(mat4), skin);
  std::vector<mat4> result(count, mat4(1.0f));
  if (const auto reference = skin.find("inverseBindMatrices")) {
    const Accessor accessor = reader.open(*reference, {"MAT4"});
    if (accessor.count < count) throw reference->error(fmt::format("{} matrices for {} joints", accessor.count, count));
    std::vector<mat4> matrices = reader.read_as<mat4>(accessor);
    matrices.resize(count);
    result = std::move(matrices);
  }
  for (std::size_t i = 0; i < count; ++i) {
    result[i] = nodes[joints[i].index(nodes.size(), "node")].world_from_node * result[i];
  }
  return result;
}

std::optional<std::size_t> material_of_primitive(const JsonView& primitive, std::size_t material_count,
                                                 const std::optional<Variant>& variant) {
  const auto extension = variant ? primitive.extension("KHR_materials_variants") : std::nullopt;
  if (extension) {
    const JsonView mappings = extension->at("mappings");
    for (std::size_t i = 0; i < mappings.size(); ++i) {
      const JsonView variants = mappings[i].at("variants");
      for (std::size_t k = 0; k < variants.size(); ++k) {
        if (variants[k].index(variant->count, "variant") == variant->index) {
          return mappings[i].at("material").index(material_count, "material");
        }
      }
    }
  }
  return primitive.index_of("material", material_count, "material");
}

std::uint64_t mode_of_primitive(const JsonView& primitive) {
  const std::uint64_t mode = primitive.whole_or("mode", 4);
  return mode == 5 && primitive.extension("KHR_draco_mesh_compression") ? 4 : mode;
}

Mesh MeshReader::read(const JsonView& json, int file_index, const MeshPose& pose, std::vector<std::size_t>* sources) {
  Mesh mesh;
  mesh.name = json.string_or("name");
  mesh.file_index = file_index;
  const JsonView primitives = json.at("primitives");
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    auto primitive = read_primitive(primitives[i], pose);
    if (!primitive) continue;
    mesh.primitives.push_back(*std::move(primitive));
    if (sources != nullptr) sources->push_back(i);
  }
  return mesh;
}

void MeshReader::report_ignored(const JsonView& root) {
  if (ignored_ == 0) return;
  warnings_.warn(fmt::format("{} primitive{} made of points or lines {} ignored", ignored_, ignored_ == 1 ? "" : "s",
                             ignored_ == 1 ? "is" : "are"),
                 root);
}

std::vector<uvec3> MeshReader::read_triangles(const JsonView& json, std::uint64_t mode, std::size_t vertex_count) {
  std::vector<std::uint32_t> indices;
  if (const auto reference = json.find("indices")) {
    indices = reader_.read_indices(reader_.open(*reference, {"SCALAR"}), vertex_count);
  } else {
    reader_.charge(std::uint64_t{vertex_count} * sizeof(std::uint32_t), json);
    indices.resize(vertex_count);
    for (std::size_t i = 0; i < vertex_count; ++i) indices[i] = static_cast<std::uint32_t>(i);
  }
  if (mode == 4 && indices.size() % 3 != 0) warnings_.warn("a triangle list ends with an incomplete triangle", json);
  reader_.charge(std::uint64_t{indices.size()} * sizeof(std::uint32_t) * (mode == 4 ? 1 : 3), json);
  return assemble(indices, mode);
}

template <class V>
std::vector<V> MeshReader::read_attribute(const JsonView& attributes, const char* name, const char* type,
                                          std::size_t vertex_count, const Selection& selection) {
  const auto reference = attributes.find(name);
  if (!reference) return {};
  const Accessor accessor = reader_.open(*reference, {type});
  if (accessor.count != vertex_count) {
    throw reference->error(fmt::format("has {} elements, but POSITION has {}", accessor.count, vertex_count));
  }
  return reader_.read_as<V>(accessor, selection);
}

std::vector<vec4> MeshReader::read_colors(const JsonView& attributes, std::size_t vertex_count,
                                          const Selection& selection, float alpha) {
  const auto reference = attributes.find("COLOR_0");
  if (!reference) return {};
  if (reader_.open(*reference, {"VEC3", "VEC4"}).components == 4) {
    return read_attribute<vec4>(attributes, "COLOR_0", "VEC4", vertex_count, selection);
  }
  std::vector<vec4> result;
  for (const vec3 c : read_attribute<vec3>(attributes, "COLOR_0", "VEC3", vertex_count, selection)) {
    result.emplace_back(c, alpha);
  }
  return result;
}

void MeshReader::note_unread_colors(const JsonView& reference) {
  warnings_.note("COLOR_1 changes no pixel: of vertex colours glTF gives a meaning to COLOR_0 alone", reference);
}

Primitive MeshReader::read_vertices(const JsonView& attributes, const Accessor& positions, const Selection& selection,
                                    int material) {
  const std::size_t n = positions.count;
  Primitive result;
  result.positions = reader_.read_as<vec3>(positions, selection);
  result.normals = read_attribute<vec3>(attributes, "NORMAL", "VEC3", n, selection);
  if (!result.normals.empty()) result.tangents = read_attribute<vec4>(attributes, "TANGENT", "VEC4", n, selection);
  result.material = material;
  std::set<std::size_t> sets = {0, 1};
  for (const TextureSlot* slot : texture_slots(materials_[static_cast<std::size_t>(material)])) {
    if (*slot) sets.insert(static_cast<std::size_t>(slot->uv_set));
  }
  for (const std::size_t set : sets) {
    result.uvs[set] = read_attribute<vec2>(attributes, uv_set_name(set).c_str(), "VEC2", n, selection);
  }
  result.colors = read_colors(attributes, n, selection, 1.0f);
  if (clamp_colors(result.colors)) {
    warnings_.warn("vertex colours outside 0 to 1 are clamped", attributes.at("COLOR_0"));
  }
  if (const auto reference = attributes.find("COLOR_1")) {
    note_unread_colors(*reference);
  }
  return result;
}

void MeshReader::apply_morph(const JsonView& json, const std::vector<float>& weights, std::size_t vertex_count,
                             const Selection& selection, Primitive& primitive) {
  const auto targets = json.find("targets");
  if (!targets) return;
  const std::size_t n = vertex_count;
  for (std::size_t i = 0; i < targets->size() && i < weights.size(); ++i) {
    const float weight = weights[i];
    const JsonView target = (*targets)[i];
    if (weight == 0.0f) continue;
    add_scaled(primitive.positions, read_attribute<vec3>(target, "POSITION", "VEC3", n, selection), weight);
    add_scaled(primitive.normals, read_attribute<vec3>(target, "NORMAL", "VEC3", n, selection), weight);
    for (auto& [set, uvs] : primitive.uvs) {
      if (uvs.empty()) continue;
      add_scaled(uvs, read_attribute<vec2>(target, uv_set_name(set).c_str(), "VEC2", n, selection), weight);
    }
    if (!primitive.colors.empty()) {
      add_scaled(primitive.colors, read_colors(target, n, selection, 0.0f), weight);
    } else if (const auto reference = target.find("COLOR_0")) {
      warnings_.warn("a morph target moves COLOR_0, which the primitive has not; ignored", *reference);
    }
    const std::vector<vec3> tangents = read_attribute<vec3>(target, "TANGENT", "VEC3", n, selection);
    for (std::size_t k = 0; k < primitive.tangents.size() && k < tangents.size(); ++k) {
      primitive.tangents[k] += vec4(weight * tangents[k], 0);
    }
  }
  clamp_colors(primitive.colors);  // glTF 2.0 §3.7.2.2
}

void MeshReader::apply_skin(const JsonView& attributes, const std::vector<mat4>& joints, std::size_t vertex_count,
                            const Selection& selection, Primitive& primitive) {
  std::vector<mat4> blend(primitive.positions.size(), mat4(0.0f));
  std::vector<float> sums(primitive.positions.size(), 0.0f);
  reader_.charge(blend.size() * sizeof(mat4), attributes);
  for (int set = 0;; ++set) {
    const std::string joints_name = fmt::format("JOINTS_{}", set), weights_name = fmt::format("WEIGHTS_{}", set);
    const auto indices = read_attribute<vec4>(attributes, joints_name.c_str(), "VEC4", vertex_count, selection);
    if (indices.empty()) break;
    const auto weights = read_attribute<vec4>(attributes, weights_name.c_str(), "VEC4", vertex_count, selection);
    if (weights.empty()) throw attributes.error(fmt::format("{} without {}", joints_name, weights_name));
    for (std::size_t v = 0; v < blend.size(); ++v) {
      for (int k = 0; k < 4; ++k) {
        if (weights[v][k] == 0.0f) continue;
        const float index = indices[v][k];
        if (!(index >= 0 && index < static_cast<float>(joints.size()))) {
          throw attributes.at(joints_name.c_str())
              .error(fmt::format("joint {} does not exist (there are {})", index, joints.size()));
        }
        blend[v] += weights[v][k] * joints[static_cast<std::size_t>(index)];
        sums[v] += weights[v][k];
      }
    }
  }
  std::vector<bool> mirrored(blend.size());
  for (std::size_t v = 0; v < blend.size(); ++v) {
    if (sums[v] <= 0.0f) {
      warnings_.warn("a skinned vertex has no weight; it follows the first joint", attributes);
      blend[v] = joints[0];
      sums[v] = 1;
    }
    const mat4 m = blend[v] / sums[v];
    primitive.positions[v] = transform_point(m, primitive.positions[v]);
    const mat3 linear(m);
    if (!primitive.normals.empty()) primitive.normals[v] = normal_matrix(linear) * primitive.normals[v];
    if (!primitive.tangents.empty()) {
      primitive.tangents[v] = vec4(linear * vec3(primitive.tangents[v]), primitive.tangents[v].w);
    }
    mirrored[v] = glm::determinant(linear) < 0;
  }
  // What a mirrored joint turns inside out is turned back, as the sign of a node's determinant does for rigid meshes.
  for (uvec3& t : primitive.triangles) {
    if (mirrored[t.x] && mirrored[t.y] && mirrored[t.z]) std::swap(t.y, t.z);
  }
}

void MeshReader::finish_normals(const JsonView& json, Primitive& primitive) {
  if (!primitive.normals.empty()) {
    normalize_normals(primitive);
    return;
  }
  // Worst case per corner: position, normal, tangent, uvs, colour.
  const auto sets = static_cast<std::size_t>(std::distance(primitive.uvs.begin(), primitive.uvs.end()));
  reader_.charge(primitive.triangles.size() * 3 * (2 * sizeof(vec3) + 2 * sizeof(vec4) + sets * sizeof(vec2)), json);
  make_flat(primitive);
}

void MeshReader::warn_of_missing_uvs(const JsonView& json, const Material& material, int uv_set) {
  warnings_.warn(
      fmt::format("the material '{}' needs TEXCOORD_{}, which is missing; taken as 0", material.name, uv_set), json);
}

void MeshReader::fill_missing_uvs(const JsonView& json, Primitive& primitive) {
  const Material& m = materials_[static_cast<std::size_t>(primitive.material)];
  for (const TextureSlot* slot : texture_slots(m)) {
    auto& uvs = primitive.uvs[static_cast<std::size_t>(slot->uv_set)];
    if (!*slot || !uvs.empty()) continue;
    warn_of_missing_uvs(json, m, slot->uv_set);
    reader_.charge(primitive.positions.size() * sizeof(vec2), json);
    uvs.assign(primitive.positions.size(), vec2(0));
  }
}

void MeshReader::finish_tangents(const JsonView& json, Primitive& primitive) {
  const TextureSlot* slot = tangent_slot(materials_[static_cast<std::size_t>(primitive.material)]);
  if (slot == nullptr) {
    primitive.tangents = {};
  } else if (!primitive.tangents.empty()) {
    normalize_tangents(primitive);
  } else if (primitive.uvs[static_cast<std::size_t>(slot->uv_set)].empty()) {
    turn_tangents(primitive);
  } else {
    // Faces, edges and, in the worst case, a vertex per corner.
    reader_.charge(primitive.triangles.size() * 256, json);
    generate_tangents(*slot, primitive);
  }
}

int MeshReader::material_of(const JsonView& primitive) const {
  const auto of_file = material_of_primitive(primitive, material_of_file_.size(), variant_);
  return of_file ? material_of_file_[*of_file] : default_material_;
}

std::vector<int> MeshReader::materials(const JsonView& json) const {
  std::vector<int> result;
  const JsonView primitives = json.at("primitives");
  for (std::size_t i = 0; i < primitives.size(); ++i) result.push_back(material_of(primitives[i]));
  return result;
}

std::vector<VertexNeeds> MeshReader::needs(const JsonView& json) const {
  std::vector<VertexNeeds> result;
  const JsonView primitives = json.at("primitives");
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    VertexNeeds& needs = result.emplace_back();
    const int material = material_of(primitives[i]);
    if (material < 0) continue;  // of points and lines, which are not read
    const Material& m = materials_[static_cast<std::size_t>(material)];
    const auto slots = texture_slots(m);
    for (std::size_t k = 0; k < slots.size(); ++k) needs.uv_sets[k] = *slots[k] ? slots[k]->uv_set : -1;
    const TextureSlot* slot = tangent_slot(m);
    needs.has_tangents = slot != nullptr;
    // Where in the texture they begin makes no difference to tangents.
    if (slot != nullptr) needs.tangent_space = {slot->transform[0], slot->transform[1]};
  }
  return result;
}

/// Whether MikkTSpace has to say where vertices are split.
bool MeshReader::makes_tangents(const JsonView& primitive) const {
  const JsonView attributes = primitive.at("attributes");
  const TextureSlot* slot = tangent_slot(materials_[static_cast<std::size_t>(material_of(primitive))]);
  if (slot == nullptr || (attributes.find("TANGENT") && attributes.find("NORMAL"))) return false;
  return attributes.find(uv_set_name(static_cast<std::size_t>(slot->uv_set)).c_str()).has_value();
}

std::optional<Mesh> MeshReader::read_outline(const JsonView& json, int file_index, const JsonView& root,
                                             GltfBuffers& buffers) {
  const JsonView primitives = json.at("primitives");
  std::vector<Outline> outlines;
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    const auto outline = outline_of(root, primitives[i], buffers);
    if (!outline || makes_tangents(primitives[i])) return std::nullopt;
    outlines.push_back(*outline);
  }
  Mesh mesh;
  mesh.name = json.string_or("name");
  mesh.file_index = file_index;
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    const JsonView attributes = primitives[i].at("attributes");
    reader_.charge(outlines[i].vertices * sizeof(vec3) + outlines[i].triangles * sizeof(uvec3), primitives[i]);
    Primitive& primitive = mesh.primitives.emplace_back(make_stand_in(outlines[i]));
    primitive.material = material_of(primitives[i]);
    check_coordinates(primitive, attributes.at("POSITION"));
    const Material& material = materials_[static_cast<std::size_t>(primitive.material)];
    for (const TextureSlot* slot : texture_slots(material)) {
      const bool is_missing = *slot && !attributes.find(uv_set_name(static_cast<std::size_t>(slot->uv_set)).c_str());
      if (is_missing) warn_of_missing_uvs(primitives[i], material, slot->uv_set);
    }
    if (const auto second = attributes.find("COLOR_1")) note_unread_colors(*second);
  }
  return mesh;
}

std::optional<Primitive> MeshReader::read_primitive(const JsonView& json, const MeshPose& pose) {
  reader_.begin_primitive(json);
  const std::uint64_t mode = mode_of_primitive(json);
  if (mode > 6) throw json.at("mode").error(fmt::format("{} is not a primitive mode", mode));
  if (mode < 4) {
    ++ignored_;
    return std::nullopt;
  }
  const JsonView attributes = json.at("attributes");
  const auto position_reference = attributes.find("POSITION");
  if (!position_reference) {
    warnings_.warn("a primitive without POSITION is ignored", json);
    return std::nullopt;
  }
  const Accessor positions = reader_.open(*position_reference, {"VEC3"});
  std::vector<uvec3> triangles = read_triangles(json, mode, positions.count);
  if (triangles.empty()) return std::nullopt;
  const std::vector<std::uint32_t> used = compact(triangles, positions.count);
  const Selection selection =
      used.size() == positions.count ? Selection() : Selection(std::span<const std::uint32_t>(used));

  Primitive primitive = read_vertices(attributes, positions, selection, material_of(json));
  primitive.triangles = std::move(triangles);

  // Pose.
  apply_morph(json, pose.weights, positions.count, selection, primitive);
  if (!pose.joints.empty()) apply_skin(attributes, pose.joints, positions.count, selection, primitive);
  check_coordinates(primitive, *position_reference);

  for (auto& [set, uvs] : primitive.uvs) clamp_uvs(uvs, json, warnings_);

  // Triangles without an area neither show nor have a normal.
  std::erase_if(primitive.triangles, [&](const uvec3& t) { return area_vector(primitive, t) == dvec3(0); });
  if (primitive.triangles.empty()) return std::nullopt;

  finish_normals(json, primitive);
  fill_missing_uvs(json, primitive);
  finish_tangents(json, primitive);
  return primitive;
}

}  // namespace candela::io
