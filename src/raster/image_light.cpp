#include "raster/image_light.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string>

#include "base/error.h"
#include "base/parallel.h"
#include "ibl/bake.h"
#include "ibl/cube.h"
#include "ibl/sh.h"
#include "image/texel.h"
#include "image/texture_file.h"
#include "math/hash.h"

namespace candela::raster {

namespace {

constexpr int kIrradianceSize = 32;
constexpr int kFormat = 1;  // of the cached files; counts up when the bake changes

/// Faces as sharp as the map: a quarter of its width, a power of two.
int face_size(const Environment& environment) {
  int size = 64;
  if (environment.map != nullptr) {
    while (size < 1024 && size * 4 < environment.map->width) size *= 2;
  }
  return environment.map == nullptr ? 16 : size;
}

/// FNV-1a over eight bytes at a time: Fowler, Noll & Vo, as in RFC draft-eastlake-fnv.
std::uint64_t fingerprint(std::uint64_t h, const void* data, std::size_t bytes) {
  const auto* p = static_cast<const unsigned char*>(data);
  for (; bytes >= 8; p += 8, bytes -= 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, p, 8);
    h = (h ^ word) * 0x100000001b3ull;
    h ^= h >> 29;
  }
  for (; bytes > 0; ++p, --bytes) h = (h ^ *p) * 0x100000001b3ull;
  return h;
}

/// The three cubes in one file: the sheen's levels and the irradiance are cubes of their own beside the first.
struct CacheFiles {
  std::filesystem::path specular, sheen, irradiance;

  CacheFiles(const std::filesystem::path& folder, const std::string& key)
      : specular(folder / (key + ".ktx2")),
        sheen(folder / (key + ".sheen.ktx2")),
        irradiance(folder / (key + ".irradiance.ktx2")) {}
};

Cubemap read_cube(const std::filesystem::path& path) {
  TextureFile file = read_texture_file(path);
  Cubemap cube;
  for (std::vector<Image>& level : file.levels) {
    if (level.size() != 6) throw Error("is no cube", path.string());
    CubeFaces faces;
    std::move(level.begin(), level.end(), faces.begin());
    cube.levels.push_back(std::move(faces));
  }
  return cube;
}

bool read_cached(const CacheFiles& files, bool wants_sheen, BakedLight& light) {
  std::error_code code;
  if (!std::filesystem::exists(files.specular, code)) return false;
  try {
    light.specular = read_cube(files.specular);
    light.irradiance = read_cube(files.irradiance).levels.at(0);
    if (wants_sheen) light.sheen = read_cube(files.sheen);
  } catch (const std::exception&) {
    return false;  // damaged: baked again and replaced
  }
  light.is_cached = true;
  return true;
}

void write_cached(const CacheFiles& files, const BakedLight& light) {
  try {
    std::filesystem::create_directories(files.specular.parent_path());
    const TextureOptions options{.format = TexelFormat::rgba16f, .zstd = false};
    // The file whose presence is asked for comes last.
    write_texture(files.irradiance, cube_of_one_level(light.irradiance), options);
    if (!light.sheen.empty()) write_texture(files.sheen, light.sheen, options);
    write_texture(files.specular, light.specular, options);
  } catch (const std::exception&) {
    // Another run bakes again.
  }
}

}  // namespace

LightKey light_key(const Environment& environment, bool wants_sheen) {
  std::uint64_t h = 0xcbf29ce484222325ull;
  if (environment.map != nullptr) {
    h = fingerprint(h, environment.map->pixels.data(), environment.map->pixels.size() * sizeof(float));
    h = fingerprint(h, &environment.map->width, sizeof environment.map->width);
  }
  h = fingerprint(h, &environment.constant, sizeof environment.constant);
  h = fingerprint(h, &environment.intensity, sizeof environment.intensity);
  h = fingerprint(h, &environment.rotation, sizeof environment.rotation);
  constexpr int kDigits = 16;
  std::string text(kDigits, '0');
  for (int i = 0; i < kDigits; ++i) text[static_cast<std::size_t>(i)] = "0123456789abcdef"[h >> (60 - 4 * i) & 15u];
  return "light-" + std::to_string(kFormat) + "-" + text + (wants_sheen ? "-sheen" : "");
}

std::filesystem::path default_cache() {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return std::filesystem::path(value == nullptr ? "" : value);
  };
  if (const auto xdg = variable("XDG_CACHE_HOME"); xdg.is_absolute()) return xdg / "candela";
  if (const auto home = variable("HOME"); home.is_absolute()) return home / ".cache" / "candela";
  return {};
}

bool uses_sheen(const Scene& scene) {
  return std::any_of(scene.materials.begin(), scene.materials.end(),
                     [](const Material& m) { return max_component(m.sheen_color) > 0.0f && !m.unlit; });
}

bool is_lit_from_far(const Environment& environment) {
  return environment.intensity > 0.0f && (environment.map != nullptr || max_component(environment.constant) > 0.0f);
}

BakedLight bake_light(const Environment& environment, bool wants_sheen, const std::filesystem::path& cache) {
  Environment shadowless = environment;
  shadowless.suns.clear();
  BakedLight light;
  const CacheFiles files(cache, light_key(environment, wants_sheen));
  if (!cache.empty() && read_cached(files, wants_sheen, light)) return light;

  ibl::BakeSettings settings;
  settings.size = face_size(environment);
  settings.levels = 2;
  while (settings.size >> settings.levels >= 8 && settings.levels < 7) ++settings.levels;
  settings.irradiance_size = std::min(kIrradianceSize, settings.size);
  settings.sheen = wants_sheen;
  settings.proof_directions = 0;
  ibl::Bake bake = ibl::bake(ibl::make_source(shadowless), settings);
  light.specular = std::move(bake.specular);
  light.sheen = std::move(bake.sheen);
  light.irradiance = std::move(bake.irradiance);
  // A plain colour is faster made than read.
  if (!cache.empty() && environment.map != nullptr) write_cached(files, light);
  return light;
}

BakedLight bake_light(const CubeFaces& cube, bool wants_sheen) {
  ibl::BakeSettings settings;
  settings.size = cube[0].width;
  settings.levels = 2;
  while (settings.size >> settings.levels >= 8 && settings.levels < 7) ++settings.levels;
  settings.irradiance_size = std::min(kIrradianceSize, settings.size);
  settings.sheen = wants_sheen;
  settings.proof_directions = 0;
  ibl::Bake bake = ibl::bake(ibl::make_source(cube), settings);
  return {std::move(bake.specular), std::move(bake.sheen), std::move(bake.irradiance), false};
}

namespace {

void scale(CubeFaces& faces, float factor) {
  for (Image& face : faces) {
    for (float& v : face.pixels) v *= factor;
  }
}

/// Calls f with each texel's values, its direction and its solid angle.
template <class F>
void over_texels(CubeFaces& faces, const F& f) {
  const int size = faces[0].width;
  for (int face = 0; face < 6; ++face) {
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        f(faces[static_cast<std::size_t>(face)].at(x, y), ibl::cube_texel_direction(face, x, y, size),
          cube_texel_solid_angle(size, x, y));
      }
    }
  }
}

/// What nine harmonics keep of a function on the sphere.
void keep_nine_harmonics(CubeFaces& faces) {
  std::array<dvec3, 9> coefficients{};
  over_texels(faces, [&](std::span<float> value, dvec3 direction, double solid_angle) {
    const std::vector<double> basis = ibl::sh_basis(2, direction);
    for (std::size_t i = 0; i < 9; ++i) {
      coefficients[i] += basis[i] * solid_angle * dvec3(value[0], value[1], value[2]);
    }
  });
  over_texels(faces, [&](std::span<float> value, dvec3 direction, double) {
    const std::vector<double> basis = ibl::sh_basis(2, direction);
    dvec3 sum(0);
    for (std::size_t i = 0; i < 9; ++i) sum += basis[i] * coefficients[i];
    for (int c = 0; c < 3; ++c) value[static_cast<std::size_t>(c)] = static_cast<float>(std::max(sum[c], 0.0));
  });
}

/// Level l of the result, where a shader looks for α = 2^(l - levels + 1), is the mip that roughness √α chooses.
Cubemap mips_by_roughness(const Cubemap& light) {
  const Cubemap mips = ibl::cube_mips(light.levels[0]);
  const auto levels = static_cast<float>(light.levels.size());
  Cubemap result = light;
  for (std::size_t l = 1; l < light.levels.size(); ++l) {
    const float roughness = std::sqrt(std::exp2(static_cast<float>(l) - levels + 1.0f));
    const float lod = roughness * static_cast<float>(mips.levels.size() - 1);
    const auto mip = std::min(static_cast<std::size_t>(lod), mips.levels.size() - 2);
    const float t = lod - static_cast<float>(mip);
    over_texels(result.levels[l], [&](std::span<float> value, dvec3 direction, double) {
      const vec3 sharp = ibl::cube_lookup(mips.levels[mip], direction);
      const vec3 wide = ibl::cube_lookup(mips.levels[mip + 1], direction);
      for (int c = 0; c < 3; ++c) value[static_cast<std::size_t>(c)] = glm::mix(sharp[c], wide[c], t);
    });
  }
  return result;
}

}  // namespace

BakedLight simplified(BakedLight light, Ambient ambient) {
  if (light.specular.empty()) return light;
  switch (ambient) {
    case Ambient::baked:
      break;
    case Ambient::harmonics:
      keep_nine_harmonics(light.irradiance);
      break;
    case Ambient::mips:
      light.specular = mips_by_roughness(light.specular);
      light.irradiance = ibl::cube_mips(light.specular.levels[0]).levels.back();
      scale(light.irradiance, kPi);
      break;
    case Ambient::constant: {
      dvec3 mean(0);
      over_texels(light.irradiance, [&](std::span<float> value, dvec3, double solid_angle) {
        mean += solid_angle / (4.0 * glm::pi<double>()) * dvec3(value[0], value[1], value[2]);
      });
      over_texels(light.irradiance, [&](std::span<float> value, dvec3, double) {
        for (int c = 0; c < 3; ++c) value[static_cast<std::size_t>(c)] = static_cast<float>(mean[c]);
      });
      for (Cubemap* lobes : {&light.specular, &light.sheen}) {
        for (CubeFaces& level : lobes->levels) scale(level, 0.0f);
      }
      break;
    }
    case Ambient::none:
      light = {};
      break;
  }
  return light;
}

gl::Texture upload_cube(const Cubemap& cube) {
  gl::Texture texture;
  glBindTexture(GL_TEXTURE_CUBE_MAP, texture);
  // Rounded as in the files of a cache, so that a picture does not depend on whether there was one.
  std::vector<std::uint16_t> rgba;
  for (std::size_t level = 0; level < cube.levels.size(); ++level) {
    const int size = cube.size(level);
    rgba.assign(static_cast<std::size_t>(size) * static_cast<std::size_t>(size) * 4, half_from_float(1.0f));
    for (std::size_t face = 0; face < 6; ++face) {
      const Image& image = cube.levels[level][face];
      const auto channels = static_cast<std::size_t>(image.channels);
      for (std::size_t i = 0; i < rgba.size() / 4; ++i) {
        for (std::size_t c = 0; c < 3; ++c) rgba[4 * i + c] = half_from_float(image.pixels[channels * i + c]);
      }
      glTexImage2D(GL_TEXTURE_CUBE_MAP_POSITIVE_X + static_cast<GLenum>(face), static_cast<GLint>(level), GL_RGBA16F,
                   size, size, 0, GL_RGBA, GL_HALF_FLOAT, rgba.data());
    }
  }
  glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MAX_LEVEL, static_cast<GLint>(cube.levels.size()) - 1);
  glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MIN_FILTER,
                  cube.levels.size() > 1 ? GL_LINEAR_MIPMAP_LINEAR : GL_LINEAR);
  gl::check("uploading the environment");
  return texture;
}

}  // namespace candela::raster
