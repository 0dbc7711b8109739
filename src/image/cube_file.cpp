#include "image/cube_file.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/file.h"
#include "image/codec.h"
#include "image/cube_panorama.h"
#include "image/develop.h"
#include "image/film.h"
#include "image/image_file.h"
#include "image/repair.h"
#include "image/texture_file.h"

namespace candela {

namespace fs = std::filesystem;

namespace {

using FaceNames = std::array<std::string_view, 6>;
constexpr std::array<FaceNames, 3> kNameSets{{kFaceNames,
                                              {"posx", "negx", "posy", "negy", "posz", "negz"},
                                              {"right", "left", "top", "bottom", "front", "back"}}};

// ----- six files

/// "sky_px" and "px" end in the name "px"; "apx" does not.
bool ends_in_name(const std::string& stem, std::string_view name) {
  if (!stem.ends_with(name)) return false;
  if (stem.size() == name.size()) return true;
  const char before = stem[stem.size() - name.size() - 1];
  return before == '_' || before == '-' || before == '.';
}

/// The pictures of a folder, in order, so that the same folder gives the same answer.
std::vector<fs::path> pictures_in(const fs::path& folder) {
  std::vector<fs::path> pictures;
  std::error_code code;
  for (const auto& entry : fs::directory_iterator(folder, code))
    if (sniff_image_format(read_head(entry.path(), kSniffedBytes)) != ImageFormat::unknown)
      pictures.push_back(entry.path());
  std::sort(pictures.begin(), pictures.end());
  return pictures;
}

using SixPaths = std::array<fs::path, 6>;

std::optional<SixPaths> six_in_folder(const fs::path& folder) {
  const std::vector<fs::path> pictures = pictures_in(folder);
  for (const FaceNames& names : kNameSets) {
    SixPaths paths;
    bool all = true;
    for (std::size_t face = 0; face < 6; ++face) {
      const auto is_face = [&](const fs::path& p) { return ends_in_name(p.stem().string(), names[face]); };
      const auto found = std::find_if(pictures.begin(), pictures.end(), is_face);
      if (found == pictures.end()) {
        all = false;
        break;
      }
      if (std::find_if(found + 1, pictures.end(), is_face) != pictures.end())
        throw Error("more than one picture is called \"" + std::string(names[face]) + "\"", folder.string());
      paths[face] = *found;
    }
    if (all) return paths;
  }
  return std::nullopt;
}

std::optional<SixPaths> six_by_pattern(const std::string& pattern) {
  const std::size_t at = pattern.find("%s");
  for (const FaceNames& names : kNameSets) {
    SixPaths paths;
    bool all = true;
    for (std::size_t face = 0; face < 6; ++face) {
      paths[face] = std::string(pattern).replace(at, 2, names[face]);
      std::error_code code;
      all = all && fs::is_regular_file(paths[face], code);
    }
    if (all) return paths;
  }
  return std::nullopt;
}

bool is_pattern(const fs::path& path) { return path.string().find("%s") != std::string::npos; }

SixPaths find_six(const fs::path& path) {
  const std::optional<SixPaths> six = is_pattern(path) ? six_by_pattern(path.string()) : six_in_folder(path);
  if (six) return *six;
  throw Error("no six pictures called px nx py ny pz nz, posx negx ... or right left top bottom front back",
              path.string());
}

Image without_alpha(const Image& image) {
  if (image.channels == 3) return image;
  Image result(image.width, image.height, 3);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) result.set_rgb(x, y, image.rgb(x, y));
  return result;
}

/// Whether texels are put right before anything is made of them.
enum class Texels { as_they_are, put_right };

/// A picture, with what its reader should hear.
ImageFile read_and_tell(const ImageName& name, Texels texels, std::vector<Diagnostic>& warnings) {
  ImageFile file = read_image_file(name);
  for (const ImageFact& fact : file.facts)
    if (fact.is_odd) warnings.push_back({fact.name + " " + fact.value + ": " + fact.done, name.text()});
  if (texels == Texels::put_right) tell_repairs(repair(file.image), name.text(), warnings);
  return file;
}

CubeFaces read_six(const SixPaths& paths, Texels texels, std::vector<Diagnostic>& warnings) {
  CubeFaces faces;
  for (std::size_t face = 0; face < 6; ++face) {
    faces[face] = without_alpha(read_and_tell({paths[face], {}}, texels, warnings).image);
    if (faces[face].width != faces[face].height) throw Error("a face of a cube map is square", paths[face].string());
    if (faces[face].width != faces[0].width)
      throw Error("differs in size from \"" + paths[0].filename().string() + "\"", paths[face].string());
  }
  return faces;
}

// ----- pictures and textures

/// Empty where it cannot be known.
std::optional<ivec2> picture_size(const fs::path& path) {
  try {
    const ImageFormat format = sniff_image_format(read_head(path, kSniffedBytes));
    if (format == ImageFormat::unknown) return std::nullopt;
    if (is_display_format(format)) return read_image_size(read_file(path), path.string());
    const Image image = read_image(path);
    return ivec2(image.width, image.height);
  } catch (const Error&) {
    return std::nullopt;
  }
}

CubeSource cube_source_of_texture(const fs::path& path) {
  try {
    const TextureInfo info = read_texture_info(path);
    if (info.faces == 6) return CubeSource::texture;
    return detect_layout(info.width, info.height) ? CubeSource::layout : CubeSource::none;
  } catch (const Error&) {
    return CubeSource::none;
  }
}

Cubemap cube_of_texture(TextureFile file) {
  Cubemap cube;
  for (std::vector<Image>& level : file.levels)
    std::move(level.begin(), level.end(), cube.levels.emplace_back().begin());
  return cube;
}

CubeAxes axes_of_texture(const TextureInfo& info, const std::string& where) {
  const auto key = info.key_values.find(kAxesKey);
  if (key == info.key_values.end()) return {};
  const std::optional<CubeAxes> axes = parse_axes(key->second);
  if (!axes) throw Error("damaged: the key " + std::string(kAxesKey) + " is \"" + key->second + "\"", where);
  return *axes;
}

Cubemap cube_of_picture(const Image& image, CubeLayout layout, const std::optional<CubeAxes>& axes) {
  return cube_of_one_level(world_from_file(faces_from_layout(image, layout), axes.value_or(kPictureAxes)));
}

/// Whether the file says that its rows go up.
bool goes_up(const TextureInfo& info) {
  const auto key = info.key_values.find("KTXorientation");
  return key != info.key_values.end() && key->second.size() >= 2 && key->second[1] == 'u';
}

void turn_rows_over(Image& image) {
  const auto row = static_cast<std::ptrdiff_t>(image.width) * image.channels;
  for (std::ptrdiff_t y = 0; y < image.height / 2; ++y) {
    const auto top = image.pixels.begin() + y * row, bottom = image.pixels.begin() + (image.height - 1 - y) * row;
    std::swap_ranges(top, top + row, bottom);
  }
}

/// A 2-D texture is a picture: a panorama, or a cube map laid out.
EnvironmentFile environment_of_texture(TextureFile file, const std::string& where, const std::optional<CubeAxes>& axes,
                                       Texels texels) {
  EnvironmentFile result;
  Image image = without_alpha(file.levels.at(0).at(0));
  if (goes_up(file.info)) turn_rows_over(image);
  if (texels == Texels::put_right) tell_repairs(repair(image), where, result.warnings);
  if (const std::optional<CubeLayout> layout = detect_layout(image.width, image.height))
    result.cube = cube_of_picture(image, *layout, axes);
  else
    result.panorama = std::move(image);
  return result;
}

EnvironmentFile read_texture(const fs::path& path, const std::optional<CubeAxes>& axes, Texels texels) {
  const std::string where = path.string();
  TextureFile file = read_texture_file(path);
  if (file.info.faces != 6) return environment_of_texture(std::move(file), where, axes, texels);
  const CubeAxes lookup = axes ? *axes : axes_of_texture(file.info, where);
  EnvironmentFile result;
  result.cube = cube_of_texture(std::move(file));
  if (texels == Texels::put_right) {
    result.cube.levels.resize(1);
    for (std::size_t face = 0; face < 6; ++face)
      tell_repairs(repair(result.cube.levels[0][face]), where + ", face " + std::string(kFaceNames[face]),
                   result.warnings);
  }
  if (lookup != CubeAxes()) result.cube = world_from_file(result.cube, lookup);
  return result;
}

EnvironmentFile read_six_files(const fs::path& path, const std::optional<CubeAxes>& axes, Texels texels) {
  EnvironmentFile file;
  const CubeFaces faces = read_six(find_six(path), texels, file.warnings);
  file.cube = cube_of_one_level(world_from_file(faces, axes.value_or(kPictureAxes)));
  return file;
}

EnvironmentFile read_picture(const fs::path& path, const std::optional<CubeAxes>& axes, Texels texels) {
  EnvironmentFile file;
  ImageFile picture = read_and_tell(parse_image_name(path.string()), texels, file.warnings);
  const std::optional<CubeLayout> layout = detect_layout(picture.image.width, picture.image.height);
  if (picture.projection == Projection::cube && !axes)
    file.cube = cube_of_one_level(cube_from_openexr(picture.image));
  else if (picture.projection == Projection::latlong)
    file.panorama = panorama_from_openexr(picture.image);
  else if (layout)
    file.cube = cube_of_picture(picture.image, *layout, axes);
  else
    file.panorama = std::move(picture.image);
  return file;
}

EnvironmentFile read_environment(const fs::path& path, const std::optional<CubeAxes>& axes, Texels texels) {
  std::error_code code;
  if (fs::is_directory(path, code) || (!fs::exists(path, code) && is_pattern(path)))
    return read_six_files(path, axes, texels);
  if (sniff_texture(read_head(path, kSniffedBytes))) return read_texture(path, axes, texels);
  return read_picture(path, axes, texels);
}

// ----- RGBM

std::array<std::uint8_t, 4> rgbm_texel(vec3 color, const Rgbm& rgbm, EncodingLoss& loss) {
  const float maximum = rgbm.is_squared ? rgbm.range * rgbm.range : rgbm.range;
  vec3 scaled(0.0f);
  for (int c = 0; c < 3; ++c) {
    const float clamped = color[c] > 0.0f ? std::min(color[c], maximum) : 0.0f;
    scaled[c] = (rgbm.is_squared ? std::sqrt(clamped) : clamped) / rgbm.range;
  }
  if (!is_finite(color)) {
    ++loss.non_finite;
  } else {
    const float largest = max_component(color);
    loss.clamped += largest > maximum ? 1 : 0;
    loss.negative += std::min({color.x, color.y, color.z}) < 0.0f ? 1 : 0;
    if (largest > maximum) loss.largest = std::max(loss.largest, largest);
  }
  // The multiplier is rounded up, so that no channel needs more than 1; a black texel keeps the smallest.
  const float alpha = std::max(std::ceil(max_component(scaled) * 255.0f), 1.0f);
  std::array<std::uint8_t, 4> texel{};
  for (std::size_t c = 0; c < 3; ++c) {
    const float part = std::min(scaled[static_cast<int>(c)] * 255.0f / alpha, 1.0f);
    texel[c] = static_cast<std::uint8_t>(part * 255.0f + 0.5f);
  }
  texel[3] = static_cast<std::uint8_t>(alpha);
  return texel;
}

}  // namespace

std::vector<fs::path> files_of_environment(const fs::path& path) {
  if (find_cube_source(path) != CubeSource::six_files) return {path};
  const SixPaths six = find_six(path);
  return {six.begin(), six.end()};
}

CubeSource find_cube_source(const fs::path& path) {
  std::error_code code;
  try {
    if (fs::is_directory(path, code)) return six_in_folder(path) ? CubeSource::six_files : CubeSource::none;
  } catch (const Error&) {
    return CubeSource::six_files;  // two of a name: reading it says so
  }
  if (!fs::exists(path, code) && is_pattern(path))
    return six_by_pattern(path.string()) ? CubeSource::six_files : CubeSource::none;
  if (sniff_texture(read_head(path, kSniffedBytes))) return cube_source_of_texture(path);
  const std::optional<ivec2> size = picture_size(path);
  return size && detect_layout(size->x, size->y) ? CubeSource::layout : CubeSource::none;
}

EnvironmentFile read_environment_file(const fs::path& path, std::optional<CubeAxes> axes) {
  return read_environment(path, axes, Texels::as_they_are);
}

EnvironmentFile read_clean_environment(const fs::path& path, std::optional<CubeAxes> axes) {
  return read_environment(path, axes, Texels::put_right);
}

Cubemap read_cubemap(const fs::path& path, std::optional<CubeAxes> axes) {
  EnvironmentFile file = read_environment_file(path, axes);
  if (!file.cube.empty()) return std::move(file.cube);
  throw Error("a picture of " + std::to_string(file.panorama.width) + " x " + std::to_string(file.panorama.height) +
                  " is no cube map: crosses are 4:3 or 3:4, strips 6:1 or 1:6",
              path.string());
}

void write_linear_image(const fs::path& path, const Image& image) {
  const std::string extension = path.extension().string();
  if (extension == ".hdr") return write_hdr(path, image);
  if (extension != ".exr") throw Error("linear pictures are written as .exr or .hdr", path.string());
  Film film;
  film.beauty = image;
  write_exr(path, film);
}

std::vector<fs::path> write_cube_faces(const fs::path& path, const Cubemap& cube) {
  std::vector<fs::path> paths;
  for (std::size_t level = 0; level < cube.levels.size(); ++level) {
    for (std::size_t face = 0; face < 6; ++face) {
      const std::string mip = cube.levels.size() > 1 ? "_m" + std::to_string(level) : "";
      const std::string name = path.stem().string() + mip + "_" + std::string(kFaceNames[face]);
      paths.push_back(path.parent_path() / (name + path.extension().string()));
      write_linear_image(paths.back(), cube.levels[level][face]);
    }
  }
  return paths;
}

EncodingLoss write_rgbm_png(const fs::path& path, const Image& image, const Rgbm& rgbm) {
  if (!(rgbm.range > 0.0f) || !std::isfinite(rgbm.range))
    throw Error("the range of RGBM must be above 0", path.string());
  if (image.empty()) throw Error("cannot write an empty picture", path.string());
  EncodingLoss loss;
  DisplayImage out{image.width, image.height, {}};
  out.rgba.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 4);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const std::array<std::uint8_t, 4> texel = rgbm_texel(image.rgb(x, y), rgbm, loss);
      out.rgba.insert(out.rgba.end(), texel.begin(), texel.end());
    }
  }
  codec::write_png_data(path, out);
  return loss;
}

}  // namespace candela
