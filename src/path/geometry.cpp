#include "path/geometry.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <map>
#include <tuple>

#include "base/error.h"
#include "base/large_pages.h"
#include "base/parallel.h"
#include "math/hash.h"
#include "path/bodies.h"
#include "path/displacement.h"
#include "path/embree.h"
#include "path/surface_point.h"
#include "scene/cutoff.h"
#include "scene/ground.h"
#include "scene/surface_params.h"
#include "shade/surface.glsl.h"

namespace candela::path {

namespace {

/// What the filter callbacks need to know of a ray beside Embree's own context, which must come first.
struct QueryContext {
  RayContext base;
  const std::uint32_t* seeds = nullptr;  ///< per ray id; null for shadow rays and where opacity ½ decides
  const Geometry* geometry = nullptr;    ///< of a single ray with a filter of its own, as the rest
  vec3 direction{0.0f};
  vec3 transmittance{1.0f};               ///< so far
  std::span<const Hit> passed;            ///< what is not met again
  RTCFilterFunctionN filter = nullptr;    ///< what else a query around a hit asks
  const Hit* met = nullptr;               ///< that hit
  Hit* front = nullptr;                   ///< what is in front of all that is found in its plane
  std::vector<Hit>* collected = nullptr;  ///< of queries that go on after every hit
};

float hit_opacity(const RTCFilterFunctionNArguments* arguments, unsigned lane) {
  const auto& mesh = *static_cast<const MeshData*>(arguments->geometryUserPtr);
  const unsigned triangle = RTCHitN_primID(arguments->hit, arguments->N, lane);
  const float u = RTCHitN_u(arguments->hit, arguments->N, lane);
  const float v = RTCHitN_v(arguments->hit, arguments->N, lane);
  return mesh.opacity(mesh.triangles[triangle], {1.0f - u - v, u, v});
}

/// Whether the ray leaves a body. Embree has taken it to where the mesh is.
bool leaves_body(const RTCFilterFunctionNArguments* arguments, unsigned lane) {
  const auto& mesh = *static_cast<const MeshData*>(arguments->geometryUserPtr);
  if (!mesh.material->has_medium) return false;
  const uvec3 t = mesh.triangles[RTCHitN_primID(arguments->hit, arguments->N, lane)];
  const vec3 p = mesh.vertices[t.x].position;
  const vec3 direction(RTCRayN_dir_x(arguments->ray, arguments->N, lane),
                       RTCRayN_dir_y(arguments->ray, arguments->N, lane),
                       RTCRayN_dir_z(arguments->ray, arguments->N, lane));
  const float side = glm::dot(glm::cross(mesh.vertices[t.y].position - p, mesh.vertices[t.z].position - p), direction);
  return mesh.is_mirrored ? side < 0.0f : side > 0.0f;
}

/// Closest hit: a surface of opacity a is there with probability a. The far side of a body always is: who has entered
/// has to learn that he leaves (Walk::find_crossing decides there).
void filter_closest(const RTCFilterFunctionNArguments* arguments) {
  const auto& context = *reinterpret_cast<const QueryContext*>(arguments->context);
  for (unsigned i = 0; i < arguments->N; ++i) {
    if (arguments->valid[i] == 0) continue;
    const float opacity = hit_opacity(arguments, i);
    if (context.seeds == nullptr) {
      if (opacity < kOpacityOfLayers) arguments->valid[i] = 0;
      continue;
    }
    if (opacity >= 1.0f || leaves_body(arguments, i)) continue;
    const unsigned id = RTCRayN_id(arguments->ray, arguments->N, i);
    const unsigned geometry = RTCHitN_geomID(arguments->hit, arguments->N, i);
    const unsigned instance = RTCHitN_instID(arguments->hit, arguments->N, i, 0);
    const unsigned triangle = RTCHitN_primID(arguments->hit, arguments->N, i);
    const std::uint32_t surface = hash_combine(hash_combine(geometry, instance), triangle);
    if (unit_float(hash_combine(context.seeds[id], surface)) >= opacity) arguments->valid[i] = 0;
  }
}

/// A hit of a single ray.
Hit filtered_hit(const QueryContext& context, const RTCFilterFunctionNArguments* arguments) {
  const unsigned n = arguments->N;
  Hit hit = context.geometry->hit(RTCHitN_instID(arguments->hit, n, 0, 0), RTCHitN_geomID(arguments->hit, n, 0),
                                  RTCHitN_primID(arguments->hit, n, 0), RTCHitN_u(arguments->hit, n, 0),
                                  RTCHitN_v(arguments->hit, n, 0));
  hit.t = RTCRayN_tfar(arguments->ray, n, 0);
  return hit;
}

/// Any hit: multiply up what passes, go on until something is opaque.
void filter_shadow(const RTCFilterFunctionNArguments* arguments) {
  auto& context = *reinterpret_cast<QueryContext*>(arguments->context);
  if (context.collected != nullptr) return;
  if (arguments->valid[0] == 0) return;
  const vec3 passing = context.geometry->transmittance(filtered_hit(context, arguments), context.direction);
  if (max_component(passing) <= 0.0f) return;
  context.transmittance *= passing;
  arguments->valid[0] = 0;
}

/// Of a query: the eye looks through backs.
void filter_visible(const RTCFilterFunctionNArguments* arguments) {
  const auto& context = *reinterpret_cast<const QueryContext*>(arguments->context);
  if (arguments->valid[0] == 0) return;
  const Hit hit = filtered_hit(context, arguments);
  const bool is_hidden = context.seeds == nullptr && context.geometry->placement(hit.placement).is_ground;
  if (is_hidden || is_culled_back(*context.geometry, hit, context.direction)) arguments->valid[0] = 0;
}

/// Of a query: what has been met is not met again.
void filter_passed(const RTCFilterFunctionNArguments* arguments) {
  const auto& context = *reinterpret_cast<const QueryContext*>(arguments->context);
  if (arguments->valid[0] == 0) return;
  const Hit hit = filtered_hit(context, arguments);
  for (const Hit& passed : context.passed) {
    if (is_one_surface(*context.geometry, passed, hit, context.direction)) arguments->valid[0] = 0;
  }
}

/// Which of the surfaces in one plane a ray meets: no back that the eye looks through; the ground under all others;
/// over the rest what shows what is behind it, as the rasterizer draws it; of two alike the one that comes later in the
/// scene.
auto rank_in_plane(const Geometry& geometry, const Hit& hit, vec3 direction) {
  const Placement& placement = geometry.placement(hit.placement);
  const MaterialData& material = *placement.mesh->material;
  const bool shows_through =
      material.factors.alpha_mode == AlphaMode::blend || (material.params.lobes & shade::kLobeTransmission) != 0;
  return std::tuple(!is_culled_back(geometry, hit, direction), !placement.is_ground, shows_through, hit.placement,
                    hit.triangle);
}

/// Bodies that touch are told apart by Place::enter_before_leaving.
bool are_of_bodies(const Geometry& geometry, const Hit& a, const Hit& b) {
  return geometry.placement(a.placement).body != 0 && geometry.placement(b.placement).body != 0;
}

/// Of a query around a hit: notes what is in front, and goes on.
void filter_in_front(const RTCFilterFunctionNArguments* arguments) {
  auto& context = *reinterpret_cast<QueryContext*>(arguments->context);
  if (arguments->valid[0] != 0 && context.filter != nullptr) context.filter(arguments);
  if (arguments->valid[0] == 0) return;
  arguments->valid[0] = 0;
  const Geometry& geometry = *context.geometry;
  const Hit hit = filtered_hit(context, arguments);
  const bool is_over =
      rank_in_plane(geometry, *context.front, context.direction) < rank_in_plane(geometry, hit, context.direction);
  if (is_over && !are_of_bodies(geometry, *context.met, hit) && are_in_one_plane(geometry, *context.met, hit)) {
    *context.front = hit;
  }
}

/// Of a query: notes everything, and goes on.
void filter_everything(const RTCFilterFunctionNArguments* arguments) {
  const auto& context = *reinterpret_cast<const QueryContext*>(arguments->context);
  if (arguments->valid[0] == 0) return;
  context.collected->push_back(filtered_hit(context, arguments));
  arguments->valid[0] = 0;
}

/// Of a query: notes the faces of bodies, and goes on.
void filter_boundaries(const RTCFilterFunctionNArguments* arguments) {
  const auto& context = *reinterpret_cast<const QueryContext*>(arguments->context);
  if (arguments->valid[0] == 0) return;
  const Hit hit = filtered_hit(context, arguments);
  if (context.geometry->placement(hit.placement).body != 0) context.collected->push_back(hit);
  arguments->valid[0] = 0;
}

/// Of a query: notes what the eye could see, and goes on.
void filter_surfaces(const RTCFilterFunctionNArguments* arguments) {
  const auto& context = *reinterpret_cast<const QueryContext*>(arguments->context);
  if (arguments->valid[0] == 0) return;
  const Hit hit = filtered_hit(context, arguments);
  const bool is_there = hit_opacity(arguments, 0) >= kOpacityOfLayers &&
                        !context.geometry->placement(hit.placement).is_ground &&
                        !is_culled_back(*context.geometry, hit, context.direction);
  if (is_there) context.collected->push_back(hit);
  arguments->valid[0] = 0;
}

RTCRay embree_ray(const Ray& ray) {
  RTCRay query;
  query.org_x = ray.origin.x;
  query.org_y = ray.origin.y;
  query.org_z = ray.origin.z;
  query.dir_x = ray.direction.x;
  query.dir_y = ray.direction.y;
  query.dir_z = ray.direction.z;
  query.tnear = ray.t_min;
  query.tfar = ray.t_max;
  query.time = 0.0f;
  query.mask = ~0U;
  query.id = 0;
  query.flags = 0;
  return query;
}

GeometryHandle make_triangles(RTCDevice device, MeshData& mesh) {
  GeometryHandle geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE));
  rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.vertices.data(), 0,
                             sizeof(ShadeVertex), mesh.vertices.size());
  rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                             sizeof(uvec3), mesh.triangles.size());
  rtcSetGeometryUserData(geometry.get(), &mesh);
  if (mesh.material->needs_opacity) rtcSetGeometryIntersectFilterFunction(geometry.get(), filter_closest);
  if (mesh.material->needs_opacity || mesh.material->is_clear_sheet) {
    rtcSetGeometryOccludedFilterFunction(geometry.get(), filter_shadow);
  }
  rtcCommitGeometry(geometry.get());
  return geometry;
}

constexpr std::size_t kVertexGrain = 1 << 14;

void fill_vertices(const Primitive& primitive, const Placement* to_world, std::vector<ShadeVertex>& vertices) {
  const std::vector<vec2>& uvs = primitive.uvs[0];
  parallel_for(0, vertices.size(), kVertexGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      ShadeVertex& v = vertices[i];
      v.position = primitive.positions[i];
      v.normal = primitive.normals[i];
      v.uv0 = uvs.empty() ? vec2(0.0f) : uvs[i];
      if (to_world == nullptr) continue;
      v.position = transform_point(to_world->world_from_object, v.position);
      const vec3 n = to_world->world_from_normal * v.normal;
      const float length = glm::length(n);
      v.normal = length > 0.0f ? n / length : vec3(0, 1, 0);
    }
  });
}

/// Of a mesh in world space.
std::vector<vec4> turned(const std::vector<vec4>& tangents, const Placement& to_world) {
  std::vector<vec4> result(tangents.size());
  parallel_for(0, tangents.size(), kVertexGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const vec4& t = tangents[i];
      result[i] = vec4(mat3(to_world.world_from_object) * vec3(t), to_world.is_mirrored ? -t.w : t.w);
    }
  });
  return result;
}

std::unique_ptr<MeshData> make_mesh(const Primitive& flat, const MaterialData& material, const Placement* to_world) {
  auto mesh = std::make_unique<MeshData>();
  const TextureReader& height = material.texture<&Material::height_texture>();
  if (height) mesh->own = displaced(flat, material.factors, height);
  const Primitive& primitive = height ? mesh->own : flat;
  mesh->divisions = divisions_of(flat.triangles.size(), primitive.triangles.size());
  mesh->material = &material;
  mesh->is_mirrored = to_world != nullptr && to_world->is_mirrored;
  mesh->triangles = primitive.triangles;
  mesh->uv1 = primitive.uvs[1];
  for (const auto& [set, uvs] : primitive.uvs) {
    if (set > 1 && !uvs.empty()) mesh->more_uvs.emplace_back(static_cast<int>(set), uvs);
  }
  mesh->colors = primitive.colors;
  resize_large(mesh->vertices, primitive.positions.size());
  fill_vertices(primitive, to_world, mesh->vertices);
  if (!material.needs_tangents) return mesh;
  const bool is_turned = to_world != nullptr && mat3(to_world->world_from_object) != mat3(1.0f);
  if (is_turned) mesh->own_tangents = turned(primitive.tangents, *to_world);
  mesh->tangents = is_turned ? mesh->own_tangents : primitive.tangents;
  return mesh;
}

/// Multiplies the opacity of a mesh.
void fade(MeshData& mesh, float opacity) {
  if (opacity == 1.0f) return;
  mesh.own_colors.assign(mesh.colors.begin(), mesh.colors.end());
  if (mesh.own_colors.empty()) mesh.own_colors.assign(mesh.vertices.size(), vec4(1.0f));
  for (vec4& color : mesh.own_colors) color.w *= opacity;
  mesh.colors = mesh.own_colors;
}

Placement make_placement(const Node& node, int index, vec3 origin) {
  Placement placement;
  placement.world_from_object = node.world_from_node;
  placement.world_from_object[3] -= vec4(origin, 0.0f);
  const mat3 linear(node.world_from_node);
  const float determinant = glm::determinant(linear);
  // The cofactor matrix is the inverse transpose up to scale, and exists for flattening matrices too.
  const mat3 cofactor(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                      glm::cross(linear[0], linear[1]));
  placement.world_from_normal = determinant < 0.0f ? -cofactor : cofactor;
  placement.is_mirrored = determinant < 0.0f;
  placement.node = index;
  placement.color = vec3(node.color);
  return placement;
}

Box3 moved(const Box3& box, vec3 offset) { return {box.lower + offset, box.upper + offset}; }

/// Whether rays can be taken into the object's space. Embree needs coordinates below 1.8e18 there.
bool can_instance(const mat4& world_from_object) {
  constexpr float kLargest = 1e12f;
  const mat4 inverse = glm::inverse(world_from_object);
  for (int c = 0; c < 4; ++c) {
    for (int r = 0; r < 4; ++r) {
      if (!(std::abs(inverse[c][r]) < kLargest)) return false;
    }
  }
  return true;
}

}  // namespace

namespace {

/// The material's factors and the bits of what it uses.
Medium make_medium(const Material& m) {
  Medium medium;
  medium.ior = std::max(m.ior, 1.0f);
  medium.dispersion = m.dispersion;
  medium.extinction = volume_extinction(m);
  medium.anisotropy = glm::clamp(m.scatter_anisotropy, -0.99f, 0.99f);
  if (max_component(m.multiscatter_color) > 0.0f) {
    medium.albedo = single_scatter_albedo(m.multiscatter_color, medium.anisotropy);
  }
  medium.absorbs = max_component(medium.extinction) > 0.0f;
  medium.scatters = medium.absorbs && max_component(medium.albedo) > 0.0f;
  return medium;
}

}  // namespace

MaterialData::MaterialData(const Scene& scene, const Material& material, const shade::ShadingModel& model)
    : factors(material),
      params(surface_params(material, model)),
      textures(texture_readers(scene, material)),
      medium(make_medium(material)) {
  needs_opacity = material.alpha_mode != AlphaMode::opaque;
  is_emissive = max_component(material.emission) > 0.0f && !material.unlit;
  const bool lets_through = (params.lobes & (shade::kLobeTransmission | shade::kLobeDiffuseTransmission)) != 0;
  has_medium = lets_through && material.has_volume() && !material.unlit;
  const bool has_roughness = bool(texture<&Material::metallic_roughness_texture>());
  const bool may_be_smooth = has_roughness || texture<&Material::specular_glossiness_texture>() ||
                             shade::roughness_to_alpha(material.roughness) < shade::kGgxMirrorAlpha;
  is_clear_sheet = (params.lobes & shade::kLobeTransmission) != 0 && !material.has_volume() && !material.unlit &&
                   may_be_smooth && material.metallic < 1.0f + (has_roughness ? 1.0f : 0.0f);
  needs_tangents = texture<&Material::normal_texture>() || texture<&Material::clearcoat_normal_texture>() ||
                   (params.lobes & kLobesWithDirection) != 0;
  const auto has_texture = [this](std::size_t slot) { return bool(textures[slot]); };
  const auto* const first = std::find_if(kBaseTextures.begin(), kBaseTextures.end(), has_texture);
  has_one_footprint = first != kBaseTextures.end() && std::all_of(first, kBaseTextures.end(), [&](std::size_t slot) {
                        return !has_texture(slot) || textures[slot].is_addressed_like(textures[*first]);
                      });
}

vec2 MeshData::uv(const uvec3& t, vec3 b, int set) const {
  const auto mean = [&](std::span<const vec2> uvs) { return uvs[t.x] * b.x + uvs[t.y] * b.y + uvs[t.z] * b.z; };
  if (set == 1 && !uv1.empty()) return mean(uv1);
  if (set > 1) {
    for (const auto& [number, uvs] : more_uvs) {
      if (number == set) return mean(uvs);
    }
  }
  return vertices[t.x].uv0 * b.x + vertices[t.y].uv0 * b.y + vertices[t.z].uv0 * b.z;
}

vec4 MeshData::color(const uvec3& t, vec3 b) const {
  return colors.empty() ? vec4(1.0f) : colors[t.x] * b.x + colors[t.y] * b.y + colors[t.z] * b.z;
}

float MeshData::opacity(const uvec3& t, vec3 b) const {
  const Material& m = material->factors;
  if (m.alpha_mode == AlphaMode::opaque) return 1.0f;
  float alpha = m.opacity * color(t, b).w;
  const TextureReader& texture = material->texture<&Material::base_color_texture>();
  if (texture) alpha *= texture.sample(uv(t, b, texture.uv_set())).w;
  return m.alpha_mode == AlphaMode::mask ? (alpha >= drawn_cutoff(m.alpha_cutoff) ? 1.0f : 0.0f)
                                         : glm::clamp(alpha, 0.0f, 1.0f);
}

struct Geometry::Impl {
  DeviceHandle device;
  SceneHandle scene;
  std::vector<SceneHandle> shared;         ///< one per mesh that several nodes use
  std::vector<int> placement_of_geometry;  ///< by geometry id of the top level: its (first) placement
  bool is_empty = true;

  int placement(unsigned instance, unsigned geometry) const {
    if (instance == RTC_INVALID_GEOMETRY_ID) return placement_of_geometry[geometry];
    return placement_of_geometry[instance] + static_cast<int>(geometry);
  }

  void check(const char* what) const {
    if (rtcGetDeviceError(device.get()) != RTC_ERROR_NONE) {
      throw Error(std::string("not enough memory, or an internal failure, while ") + what);
    }
  }

  void attach(RTCScene target, GeometryHandle geometry, unsigned id) {
    rtcAttachGeometryByID(target, geometry.get(), id);
  }
};

Geometry::Geometry(const Scene& scene, const shade::ShadingModel& model, vec3 origin)
    : impl_(std::make_unique<Impl>()), origin_(origin) {
  impl_->device.reset(rtcNewDevice(nullptr));
  if (!impl_->device) throw Error("cannot start Embree");
  impl_->scene.reset(rtcNewScene(impl_->device.get()));
  rtcSetSceneBuildQuality(impl_->scene.get(), RTC_BUILD_QUALITY_MEDIUM);
  rtcSetSceneFlags(impl_->scene.get(), kFilterByQuery);

  for (const Material& material : scene.materials) materials_.emplace_back(scene, material, model);
  find_kinds();

  // Colours differ from node to node; opacity, which rays ask for without knowing the node, is the mesh's.
  const auto key_of = [](const Node& node) { return std::pair(node.mesh, node.color.w); };
  std::map<std::pair<int, float>, int> uses;
  for (const Node& node : scene.nodes) {
    if (node.mesh >= 0) ++uses[key_of(node)];
  }

  struct Shared {
    SceneHandle scene;
    std::vector<std::pair<const MeshData*, int>> meshes;  ///< and which primitive each is
  };
  std::map<std::pair<int, float>, Shared> shared;
  unsigned next_geometry = 0;

  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    const Node& node = scene.nodes[i];
    if (node.mesh < 0) continue;
    const Mesh& mesh = scene.meshes[static_cast<std::size_t>(node.mesh)];
    Placement placement = make_placement(node, static_cast<int>(i), origin_);

    // ----- placed once, or flattened: straight into the top level, in world space
    if (uses[key_of(node)] == 1 || !can_instance(placement.world_from_object)) {
      for (std::size_t k = 0; k < mesh.primitives.size(); ++k) {
        const Primitive& primitive = mesh.primitives[k];
        if (primitive.triangles.empty()) continue;
        meshes_.push_back(make_mesh(primitive, materials_[static_cast<std::size_t>(primitive.material)], &placement));
        fade(*meshes_.back(), node.color.w);
        Placement in_world = placement;
        in_world.mesh = meshes_.back().get();
        in_world.primitive = static_cast<int>(k);
        in_world.is_world = true;
        impl_->placement_of_geometry.push_back(static_cast<int>(placements_.size()));
        placements_.push_back(in_world);
        triangle_count_ += meshes_.back()->triangles.size();
        impl_->attach(impl_->scene.get(), make_triangles(impl_->device.get(), *meshes_.back()), next_geometry++);
      }
      continue;
    }

    // ----- placed often: a tree of its own, instanced
    Shared& tree = shared[key_of(node)];
    if (!tree.scene) {
      tree.scene.reset(rtcNewScene(impl_->device.get()));
      rtcSetSceneFlags(tree.scene.get(), kFilterByQuery);
      for (std::size_t k = 0; k < mesh.primitives.size(); ++k) {
        const Primitive& primitive = mesh.primitives[k];
        if (primitive.triangles.empty()) continue;
        meshes_.push_back(make_mesh(primitive, materials_[static_cast<std::size_t>(primitive.material)], nullptr));
        fade(*meshes_.back(), node.color.w);
        impl_->attach(tree.scene.get(), make_triangles(impl_->device.get(), *meshes_.back()),
                      static_cast<unsigned>(tree.meshes.size()));
        tree.meshes.emplace_back(meshes_.back().get(), static_cast<int>(k));
        triangle_count_ += meshes_.back()->triangles.size();
      }
      rtcCommitScene(tree.scene.get());
    }
    if (tree.meshes.empty()) continue;
    GeometryHandle instance(rtcNewGeometry(impl_->device.get(), RTC_GEOMETRY_TYPE_INSTANCE));
    rtcSetGeometryInstancedScene(instance.get(), tree.scene.get());
    rtcSetGeometryTransform(instance.get(), 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &placement.world_from_object[0][0]);
    rtcCommitGeometry(instance.get());
    impl_->placement_of_geometry.push_back(static_cast<int>(placements_.size()));
    impl_->attach(impl_->scene.get(), std::move(instance), next_geometry++);
    ++instance_count_;
    for (const auto& [data, primitive] : tree.meshes) {
      placement.mesh = data;
      placement.primitive = primitive;
      placements_.push_back(placement);
    }
  }
  for (auto& [index, tree] : shared) impl_->shared.push_back(std::move(tree.scene));

  bodies_ = find_bodies(placements_);
  if (scene.ground) add_ground(scene, model, next_geometry++);
  rtcCommitScene(impl_->scene.get());
  impl_->check("building the acceleration structure");
  impl_->is_empty = next_geometry == 0;
  if (!impl_->is_empty) {
    RTCBounds b;
    rtcGetSceneBounds(impl_->scene.get(), &b);
    bounds_ = {{b.lower_x, b.lower_y, b.lower_z}, {b.upper_x, b.upper_y, b.upper_z}};
    if (scene.ground) bounds_ = moved(world_bounds(scene), -origin_);
    find_shared_planes();
  }
}

void Geometry::find_kinds() {
  has_media_ = has_blends_ = false;
  for (const MaterialData& material : materials_) {
    has_media_ = has_media_ || material.has_medium;
    has_blends_ = has_blends_ || material.factors.alpha_mode == AlphaMode::blend;
  }
}

namespace {

/// Whether what is built of meshes of one material serves those of the other.
bool are_built_alike(const MaterialData& a, const MaterialData& b) {
  return a.needs_opacity == b.needs_opacity && a.is_clear_sheet == b.is_clear_sheet && a.has_medium == b.has_medium &&
         a.needs_tangents == b.needs_tangents && !a.texture<&Material::height_texture>() &&
         !b.texture<&Material::height_texture>();
}

}  // namespace

bool Geometry::set_materials(const Scene& scene, const shade::ShadingModel& model) {
  const std::size_t count = materials_.size() - (ground_ ? 1 : 0);
  if (scene.materials.size() < count || (ground_ && scene.materials.size() > count)) return false;
  std::vector<MaterialData> made;
  for (const Material& material : scene.materials) made.emplace_back(scene, material, model);
  bool has_same_sides = true;
  for (std::size_t i = 0; i < count; ++i) {
    if (!(scene.materials[i] == materials_[i].factors) && !are_built_alike(made[i], materials_[i])) return false;
    has_same_sides = has_same_sides && scene.materials[i].double_sided == materials_[i].factors.double_sided;
  }
  for (std::size_t i = count; i < made.size(); ++i) materials_.push_back(made[i]);
  std::copy_n(made.begin(), count, materials_.begin());
  find_kinds();
  if (!has_same_sides) find_shared_planes();
  for (Placement& placement : placements_) placement.first_light = -1;
  return true;
}

void Geometry::add_ground(const Scene& scene, const shade::ShadingModel& model, unsigned id) {
  ground_ = scene.ground;
  materials_.emplace_back(scene, ground_material(*scene.ground), model);
  Ground here = *scene.ground;
  here.height -= origin_.y;
  Primitive plane = ground_primitive(here, moved(world_bounds(scene), -origin_));
  meshes_.push_back(make_mesh(plane, materials_.back(), nullptr));
  MeshData& mesh = *meshes_.back();
  mesh.own = std::move(plane);
  mesh.triangles = mesh.own.triangles;
  Placement placement;
  placement.mesh = &mesh;
  placement.is_world = true;
  placement.is_ground = true;
  impl_->placement_of_geometry.push_back(static_cast<int>(placements_.size()));
  placements_.push_back(placement);
  triangle_count_ += mesh.triangles.size();
  impl_->attach(impl_->scene.get(), make_triangles(impl_->device.get(), mesh), id);
}

Geometry::~Geometry() = default;

/// One ray, and the filter that it brings.
struct Geometry::Query {
  QueryContext context;
  RTCFilterFunctionN filter = nullptr;
  std::uint32_t seed = 0;

  Query(const Geometry& geometry, vec3 direction, RTCFilterFunctionN own_filter) : filter(own_filter) {
    init_context(context.base);
    context.geometry = &geometry;
    context.direction = direction;
  }
};

Hit Geometry::intersect(const Ray& ray, std::uint32_t seed) const {
  Query query(*this, ray.direction, nullptr);
  query.seed = seed;
  query.context.seeds = &query.seed;
  return intersect(ray, query);
}

Hit Geometry::intersect_visible(const Ray& ray, std::uint32_t seed) const {
  Query query(*this, ray.direction, filter_visible);
  query.seed = seed;
  query.context.seeds = &query.seed;
  return intersect(ray, query);
}

Hit Geometry::first_surface(const Ray& ray) const {
  Query query(*this, ray.direction, filter_visible);
  return intersect(ray, query);
}

Hit Geometry::intersect_beyond(const Ray& ray, std::uint32_t seed, std::span<const Hit> passed) const {
  Query query(*this, ray.direction, filter_passed);
  query.seed = seed;
  query.context.seeds = &query.seed;
  query.context.passed = passed;
  return intersect(ray, query);
}

Hit Geometry::intersect(const Ray& ray, Query& with) const {
  RTCRayHit query;
  query.ray = embree_ray(ray);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  intersect_1(impl_->scene.get(), with.context.base, query, with.filter);

  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  Hit found = hit(query.hit.instID[0], query.hit.geomID, query.hit.primID, query.hit.u, query.hit.v);
  found.t = query.ray.tfar;
  found.seed = with.seed;
  return in_front(found, ray, with);
}

Hit Geometry::in_front(const Hit& met, const Ray& ray, Query& with) const {
  const Placement& placement = placements_[static_cast<std::size_t>(met.placement)];
  if (!placement.shares_plane) return met;
  constexpr float kGrazing = 0.125f;
  constexpr float kRounding = 0x1p-20f;  // of a distance
  const TrianglePositions p = triangle_positions(placement, met.triangle);
  const vec3 n = facet_normal(p);
  if (!(glm::dot(n, n) > 0.0f)) return met;
  const float reach =
      surface_clearance(placement, p, n) / std::max(std::abs(glm::dot(n, ray.direction)), kGrazing) + kRounding * met.t;
  const Ray window{ray.origin, ray.direction, std::max(ray.t_min, met.t - reach), std::min(ray.t_max, met.t + reach)};
  Hit front = met;
  with.context.filter = with.filter;
  with.context.met = &met;
  with.context.front = &front;
  RTCRayHit query;
  query.ray = embree_ray(window);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  intersect_1(impl_->scene.get(), with.context.base, query, filter_in_front);
  front.seed = met.seed;
  return front;
}

std::vector<Hit> Geometry::in_plane_with(const Hit& hit, vec3 n) const {
  const Placement& placement = placements_[static_cast<std::size_t>(hit.placement)];
  const TrianglePositions p = triangle_positions(placement, hit.triangle);
  const float clearance = surface_clearance(placement, p, n);
  Query with(*this, -n, filter_everything);
  std::vector<Hit> found = collect({p.at(hit.u, hit.v) + clearance * n, -n, 0.0f, 2.0f * clearance}, with);
  std::erase_if(found, [&](const Hit& other) {
    const bool is_own = other.placement == hit.placement && other.triangle == hit.triangle;
    return is_own || are_of_bodies(*this, hit, other) || !are_in_one_plane(*this, hit, other);
  });
  return found;
}

vec3 Geometry::transmittance_over(const Hit& hit, vec3 n, vec3 direction) const {
  vec3 result(1.0f);
  if (!placement(hit.placement).shares_plane) return result;
  for (const Hit& other : in_plane_with(hit, n)) {
    if (rank_in_plane(*this, hit, -n) < rank_in_plane(*this, other, -n)) result *= transmittance(other, direction);
  }
  return result;
}

namespace {

/// Points of a triangle that show whether another one in its plane overlaps it: the middle, and of few triangles near
/// their edges and corners too, where what crosses them would be.
constexpr std::array<vec2, 7> kProbes = {vec2(1.0f / 3.0f), {0.49f, 0.49f}, {0.02f, 0.49f}, {0.49f, 0.02f},
                                         vec2(0.02f),       {0.96f, 0.02f}, {0.02f, 0.96f}};
constexpr std::size_t kFewTriangles = 256;
constexpr std::size_t kMostProbes = 1 << 19;  // of all placements
constexpr std::size_t kMostOfPlacement = 1 << 15;
constexpr std::size_t kLeastOfPlacement = 16;

}  // namespace

void Geometry::find_shared_planes() {
  const std::size_t count = placements_.size();
  if (count == 0) return;
  const std::size_t most = std::clamp(kMostProbes / count, kLeastOfPlacement, kMostOfPlacement);
  const auto is_two_sided = [this](const Hit& hit) {
    const MaterialData& material = *placement(hit.placement).mesh->material;
    return material.factors.double_sided || material.has_medium;
  };
  std::vector<std::atomic<bool>> shares(count);
  const auto probe = [&](Hit own) {
    const TrianglePositions p = triangle_positions(placement(own.placement), own.triangle);
    const vec3 n = facet_normal(p);
    if (!(glm::dot(n, n) > 0.0f)) return;
    for (const Hit& hit : in_plane_with(own, n)) {
      // Of a box on a floor, which stand back to back, no ray meets both.
      const bool is_back_to_back = is_back_hit(*this, hit, -n) != is_back_hit(*this, own, -n);
      if (is_back_to_back && !is_two_sided(hit) && !is_two_sided(own)) continue;
      shares[static_cast<std::size_t>(own.placement)] = true;
      shares[static_cast<std::size_t>(hit.placement)] = true;
    }
  };
  parallel_for(0, count, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t triangles = placements_[i].mesh->triangles.size();
      const std::size_t points = triangles <= kFewTriangles ? kProbes.size() : 1;
      const std::size_t stride = std::max<std::size_t>(triangles * points / most, 1);
      Hit own;
      own.placement = static_cast<int>(i);
      for (std::size_t k = 0; k < triangles * points; k += stride) {
        own.triangle = static_cast<std::uint32_t>(k / points);
        own.u = kProbes[k % points].x;
        own.v = kProbes[k % points].y;
        probe(own);
      }
    }
  });
  for (std::size_t i = 0; i < count; ++i) placements_[i].shares_plane = shares[i];
}

Hit Geometry::hit(unsigned instance, unsigned geometry, unsigned triangle, float u, float v) const {
  Hit result;
  result.placement = impl_->placement(instance, geometry);
  result.triangle = triangle;
  result.u = u;
  result.v = v;
  return result;
}

void Geometry::intersect(const RayPacket& packet, Hit (&hits)[RayPacket::kSize]) const {
  QueryContext context;
  init_context(context.base);
  context.seeds = packet.seeds;
  RTCRayHit16 query;
  alignas(64) int valid[RayPacket::kSize];
  // Without AVX-512 Embree looks at the numbers of inactive lanes too, so they must be a ray, though an empty one.
  Ray nowhere;
  nowhere.origin = vec3(0.0f);
  nowhere.direction = vec3(0.0f, 0.0f, 1.0f);
  nowhere.t_max = -kInfinity;
  for (int i = 0; i < RayPacket::kSize; ++i) {
    const Ray& ray = packet.active[i] ? packet.rays[i] : nowhere;
    valid[i] = packet.active[i] ? -1 : 0;
    query.ray.org_x[i] = ray.origin.x;
    query.ray.org_y[i] = ray.origin.y;
    query.ray.org_z[i] = ray.origin.z;
    query.ray.dir_x[i] = ray.direction.x;
    query.ray.dir_y[i] = ray.direction.y;
    query.ray.dir_z[i] = ray.direction.z;
    query.ray.tnear[i] = ray.t_min;
    query.ray.tfar[i] = ray.t_max;
    query.ray.time[i] = 0.0f;
    query.ray.mask[i] = ~0U;
    query.ray.id[i] = static_cast<unsigned>(i);
    query.ray.flags[i] = 0;
    query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
  intersect_16(valid, impl_->scene.get(), context.base, query);
  for (int i = 0; i < RayPacket::kSize; ++i) {
    hits[i] = {};
    if (valid[i] == 0 || query.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
    hits[i] = hit(query.hit.instID[0][i], query.hit.geomID[i], query.hit.primID[i], query.hit.u[i], query.hit.v[i]);
    hits[i].t = query.ray.tfar[i];
    hits[i].seed = packet.seeds[i];
    if (!placement(hits[i].placement).shares_plane) continue;
    Query with(*this, packet.rays[i].direction, nullptr);
    with.context.seeds = &packet.seeds[i];
    hits[i] = in_front(hits[i], packet.rays[i], with);
  }
}

vec3 Geometry::transmittance(const Ray& ray) const {
  Query with(*this, ray.direction, nullptr);
  RTCRay query = embree_ray(ray);
  occluded_1(impl_->scene.get(), with.context.base, query);
  return query.tfar < 0.0f ? vec3(0.0f) : with.context.transmittance;
}

vec3 Geometry::transmittance(const Hit& hit, vec3 direction) const {
  const MeshData& mesh = *placement(hit.placement).mesh;
  const float opacity = mesh.opacity(mesh.triangles[hit.triangle], {1.0f - hit.u - hit.v, hit.u, hit.v});
  vec3 passing(1.0f - opacity);
  if (opacity > 0.0f && mesh.material->is_clear_sheet) {
    const SurfacePoint point = make_surface_point(*this, hit, direction);
    if (!point.is_unlit) passing += opacity * shade::surface_straight(point.surface, point.wo);
  }
  return passing;
}

std::vector<Hit> Geometry::collect(const Ray& ray, Query& with) const {
  std::vector<Hit> found;
  with.context.collected = &found;
  RTCRay query = embree_ray(ray);
  occluded_1(impl_->scene.get(), with.context.base, query, with.filter);
  return found;
}

std::vector<Hit> Geometry::find_boundaries(const Ray& ray) const {
  Query with(*this, ray.direction, filter_boundaries);
  return collect(ray, with);
}

std::vector<Hit> Geometry::all_surfaces(const Ray& ray) const {
  Query with(*this, ray.direction, filter_surfaces);
  return collect(ray, with);
}

TrianglePositions triangle_positions(const Placement& placement, std::uint32_t triangle) {
  const MeshData& mesh = *placement.mesh;
  const uvec3 t = mesh.triangles[triangle];
  TrianglePositions p{mesh.vertices[t.x].position, mesh.vertices[t.y].position, mesh.vertices[t.z].position};
  if (!placement.is_world) {
    p.p0 = transform_point(placement.world_from_object, p.p0);
    p.p1 = transform_point(placement.world_from_object, p.p1);
    p.p2 = transform_point(placement.world_from_object, p.p2);
  }
  return p;
}

}  // namespace candela::path
