#include "unit/path/scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>

namespace candela::test {

// ----- shapes

Primitive quad(vec3 corner, vec3 a, vec3 b) {
  Primitive p;
  p.positions = {corner, corner + a, corner + a + b, corner + b};
  p.normals.assign(4, glm::normalize(glm::cross(a, b)));
  p.uvs[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  p.triangles = {{0, 1, 2}, {0, 2, 3}};
  return p;
}

Primitive plane(vec3 center, float half) {
  return quad(center + vec3(-half, 0, half), {2.0f * half, 0, 0}, {0, 0, -2.0f * half});
}

namespace {

void append(Primitive& target, const Primitive& part) {
  const auto first = static_cast<std::uint32_t>(target.positions.size());
  target.positions.insert(target.positions.end(), part.positions.begin(), part.positions.end());
  target.normals.insert(target.normals.end(), part.normals.begin(), part.normals.end());
  target.uvs[0].insert(target.uvs[0].end(), part.uvs[0].begin(), part.uvs[0].end());
  for (const uvec3& t : part.triangles) target.triangles.push_back(t + first);
}

struct Facet {
  vec3 a, b, c;
};

std::vector<Facet> octahedron(int levels) {
  std::vector<Facet> facets;
  for (const float x : {-1.0f, 1.0f}) {
    for (const float y : {-1.0f, 1.0f}) {
      for (const float z : {-1.0f, 1.0f}) {
        Facet f{{x, 0, 0}, {0, y, 0}, {0, 0, z}};
        if (x * y * z < 0.0f) std::swap(f.b, f.c);
        facets.push_back(f);
      }
    }
  }
  for (int i = 0; i < levels; ++i) {
    std::vector<Facet> finer;
    for (const Facet& f : facets) {
      const vec3 ab = glm::normalize(f.a + f.b), bc = glm::normalize(f.b + f.c), ca = glm::normalize(f.c + f.a);
      finer.insert(finer.end(), {{f.a, ab, ca}, {ab, f.b, bc}, {ca, bc, f.c}, {ab, bc, ca}});
    }
    facets = finer;
  }
  return facets;
}

}  // namespace

Primitive box(vec3 lower, vec3 upper) {
  const vec3 s = upper - lower;
  const vec3 x(s.x, 0, 0), y(0, s.y, 0), z(0, 0, s.z);
  Primitive p;
  append(p, quad(lower, z, y));      // -x
  append(p, quad(lower + x, y, z));  // +x
  append(p, quad(lower, x, z));      // -y
  append(p, quad(lower + y, z, x));  // +y
  append(p, quad(lower, y, x));      // -z
  append(p, quad(lower + z, x, y));  // +z
  return p;
}

Primitive sphere(vec3 center, float radius, int levels, bool flat) {
  Primitive p;
  for (const Facet& f : octahedron(levels)) {
    const auto first = static_cast<std::uint32_t>(p.positions.size());
    const vec3 normal = glm::normalize(glm::cross(f.b - f.a, f.c - f.a));
    for (const vec3 v : {f.a, f.b, f.c}) {
      p.positions.push_back(center + radius * v);
      p.normals.push_back(flat ? normal : v);
      p.uvs[0].emplace_back(0.5f + std::atan2(v.z, v.x) / (2.0f * kPi), std::acos(glm::clamp(v.y, -1.0f, 1.0f)) / kPi);
    }
    p.triangles.emplace_back(first, first + 1, first + 2);
  }
  return p;
}

Primitive turned_inside_out(Primitive primitive) {
  for (uvec3& t : primitive.triangles) std::swap(t.y, t.z);
  for (vec3& n : primitive.normals) n = -n;
  return primitive;
}

Primitive moved(Primitive primitive, vec3 offset) {
  for (vec3& p : primitive.positions) p += offset;
  return primitive;
}

// ----- materials

Material matte(vec3 albedo) {
  Material m;
  m.base_color = albedo;
  m.metallic = 0.0f;
  m.specular = 0.0f;
  return m;
}

Material metal(vec3 color, float roughness) {
  Material m;
  m.base_color = color;
  m.metallic = 1.0f;
  m.roughness = roughness;
  return m;
}

Material plastic(vec3 color, float roughness) {
  Material m;
  m.base_color = color;
  m.metallic = 0.0f;
  m.roughness = roughness;
  return m;
}

Material lamp(vec3 emission) {
  Material m = matte(vec3(0.0f));
  m.emission = emission;
  return m;
}

Material unlit(vec3 color) {
  Material m = matte(color);
  m.unlit = true;
  return m;
}

Light point_light(vec3 color, float intensity) {
  Light l;
  l.type = LightType::point;
  l.color = color;
  l.intensity = intensity;
  return l;
}

Light spot_light(vec3 color, float intensity, float inner_cone, float outer_cone) {
  Light l = point_light(color, intensity);
  l.type = LightType::spot;
  l.inner_cone = inner_cone;
  l.outer_cone = outer_cone;
  return l;
}

Light sunlight(vec3 color, float intensity) {
  Light l = point_light(color, intensity);
  l.type = LightType::directional;
  return l;
}

mat4 translation(vec3 offset) { return glm::translate(mat4(1.0f), offset); }
mat4 scaling(vec3 factors) { return glm::scale(mat4(1.0f), factors); }
mat4 rotation(vec3 axis, float angle) { return glm::rotate(mat4(1.0f), angle, glm::normalize(axis)); }
mat4 aimed(vec3 eye, vec3 target) { return look_at(eye, target, 1.0f).world_from_camera; }

// ----- scene

int SceneBuilder::add_material(const Material& material) {
  scene_.materials.push_back(material);
  return static_cast<int>(scene_.materials.size()) - 1;
}

int SceneBuilder::add_mesh(Primitive primitive, int material) {
  primitive.material = material;
  scene_.meshes.emplace_back();
  scene_.meshes.back().primitives.push_back(std::move(primitive));
  return static_cast<int>(scene_.meshes.size()) - 1;
}

int SceneBuilder::add_node(int mesh, const mat4& world) {
  Node node;
  node.mesh = mesh;
  node.parent_from_node = node.world_from_node = world;
  scene_.nodes.push_back(node);
  return static_cast<int>(scene_.nodes.size()) - 1;
}

int SceneBuilder::add(Primitive primitive, const Material& material, const mat4& world) {
  return add_node(add_mesh(std::move(primitive), add_material(material)), world);
}

int SceneBuilder::add_light(const Light& light, const mat4& world) {
  scene_.lights.push_back(light);
  const int node = add_node(-1, world);
  scene_.nodes.back().light = static_cast<int>(scene_.lights.size()) - 1;
  return node;
}

namespace {

int add_image(Scene& scene, TextureImage image, Filter filter, Wrap wrap) {
  scene.images.push_back(std::make_shared<TextureImage>(std::move(image)));
  Texture texture;
  texture.image = static_cast<int>(scene.images.size()) - 1;
  texture.wrap_u = texture.wrap_v = wrap;
  texture.filter = filter;
  scene.textures.push_back(texture);
  return static_cast<int>(scene.textures.size()) - 1;
}

}  // namespace

int SceneBuilder::add_texture(int width, int height, const std::vector<std::uint8_t>& rgba, Filter filter, Wrap wrap) {
  TextureImage image;
  image.width = width;
  image.height = height;
  image.has_alpha = true;
  image.pixels = rgba;
  return add_image(scene_, std::move(image), filter, wrap);
}

int SceneBuilder::add_texture_16(int width, int height, const std::vector<std::uint16_t>& rgba, Filter filter,
                                 Wrap wrap) {
  TextureImage image;
  image.width = width;
  image.height = height;
  image.bits = 16;
  image.has_alpha = true;
  image.pixels.resize(rgba.size() * sizeof(std::uint16_t));
  std::memcpy(image.pixels.data(), rgba.data(), image.pixels.size());
  return add_image(scene_, std::move(image), filter, wrap);
}

Scene SceneBuilder::build() const {
  Scene scene = scene_;
  if (scene.materials.empty()) scene.materials.emplace_back();
  validate(scene);
  return scene;
}

TextureSlot slot(int texture, int uv_set) {
  TextureSlot s;
  s.texture = texture;
  s.uv_set = uv_set;
  return s;
}

// ----- environments

Environment constant_environment(vec3 radiance) {
  Environment e;
  e.constant = radiance;
  return e;
}

Environment dark_environment() { return {}; }

Environment mapped_environment(int width, int height, const std::function<vec3(vec3)>& radiance) {
  auto map = std::make_shared<Image>(width, height, 3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float phi = ((static_cast<float>(x) + 0.5f) / static_cast<float>(width) - 0.5f) * 2.0f * kPi;
      const float theta = (static_cast<float>(y) + 0.5f) / static_cast<float>(height) * kPi;
      map->set_rgb(x, y, radiance({std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)}));
    }
  }
  Environment e;
  e.map = std::move(map);
  return e;
}

// ----- pictures

View from_above(float height, float half) {
  View view;
  // Columns: right = +x, up = -z, back = +y.
  view.world_from_camera = mat4(vec4(1, 0, 0, 0), vec4(0, 0, -1, 0), vec4(0, 1, 0, 0), vec4(0, height, 0, 1));
  view.projection = OrthographicCamera{.xmag = half, .ymag = half};
  return view;
}

path::Settings settings(int size, int samples, int bounces) {
  path::Settings s;
  s.width = s.height = size;
  s.samples = samples;
  s.bounces = bounces;
  return s;
}

path::Settings centred(int size, int samples, int bounces) {
  path::Settings s = settings(size, samples, bounces);
  s.filter_radius = 1e-5f;
  return s;
}

Film shoot(const Scene& scene, const Environment& environment, const View& view, const path::Settings& settings,
           const shade::ShadingModel& shading) {
  path::Statistics statistics;
  Film film = path::Tracer(borrowed(scene), environment, shading).render(view, settings, {}, &statistics);
  EXPECT_EQ(statistics.non_finite_samples, 0U);
  return film;
}

dvec3 mean_of(const Image& image, const Region& region) {
  dvec3 sum(0.0);
  for (int y = region.y0; y < region.y1; ++y) {
    for (int x = region.x0; x < region.x1; ++x) sum += dvec3(image.rgb(x, y));
  }
  return sum / static_cast<double>((region.x1 - region.x0) * (region.y1 - region.y0));
}

dvec3 mean_of(const Image& image) { return mean_of(image, {0, 0, image.width, image.height}); }

double mean_luminance(const Image& image) {
  const dvec3 m = mean_of(image);
  return 0.2126 * m.x + 0.7152 * m.y + 0.0722 * m.z;
}

double largest_difference(const Image& a, const Image& b) {
  EXPECT_EQ(a.pixels.size(), b.pixels.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    largest = std::max(largest, std::abs(static_cast<double>(a.pixels[i]) - static_cast<double>(b.pixels[i])));
  }
  return largest;
}

bool is_finite_and_not_negative(const Image& image) {
  for (const float v : image.pixels) {
    if (!(std::isfinite(v) && v >= 0.0f)) return false;
  }
  return true;
}

bool films_are_identical(const Film& a, const Film& b) {
  if (a.beauty.pixels != b.beauty.pixels || a.layers.size() != b.layers.size()) return false;
  for (const auto& [layer, image] : a.layers) {
    if (!b.layers.contains(layer) || image.pixels != b.layers.at(layer).pixels) return false;
  }
  return true;
}

Image mirrored_left_to_right(const Image& image) {
  Image result = image;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const auto from = image.at(image.width - 1 - x, y);
      std::copy(from.begin(), from.end(), result.at(x, y).begin());
    }
  }
  return result;
}

Moments over_seeds(int runs, const std::function<double(std::uint32_t)>& value) {
  Moments m;
  for (int i = 0; i < runs; ++i) m.add(value(static_cast<std::uint32_t>(1000 + i)));
  return m;
}

std::array<Moments, 3> mean_over_seeds(int runs, const Scene& scene, const Environment& environment, const View& view,
                                       path::Settings settings) {
  std::array<Moments, 3> channels;
  for (int i = 0; i < runs; ++i) {
    settings.seed = static_cast<std::uint32_t>(1000 + i);
    const dvec3 mean = mean_of(shoot(scene, environment, view, settings).beauty);
    for (int c = 0; c < 3; ++c) channels[static_cast<std::size_t>(c)].add(mean[c]);
  }
  return channels;
}

}  // namespace candela::test
