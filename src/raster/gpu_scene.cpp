#include "raster/gpu_scene.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>
#include <span>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "raster/material_block.h"
#include "raster/mips.h"
#include "scene/surface_params.h"
#include "shade/color.glsl.h"

namespace candela::raster {

namespace {

// GL_EXT_texture_filter_anisotropic, which OpenGL ES 3.0 has no names for.
constexpr GLenum kTextureAnisotropy = 0x84FE;
constexpr GLenum kMostAnisotropy = 0x84FF;

/// How the floats of a vertex lie in a buffer; attributes that a primitive has not take no room.
struct VertexLayout {
  static constexpr std::size_t kNormal = 3, kUv = 6;
  std::size_t tangent = 10, color = 10, floats = 10;
  bool has_tangents, has_colors;

  explicit VertexLayout(const Primitive& p) : has_tangents(!p.tangents.empty()), has_colors(!p.colors.empty()) {
    if (has_tangents) color = floats += 4;
    if (has_colors) floats += 4;
  }
};

/// Of `size` floats from float `first` of each vertex on.
void attribute(GLuint location, GLint size, std::size_t first, std::size_t floats) {
  glEnableVertexAttribArray(location);
  const auto stride = static_cast<GLsizei>(floats * sizeof(float));
  // NOLINTNEXTLINE(performance-no-int-to-ptr): so GL takes an offset
  const auto* offset = reinterpret_cast<const void*>(first * sizeof(float));
  glVertexAttribPointer(location, size, GL_FLOAT, GL_FALSE, stride, offset);
}

template <class V>
void put(float* out, const V& value) {
  std::memcpy(out, &value[0], sizeof value);
}

std::vector<float> interleave(const Primitive& p, vec3 middle, const VertexLayout& layout) {
  std::vector<float> vertices(p.positions.size() * layout.floats);
  parallel_for(0, p.positions.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      float* v = vertices.data() + i * layout.floats;
      put(v, p.positions[i] - middle);
      put(v + VertexLayout::kNormal, p.normals[i]);
      const vec2 uv0 = p.uvs[0].empty() ? vec2(0.0f) : p.uvs[0][i];
      // Without a second set the first serves, as in the path tracer.
      put(v + VertexLayout::kUv, vec4(uv0, p.uvs[1].empty() ? uv0 : p.uvs[1][i]));
      if (layout.has_tangents) put(v + layout.tangent, p.tangents[i]);
      if (layout.has_colors) put(v + layout.color, p.colors[i]);
    }
  });
  return vertices;
}

// Of sixteen vertex attributes nine are taken; each of the rest holds two sets.
constexpr std::size_t kMostMoreSets = 14;

/// The uv sets that a material reads besides 0 and 1, ascending.
std::vector<int> more_sets_of(const Material& m) {
  std::set<int> sets;
  for (const TextureSlot* slot : texture_slots(m)) {
    if (*slot && slot->uv_set > 1) sets.insert(slot->uv_set);
  }
  return {sets.begin(), sets.end()};
}

/// Pairs of further sets, vertex by vertex.
std::vector<vec4> interleave_more(const Primitive& p, std::span<const int> sets) {
  const std::size_t pairs = (sets.size() + 1) / 2;
  std::vector<vec4> result(p.positions.size() * pairs, vec4(0.0f));
  for (std::size_t k = 0; k < sets.size(); ++k) {
    const std::vector<vec2>& own = std::as_const(p).uvs[static_cast<std::size_t>(sets[k])];
    const std::vector<vec2>& uvs = own.empty() ? std::as_const(p).uvs[0] : own;
    const int half = 2 * static_cast<int>(k % 2);
    for (std::size_t i = 0; i < uvs.size(); ++i) {
      vec4& v = result[i * pairs + k / 2];
      v[half] = uvs[i].x, v[half + 1] = uvs[i].y;
    }
  }
  return result;
}

template <class V>
std::vector<V> of_corners(const std::vector<V>& values, const std::vector<uvec3>& triangles) {
  std::vector<V> result;
  if (values.empty()) return result;
  result.reserve(3 * triangles.size());
  for (const uvec3& t : triangles) result.insert(result.end(), {values[t.x], values[t.y], values[t.z]});
  return result;
}

/// With vertices of its own for each triangle.
Primitive unshared(const Primitive& p) {
  Primitive result;
  result.positions = of_corners(p.positions, p.triangles);
  result.normals = of_corners(p.normals, p.triangles);
  result.tangents = of_corners(p.tangents, p.triangles);
  for (const auto& [set, uvs] : p.uvs) result.uvs[set] = of_corners(uvs, p.triangles);
  result.colors = of_corners(p.colors, p.triangles);
  result.material = p.material;
  for (unsigned i = 0; i < p.triangles.size(); ++i) result.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  return result;
}

bool is_plain(const TextureSlot& slot) {
  return !slot || (slot.uv_set == 0 && slot.transform == TextureSlot{}.transform);
}

/// Heights are read many times, and the search wants them where they are asked for.
Reading reading_of(const Texture& texture, std::size_t slot) {
  if (texture.filter == Filter::nearest) return Reading::nearest;
  return slot == height_slot ? Reading::isotropic : Reading::anisotropic;
}

GLint wrap_of(Wrap wrap) {
  switch (wrap) {
    case Wrap::repeat:
      return GL_REPEAT;
    case Wrap::clamp_to_edge:
      return GL_CLAMP_TO_EDGE;
    case Wrap::mirrored_repeat:
      return GL_MIRRORED_REPEAT;
  }
  return GL_REPEAT;
}

/// The largest side that the driver takes.
int most_texels() {
  GLint most = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
  return most;
}

/// Uploads 8-bit texels with their mips; those larger than the driver's limit are left out. Returns how many.
int upload_bytes(const std::uint8_t* pixels, int width, int height, bool is_srgb) {
  const int most = most_texels();
  MipLevel level{width, height, {}};
  int left_out = 0;
  for (GLint at = 0;;) {
    if (level.width > most || level.height > most) {
      ++left_out;
    } else {
      glTexImage2D(GL_TEXTURE_2D, at++, is_srgb ? GL_SRGB8_ALPHA8 : GL_RGBA8, level.width, level.height, 0, GL_RGBA,
                   GL_UNSIGNED_BYTE, pixels);
    }
    if (level.width == 1 && level.height == 1) return left_out;
    level = halved(pixels, level.width, level.height, is_srgb);
    pixels = level.rgba.data();
  }
}

/// The mean of every 2 × 2 texels of RGBA floats; a last odd one stands alone.
std::vector<float> halved_floats(const std::vector<float>& texels, int& width, int& height) {
  const int w = (width + 1) / 2, h = (height + 1) / 2;
  std::vector<float> result(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * 4, 0.0f);
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      for (int k = 0; k < 4; ++k) {
        const int sx = std::min(2 * x + k % 2, width - 1), sy = std::min(2 * y + k / 2, height - 1);
        const float* from = texels.data() + 4 * (static_cast<std::ptrdiff_t>(sy) * width + sx);
        float* to = result.data() + 4 * (static_cast<std::ptrdiff_t>(y) * w + x);
        for (int c = 0; c < 4; ++c) to[c] += 0.25f * from[c];
      }
    }
  }
  width = w, height = h;
  return result;
}

/// There are no 16-bit integers to filter: half floats, decoded here. Returns how often they were halved to fit.
int upload_words(const TextureImage& image, bool is_srgb) {
  const auto* pixels = reinterpret_cast<const std::uint16_t*>(image.pixels.data());
  std::vector<float> linear(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 4);
  for (std::size_t i = 0; i < linear.size(); ++i) {
    const float v = static_cast<float>(pixels[i]) / 65535.0f;
    const bool is_color = is_srgb && i % 4 != 3;
    linear[i] = is_color ? shade::srgb_decode_channel(v) : v;
  }
  int width = image.width, height = image.height, times = 0;
  for (; std::max(width, height) > most_texels(); ++times) linear = halved_floats(linear, width, height);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA16F, width, height, 0, GL_RGBA, GL_FLOAT, linear.data());
  glGenerateMipmap(GL_TEXTURE_2D);
  return times;
}

/// Drops the highest sets where a vertex has no room for them.
void limit_sets(GpuMaterial& gpu, Diagnostics& diagnostics) {
  if (gpu.more_sets.size() > kMostMoreSets) {
    diagnostics.warn(gpu.name + " reads more sets of texture coordinates than a vertex holds; textures of TEXCOORD_" +
                         std::to_string(gpu.more_sets[kMostMoreSets]) + " and beyond are left out",
                     gpu.name);
    gpu.more_sets.resize(kMostMoreSets);
  }
  gpu.key.more_uvs = static_cast<int>((gpu.more_sets.size() + 1) / 2);
}

MaterialKey make_key(const Material& m, const shade::ShadingModel& model) {
  MaterialKey key;
  key.lobes = surface_params(m, model).lobes;
  key.is_unlit = m.unlit;
  key.is_specular_glossiness = m.specular_glossiness;
  key.alpha_mode = m.alpha_mode;
  key.has_body = m.transmission > 0.0f && m.has_volume();
  key.is_scattering = is_scattering(m);
  key.is_emissive = max_component(m.emission) > 0.0f;
  const auto slots = texture_slots(m);
  key.is_plain_uv = std::all_of(slots.begin(), slots.end(), [](const TextureSlot* s) { return is_plain(*s); });
  return key;
}

}  // namespace

bool GpuMaterial::is_transmissive() const {
  return (key.lobes & shade::kLobeTransmission) != 0 && !key.is_unlit && !key.is_scattering;
}

GpuScene::GpuScene(const Scene& scene, const shade::ShadingModel& model, Diagnostics& diagnostics) : model_(model) {
  set_scene(scene, diagnostics);
}

void GpuScene::set_scene(const Scene& scene, Diagnostics& diagnostics) {
  set_materials(scene, diagnostics);
  set_meshes(scene);
  find_attributes();
  find_alpha_modes(scene);
  add_draws(scene);
  gl::check("uploading the scene");
}

/// Keeps those meshes whose primitives are the same as before.
void GpuScene::set_meshes(const Scene& scene) {
  std::vector<GpuPrimitive> before = std::move(primitives_);
  const std::vector<std::size_t> first_before = std::move(first_primitive_);
  const std::vector<std::shared_ptr<const void>> meshes_before = std::move(meshes_);
  std::map<std::size_t, GpuPrimitive> corners_before = std::move(corners_);
  primitives_.clear(), first_primitive_.clear(), meshes_.clear(), corners_.clear();
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    const bool is_known = mesh.identity != nullptr && m < meshes_before.size() && meshes_before[m] == mesh.identity;
    first_primitive_.push_back(primitives_.size());
    meshes_.push_back(mesh.identity);
    for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
      const auto corners = is_known ? corners_before.find(first_before[m] + p) : corners_before.end();
      if (corners != corners_before.end()) corners_.emplace(primitives_.size(), std::move(corners->second));
      primitives_.push_back(is_known ? std::move(before[first_before[m] + p]) : upload(mesh.primitives[p]));
    }
  }
  first_primitive_.push_back(primitives_.size());
}

GpuPrimitive GpuScene::upload(const Primitive& p, std::optional<vec3> middle) const {
  GpuPrimitive gpu;
  gpu.material = p.material;
  gpu.has_colors = !p.colors.empty();
  gpu.has_tangents = !p.tangents.empty();
  gpu.index_count = static_cast<GLsizei>(3 * p.triangles.size());
  for (const vec3& position : p.positions) gpu.bounds.extend(position);
  if (!gpu.bounds.empty()) gpu.middle = middle.value_or(0.5f * gpu.bounds.lower + 0.5f * gpu.bounds.upper);
  const VertexLayout layout(p);
  const std::vector<float> vertices = interleave(p, gpu.middle, layout);
  glBindVertexArray(gpu.attributes);
  glBindBuffer(GL_ARRAY_BUFFER, gpu.vertices);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(float)), vertices.data(),
               GL_STATIC_DRAW);
  attribute(0, 3, 0, layout.floats);
  attribute(1, 3, VertexLayout::kNormal, layout.floats);
  if (layout.has_tangents) attribute(2, 4, layout.tangent, layout.floats);
  attribute(3, 4, VertexLayout::kUv, layout.floats);
  if (layout.has_colors) attribute(4, 4, layout.color, layout.floats);
  const std::vector<int>& more_sets = materials_[static_cast<std::size_t>(p.material)].more_sets;
  if (!more_sets.empty()) {
    const std::vector<vec4> more = interleave_more(p, more_sets);
    const std::size_t pairs = (more_sets.size() + 1) / 2;
    glBindBuffer(GL_ARRAY_BUFFER, gpu.more_uvs);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(more.size() * sizeof(vec4)), more.data(), GL_STATIC_DRAW);
    for (std::size_t k = 0; k < pairs; ++k) {
      attribute(static_cast<GLuint>(9 + k), 4, 4 * k, 4 * pairs);
    }
  }
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, gpu.indices);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(p.triangles.size() * sizeof(uvec3)), p.triangles.data(),
               GL_STATIC_DRAW);
  glBindVertexArray(0);
  return gpu;
}

/// A material does not know its meshes: the attributes that one of them has are read for all (others hold what changes
/// nothing).
void GpuScene::find_attributes() {
  for (const GpuPrimitive& p : primitives_) {
    MaterialKey& key = materials_[static_cast<std::size_t>(p.material)].key;
    key.has_colors |= p.has_colors;
    key.has_tangents |= p.has_tangents;
  }
}

/// What the vertices of all its meshes, and the nodes that hold these, leave of a material's alpha decides how it is
/// drawn.
void GpuScene::find_alpha_modes(const Scene& scene) {
  constexpr AlphaRange kNone{kInfinity, 0.0f};
  std::vector<AlphaRange> nodes(scene.meshes.size(), kNone);
  for (const Node& node : scene.nodes) {
    if (node.mesh < 0) continue;
    AlphaRange& range = nodes[static_cast<std::size_t>(node.mesh)];
    range = {std::min(range.least, node.color.w), std::max(range.most, node.color.w)};
  }
  std::vector<AlphaRange> vertices(materials_.size(), kNone);
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    if (nodes[m].least == kInfinity) continue;
    for (const Primitive& p : scene.meshes[m].primitives) {
      const auto k = static_cast<std::size_t>(p.material);
      if (scene.materials[k].alpha_mode == AlphaMode::opaque) continue;
      const AlphaRange range = alpha_of_vertices(p) * nodes[m];
      vertices[k] = {std::min(vertices[k].least, range.least), std::max(vertices[k].most, range.most)};
    }
  }
  for (std::size_t k = 0; k < materials_.size(); ++k) {
    if (scene.materials[k].alpha_mode == AlphaMode::opaque || vertices[k].least == kInfinity) continue;
    const AlphaRange range = materials_[k].alpha * vertices[k];
    materials_[k].key.alpha_mode = drawn_mode(scene.materials[k], range);
    materials_[k].has_opaque_part = materials_[k].is_blended() && range.most >= kOpaqueAlpha;
  }
}

/// Textures stay where the scene has their images still, whatever number these have now.
void GpuScene::keep_textures(const Scene& scene) {
  std::map<const TextureImage*, int> number_of;
  for (std::size_t i = 0; i < scene.images.size(); ++i) number_of.emplace(scene.images[i].get(), static_cast<int>(i));
  const auto renumber = [&](int& image) {
    if (image < 0) return true;
    const auto found = number_of.find(images_[static_cast<std::size_t>(image)].get());
    if (found != number_of.end()) image = found->second;
    return found != number_of.end();
  };
  std::map<TextureSource, gl::Texture> kept;
  for (auto& [source, texture] : textures_) {
    TextureSource now = source;
    if (renumber(now.image) && renumber(now.red.image) && renumber(now.alpha.image)) {
      kept.emplace(now, std::move(texture));
    }
  }
  textures_ = std::move(kept);
  std::erase_if(alphas_, [&](const auto& entry) { return !number_of.contains(entry.first); });
  images_ = scene.images;
}

AlphaRange GpuScene::alpha_of(const Scene& scene, const Material& m) {
  AlphaRange range{m.opacity, m.opacity};
  if (const TextureSlot& slot = m.base_color_texture) {
    const int number = scene.textures[static_cast<std::size_t>(slot.texture)].image;
    const TextureImage* image = scene.images[static_cast<std::size_t>(number)].get();
    const auto [found, is_new] = alphas_.try_emplace(image);
    if (is_new) found->second = alpha_of_image(*image);
    range = range * found->second;
  }
  return range;
}

void GpuScene::set_materials(const Scene& scene, Diagnostics& diagnostics) {
  const bool has_same_images = scene.images == images_;
  if (has_same_images && scene.materials == uploaded_materials_ && scene.textures == uploaded_textures_) return;
  if (!has_same_images) keep_textures(scene);
  uploaded_materials_ = scene.materials;
  uploaded_textures_ = scene.textures;
  materials_.clear();
  GLint alignment = 256;
  glGetIntegerv(GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT, &alignment);
  const std::size_t stride = (material_block_size() + static_cast<std::size_t>(alignment) - 1) /
                             static_cast<std::size_t>(alignment) * static_cast<std::size_t>(alignment);
  std::vector<std::byte> blocks(stride * scene.materials.size());
  const std::vector<PackedMaterial> packed = pack_textures(scene);
  for (std::size_t k = 0; k < scene.materials.size(); ++k) {
    const Material& m = scene.materials[k];
    GpuMaterial& gpu = materials_.emplace_back();
    gpu.name = m.name.empty() ? "material " + std::to_string(number_of(scene.materials, k)) : m.name;
    gpu.key = make_key(m, model_);
    gpu.is_double_sided = m.double_sided;
    if (m.alpha_mode != AlphaMode::opaque) gpu.alpha = alpha_of(scene, m);
    gpu.block = static_cast<GLintptr>(stride * k);
    gpu.more_sets = more_sets_of(m);
    limit_sets(gpu, diagnostics);
    write_material_block(m, gpu.more_sets, blocks.data() + gpu.block);
    gpu.key.channels = packed[k].channels;
    for (std::size_t i = 0; i < kTextureSlots; ++i) {
      const TextureSource& source = packed[k].slots[i];
      const int set = texture_slots(m)[i]->uv_set;
      if (source.image < 0 || (set > 1 && !std::ranges::binary_search(gpu.more_sets, set))) continue;
      gpu.key.slots |= 1u << i;
      gpu.textures[i] = texture_for(scene, source, diagnostics);
      const Texture& texture = scene.textures[static_cast<std::size_t>(texture_slots(m)[i]->texture)];
      gpu.samplers[i] = sampler_for(texture, reading_of(texture, i));
    }
  }
  glBindBuffer(GL_UNIFORM_BUFFER, material_blocks_);
  glBufferData(GL_UNIFORM_BUFFER, static_cast<GLsizeiptr>(blocks.size()), blocks.data(), GL_STATIC_DRAW);
}

GLuint GpuScene::texture_for(const Scene& scene, const TextureSource& source, Diagnostics& diagnostics) {
  const auto [entry, is_new] = textures_.try_emplace(source);
  if (!is_new) return entry->second;
  const TextureImage& pixels = *scene.images[static_cast<std::size_t>(source.image)];
  glBindTexture(GL_TEXTURE_2D, entry->second);
  const std::string where = "image " + std::to_string(image_number(scene, static_cast<std::size_t>(source.image)));
  int left_out = 0;
  if (pixels.bits == 16) {
    left_out = upload_words(pixels, source.is_srgb);
  } else {
    const std::vector<std::uint8_t> packed =
        source.is_packed() ? packed_texels(scene, source) : std::vector<std::uint8_t>();
    left_out = upload_bytes(source.is_packed() ? packed.data() : pixels.pixels.data(), pixels.width, pixels.height,
                            source.is_srgb);
  }
  if (left_out > 0) {
    diagnostics.warn("a texture of " + std::to_string(pixels.width) + "x" + std::to_string(pixels.height) +
                         " is larger than the driver's limit and was halved " + std::to_string(left_out) + " times",
                     where);
  }
  gl::check("uploading " + where);
  return entry->second;
}

GLuint GpuScene::sampler_for(const Texture& texture, Reading reading) {
  const GLint u = wrap_of(texture.wrap_u), v = wrap_of(texture.wrap_v);
  const auto [entry, is_new] = samplers_.try_emplace({u, v, reading});
  if (is_new) {
    const GLuint sampler = entry->second;
    const bool is_nearest = reading == Reading::nearest;
    glSamplerParameteri(sampler, GL_TEXTURE_WRAP_S, u);
    glSamplerParameteri(sampler, GL_TEXTURE_WRAP_T, v);
    glSamplerParameteri(sampler, GL_TEXTURE_MAG_FILTER, is_nearest ? GL_NEAREST : GL_LINEAR);
    glSamplerParameteri(sampler, GL_TEXTURE_MIN_FILTER,
                        is_nearest ? GL_NEAREST_MIPMAP_LINEAR : GL_LINEAR_MIPMAP_LINEAR);
    if (reading == Reading::anisotropic && texture_anisotropy_ > 1) {
      glSamplerParameterf(sampler, kTextureAnisotropy, static_cast<GLfloat>(texture_anisotropy_));
    }
  }
  return entry->second;
}

void GpuScene::set_texture_anisotropy(int most) {
  GLfloat limit = 1.0f;
  if (gl::has_extension("GL_EXT_texture_filter_anisotropic")) glGetFloatv(kMostAnisotropy, &limit);
  const int allowed = std::clamp(most, 1, static_cast<int>(limit));
  if (allowed == texture_anisotropy_) return;
  texture_anisotropy_ = allowed;
  for (const auto& [parameters, sampler] : samplers_) {
    if (std::get<Reading>(parameters) != Reading::anisotropic) continue;
    glSamplerParameterf(sampler, kTextureAnisotropy, static_cast<GLfloat>(allowed));
  }
}

void GpuScene::add_draws(const Scene& scene) {
  draws_.clear();
  triangle_count_ = 0;
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    const Node& node = scene.nodes[n];
    if (node.mesh < 0) continue;
    const auto mesh = static_cast<std::size_t>(node.mesh);
    for (std::size_t p = first_primitive_[mesh]; p < first_primitive_[mesh + 1]; ++p) {
      if (primitives_[p].index_count == 0) continue;
      Draw draw;
      draw.primitive = static_cast<int>(p);
      draw.node = static_cast<int>(n);
      draw.number = number_of(scene.nodes, n);
      if (node.color != vec4(1.0f)) {
        materials_[static_cast<std::size_t>(primitives_[p].material)].key.has_colors = true;
      }
      draw.part = p - first_primitive_[mesh];
      draw.is_mirrored = glm::determinant(mat3(node.world_from_node)) < 0.0f;
      triangle_count_ += static_cast<std::uint64_t>(primitives_[p].index_count) / 3;
      draws_.push_back(draw);
    }
  }
  std::stable_sort(draws_.begin(), draws_.end(), [](const Draw& a, const Draw& b) {
    return std::pair(a.primitive, a.is_mirrored) < std::pair(b.primitive, b.is_mirrored);
  });
  place_draws(scene);
}

void GpuScene::set_origin(const Scene& scene, vec3 origin) {
  if (origin == origin_) return;
  origin_ = origin;
  place_draws(scene);
}

mat4 GpuScene::relative(const mat4& world_from_node) const {
  mat4 m = world_from_node;
  m[3] = vec4(vec3(glm::dvec3(m[3]) - glm::dvec3(origin_)), 1.0f);
  return m;
}

void GpuScene::place_draws(const Scene& scene) {
  bounds_ = {};
  std::vector<std::array<vec4, 4>> rows;
  rows.reserve(draws_.size());
  for (Draw& draw : draws_) {
    const GpuPrimitive& primitive = primitives_[static_cast<std::size_t>(draw.primitive)];
    const Node& node = scene.nodes[static_cast<std::size_t>(draw.node)];
    mat4 from_middle = node.world_from_node;
    const glm::dvec3 middle(glm::dmat4(from_middle) * glm::dvec4(primitive.middle, 1.0));
    from_middle[3] = vec4(vec3(middle - glm::dvec3(origin_)), 1.0f);
    const vec3 half = 0.5f * primitive.bounds.upper - 0.5f * primitive.bounds.lower;
    draw.bounds = {};
    for (int i = 0; i < 8; ++i) {
      const vec3 side((i & 1) != 0 ? 1.0f : -1.0f, (i & 2) != 0 ? 1.0f : -1.0f, (i & 4) != 0 ? 1.0f : -1.0f);
      draw.bounds.extend(transform_point(from_middle, half * side));
    }
    draw.center = draw.bounds.center();
    bounds_.extend(draw.bounds);
    const mat4 transposed = glm::transpose(from_middle);
    rows.push_back({transposed[0], transposed[1], transposed[2], node.color});
  }
  glBindBuffer(GL_ARRAY_BUFFER, transforms_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(rows.size() * sizeof(rows[0])), rows.data(), GL_STATIC_DRAW);
}

bool GpuScene::has_lobe(int lobe) const {
  return std::any_of(draws_.begin(), draws_.end(), [&](const Draw& d) {
    const MaterialKey& key = material_of(d).key;
    return (key.lobes & lobe) != 0 && !key.is_unlit;
  });
}

bool GpuScene::has_scattering() const {
  return std::any_of(draws_.begin(), draws_.end(), [&](const Draw& d) { return material_of(d).key.is_scattering; });
}

void GpuScene::bind_material(const GpuMaterial& material, const gl::Program& program) const {
  glBindBufferRange(GL_UNIFORM_BUFFER, material_binding, material_blocks_, material.block,
                    static_cast<GLsizeiptr>(material_block_size()));
  for (std::size_t i = 0; i < kTextureSlots; ++i) {
    if (material.textures[i] == 0) continue;
    program.bind(slot_sampler(i), GL_TEXTURE_2D, material.textures[i], material.samplers[i]);
  }
}

void GpuScene::bind_draw(const GpuPrimitive& primitive, std::size_t first) const {
  const Draw& d = draws_[first];
  glBindVertexArray(primitive.attributes);
  glBindBuffer(GL_ARRAY_BUFFER, transforms_);
  for (GLuint row = 0; row < 4; ++row) {
    attribute(5 + row, 4, 16 * first + std::size_t{4} * row, 16);
    glVertexAttribDivisor(5 + row, 1);
  }
  // Of vertices that have none; a draw call may leave them undefined.
  glVertexAttrib4f(2, 0.0f, 0.0f, 0.0f, 0.0f);
  glVertexAttrib4f(4, 1.0f, 1.0f, 1.0f, 1.0f);
  glFrontFace(d.is_mirrored ? GL_CW : GL_CCW);
}

void GpuScene::draw(std::size_t first, std::size_t count) const {
  const GpuPrimitive& primitive = primitives_[static_cast<std::size_t>(draws_[first].primitive)];
  bind_draw(primitive, first);
  glDrawElementsInstanced(GL_TRIANGLES, primitive.index_count, GL_UNSIGNED_INT, nullptr, static_cast<GLsizei>(count));
}

void GpuScene::draw_corners(const Scene& scene, std::size_t first, std::size_t count) {
  const Draw& d = draws_[first];
  const auto number = static_cast<std::size_t>(d.primitive);
  auto found = corners_.find(number);
  if (found == corners_.end()) {
    const int mesh = scene.nodes[static_cast<std::size_t>(d.node)].mesh;
    const Primitive& primitive = scene.meshes[static_cast<std::size_t>(mesh)].primitives[d.part];
    found = corners_.emplace(number, upload(unshared(primitive), primitives_[number].middle)).first;
  }
  bind_draw(found->second, first);
  glDrawElementsInstanced(GL_TRIANGLES, found->second.index_count, GL_UNSIGNED_INT, nullptr,
                          static_cast<GLsizei>(count));
}

void GpuScene::draw(std::size_t draw, const GpuTriangles& triangles) const {
  bind_draw(primitives_[static_cast<std::size_t>(draws_[draw].primitive)], draw);
  // The vertex array holds the primitive's own indices.
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, triangles.indices);
  glDrawElementsInstanced(GL_TRIANGLES, triangles.index_count, GL_UNSIGNED_INT, nullptr, 1);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, primitives_[static_cast<std::size_t>(draws_[draw].primitive)].indices);
}

}  // namespace candela::raster
