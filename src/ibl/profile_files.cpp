#include "ibl/profile_files.h"

#include <numbers>

#include "base/check.h"
#include "base/error.h"
#include "ibl/cube.h"
#include "image/cube_file.h"
#include "image/table_file.h"

namespace candela::ibl {

namespace fs = std::filesystem;

namespace {

/// Place of the product of axes a and b among x y z xx yy zz yz zx xy.
std::size_t product_at(std::size_t a, std::size_t b) { return a == b ? 3 + a : 9 - a - b; }

/// Factors of powers of the world's x, y and z as those of the lookup vector's.
std::vector<dvec3> turned_powers(const CubeAxes& axes, const std::vector<dvec3>& world) {
  std::vector<dvec3> result(9);
  const auto axis = [&](std::size_t i) { return static_cast<std::size_t>(axes.axis[i]); };
  for (std::size_t i = 0; i < 3; ++i) {
    result[i] = static_cast<double>(axes.sign[i]) * world[axis(i)];
    for (std::size_t j = i; j < 3; ++j) {
      const double sign = axes.sign[i] * axes.sign[j];
      result[product_at(i, j)] = sign * world[product_at(axis(i), axis(j))];
    }
  }
  return result;
}

class Writer {
 public:
  Writer(const Profile& profile, fs::path folder, const BakedLight& light)
      : profile_(profile), folder_(std::move(folder)), light_(light) {}

  WrittenFiles write() {
    if (light_.specular != nullptr) write_specular();
    if (light_.diffuse != nullptr && profile_.diffuse_map != DiffuseUnit::none) write_diffuse();
    if (!light_.sh.empty() && profile_.diffuse_sh != DiffuseUnit::none) write_sh();
    if (light_.table != nullptr) write_table();
    return std::move(files_);
  }

 private:
  void write_cube(const std::string& name, const Cubemap& world, const TextureOptions& options) {
    const fs::path path = folder_ / (name + container_extension(options.container));
    files_.loss += write_texture(path, orient(profile_, world), options);
    files_.paths.push_back(path);
  }

  void write_specular() {
    const Cubemap& all = *light_.specular;
    if (profile_.container == ProfileContainer::exr_panorama) {
      const Image panorama =
          light_.panorama != nullptr ? *light_.panorama : equirect_from_cube(all.levels.at(0), 4 * all.size());
      write_linear_image(folder_ / "environment.exr", orient_panorama(profile_, panorama));
      files_.paths.push_back(folder_ / "environment.exr");
      return;
    }
    const Cubemap cube = profile_.is_filtered ? all : cube_of_one_level(all.levels.at(0));
    if (profile_.container == ProfileContainer::hdr_faces) {
      const auto faces = write_cube_faces(folder_ / "specular.hdr", orient(profile_, cube));
      files_.paths.insert(files_.paths.end(), faces.begin(), faces.end());
      return;
    }
    TextureOptions options = texture_options(profile_);
    if (profile_.diffuse_sh == DiffuseUnit::polynomial_over_pi && options.container == TextureContainer::ktx1 &&
        !light_.sh.empty())
      options.key_values["sh"] = sh_lines(sh_for(profile_, light_.sh));
    write_cube("specular", cube, options);
  }

  void write_diffuse() {
    CANDELA_CHECK(profile_.diffuse_map == DiffuseUnit::irradiance_over_pi);
    Cubemap cube = cube_of_one_level(*light_.diffuse);
    for (Image& face : cube.levels[0])
      for (float& v : face.pixels) v *= std::numbers::inv_pi_v<float>;
    write_cube("diffuse", cube, texture_options(profile_));
  }

  void write_sh() {
    const std::vector<dvec3> sh = sh_for(profile_, light_.sh);
    const bool is_harmonic = profile_.diffuse_sh == DiffuseUnit::radiance;
    const ShText text{
        .unit = std::string(unit_name(profile_.diffuse_sh)),
        .basis = is_harmonic ? "real, orthonormal, without the Condon-Shortley sign, at l (l + 1) + m" : "polynomial",
        .axes = axes_text(profile_.sh_axes),
        .source = light_.source};
    write_sh_json(folder_ / "sh.json", sh, text);
    write_sh_header(folder_ / "sh.h", sh, text, "sh");
    files_.paths.insert(files_.paths.end(), {folder_ / "sh.json", folder_ / "sh.h"});
  }

  void write_table() {
    const Image table = arrange_table(profile_.table.value_or(TableAxes()), *light_.table);
    write_linear_image(folder_ / "dfg.exr", table);
    files_.loss += write_texture(folder_ / "dfg.ktx2", table, {.format = TexelFormat::rgba16f, .zstd = false});
    files_.paths.insert(files_.paths.end(), {folder_ / "dfg.exr", folder_ / "dfg.ktx2"});
  }

  const Profile& profile_;
  fs::path folder_;
  const BakedLight& light_;
  WrittenFiles files_;
};

}  // namespace

std::vector<dvec3> sh_for(const Profile& profile, std::span<const dvec3> radiance) {
  std::vector<dvec3> sh = convert_sh(profile.diffuse_sh, radiance);
  if (profile.diffuse_sh == DiffuseUnit::powers_over_pi) return turned_powers(profile.sh_axes, sh);
  CANDELA_CHECK(profile.sh_axes == CubeAxes());  // no engine wants turned harmonics in another form
  return sh;
}

WrittenFiles write_for(const Profile& profile, const fs::path& folder, const BakedLight& light) {
  return Writer(profile, folder, light).write();
}

}  // namespace candela::ibl
