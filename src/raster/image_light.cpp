#include "raster/image_light.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/file.h"
#include "base/parallel.h"
#include "ibl/bake.h"
#include "ibl/cube.h"
#include "ibl/sh.h"
#include "image/texture_file.h"
#include "math/hash.h"
#include "scene/material_table.h"

namespace candela::raster {

namespace {

constexpr int kIrradianceSize = 32;
constexpr int kFormat = 2;  // of the cached files; counts up when the bake changes

/// Faces as sharp as the map: a quarter of its width, a power of two.
int face_size(const Environment& environment) {
  int size = 64;
  if (environment.map != nullptr) {
    while (size < 1024 && size * 4 < environment.map->width) size *= 2;
  }
  return environment.map == nullptr ? 16 : size;
}

template <class T>
std::uint64_t fingerprint_of(std::uint64_t h, const T* data, std::size_t count) {
  return fingerprint(std::as_bytes(std::span(data, count)), h);
}

int level_count(int size) {
  int levels = 2;
  while (size >> levels >= 8 && levels < 7) ++levels;
  return levels;
}

/// The three cubes of a light, and a file that vouches for them: its name and the fingerprint of each.
struct CacheFiles {
  std::filesystem::path specular, sheen, irradiance, seal;
  std::string key;
  bool has_sheen;

  CacheFiles(const std::filesystem::path& folder, const std::string& name, bool wants_sheen)
      : specular(folder / (name + ".ktx2")),
        sheen(folder / (name + ".sheen.ktx2")),
        irradiance(folder / (name + ".irradiance.ktx2")),
        seal(folder / (name + ".seal")),
        key(name),
        has_sheen(wants_sheen) {}
};

constexpr std::uint64_t kMostCacheBytes = std::uint64_t{1} << 30;

/// A whole file and what the seal says of it.
struct CachedFile {
  explicit CachedFile(const std::filesystem::path& file) : path(file), bytes(read_file(file, kMostCacheBytes)) {}

  std::filesystem::path path;
  std::vector<std::byte> bytes;
};

std::string seal_text(const CacheFiles& files, const std::vector<CachedFile>& contents) {
  std::string text = files.key + '\n';
  for (const CachedFile& file : contents) text += std::to_string(fingerprint(file.bytes)) + '\n';
  return text;
}

std::vector<CachedFile> read_files(const CacheFiles& files) {
  std::vector<CachedFile> contents;
  contents.emplace_back(files.irradiance);
  if (files.has_sheen) contents.emplace_back(files.sheen);
  contents.emplace_back(files.specular);
  return contents;
}

bool is_light(const Image& image, int size) {
  return image.width == size && image.height == size && image.channels == 3 &&
         std::all_of(image.pixels.begin(), image.pixels.end(), [](float v) { return std::isfinite(v) && v >= 0.0f; });
}

/// A cube of `levels` from `size` on, with nothing in it that is no light. Throws Error.
Cubemap read_cube(const CachedFile& content, int size, int levels) {
  const std::string where = content.path.string();
  TextureFile file = decode_texture_file(content.bytes, where);
  if (file.levels.size() != static_cast<std::size_t>(levels)) throw Error("has other levels", where);
  Cubemap cube;
  for (std::vector<Image>& level : file.levels) {
    if (level.size() != 6) throw Error("is no cube", where);
    for (const Image& face : level) {
      if (!is_light(face, size)) throw Error("is not what was baked", where);
    }
    CubeFaces faces;
    std::move(level.begin(), level.end(), faces.begin());
    cube.levels.push_back(std::move(faces));
    size /= 2;
  }
  return cube;
}

/// Whole, of this very light, as large as a bake of it is, and finite; else as if it were not there.
std::optional<BakedLight> read_cached(const CacheFiles& files, const ibl::BakeSettings& settings) {
  std::error_code code;
  if (!std::filesystem::exists(files.seal, code)) return std::nullopt;
  try {
    const std::vector<CachedFile> contents = read_files(files);
    const CachedFile seal(files.seal);
    const std::string text = seal_text(files, contents);
    if (!std::ranges::equal(std::as_bytes(std::span(text)), seal.bytes)) return std::nullopt;
    BakedLight light;
    light.irradiance = read_cube(contents.front(), settings.irradiance_size, 1).levels.at(0);
    if (files.has_sheen) light.sheen = read_cube(contents[1], settings.size, settings.levels);
    light.specular = read_cube(contents.back(), settings.size, settings.levels);
    light.is_cached = true;
    return light;
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

void write_cached(const CacheFiles& files, const BakedLight& light) {
  try {
    std::filesystem::create_directories(files.specular.parent_path());
    const TextureOptions options{.format = TexelFormat::rgba16f, .zstd = false};
    write_texture(files.irradiance, cube_of_one_level(light.irradiance), options);
    if (files.has_sheen) write_texture(files.sheen, light.sheen, options);
    write_texture(files.specular, light.specular, options);
    // Of what the disk has; last, for without it the others do not count.
    write_file(files.seal, seal_text(files, read_files(files)));
  } catch (const std::exception&) {
    // Another run bakes again.
  }
}

}  // namespace

LightKey light_key(const Environment& environment, bool wants_sheen) {
  std::uint64_t h = 0xcbf29ce484222325ull;
  if (environment.map != nullptr) {
    h = fingerprint_of(h, environment.map->pixels.data(), environment.map->pixels.size());
    h = fingerprint_of(h, &environment.map->width, 1);
  }
  h = fingerprint_of(h, &environment.constant, 1);
  h = fingerprint_of(h, &environment.intensity, 1);
  h = fingerprint_of(h, &environment.rotation, 1);
  constexpr int kDigits = 16;
  std::string text(kDigits, '0');
  for (int i = 0; i < kDigits; ++i) text[static_cast<std::size_t>(i)] = "0123456789abcdef"[h >> (60 - 4 * i) & 15u];
  return "light-" + std::to_string(kFormat) + "-" + text + (wants_sheen ? "-sheen" : "");
}

bool uses_sheen(const Scene& scene) {
  return std::any_of(scene.materials.begin(), scene.materials.end(),
                     [](const Material& m) { return (lobes_of(m) & shade::kLobesOfFibres) != 0 && !m.unlit; });
}

bool is_lit_from_far(const Environment& environment) {
  const auto is_black = [](const Image& map) {
    return std::all_of(map.pixels.begin(), map.pixels.end(), [](float v) { return !(v > 0.0f); });
  };
  return environment.intensity > 0.0f &&
         (max_component(environment.constant) > 0.0f || (environment.map != nullptr && !is_black(*environment.map)));
}

BakedLight bake_light(const Environment& environment, bool wants_sheen, const std::filesystem::path& cache) {
  Environment shadowless = environment;
  shadowless.suns.clear();
  ibl::BakeSettings settings;
  settings.size = face_size(environment);
  settings.levels = level_count(settings.size);
  settings.irradiance_size = std::min(kIrradianceSize, settings.size);
  settings.sheen = wants_sheen;
  settings.proof_directions = 0;
  const CacheFiles files(cache, light_key(environment, wants_sheen), wants_sheen);
  if (!cache.empty()) {
    if (std::optional<BakedLight> cached = read_cached(files, settings)) return *std::move(cached);
  }

  BakedLight light;
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
  settings.levels = level_count(settings.size);
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

}  // namespace candela::raster
