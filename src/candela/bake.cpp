#include "candela/bake.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <utility>

#include "base/file.h"
#include "base/memory.h"
#include "base/stopwatch.h"

namespace candela {

namespace {

bool is_power_of_two(int n) { return (n & (n - 1)) == 0; }

void check_gltf(const ibl::BakeSettings& s) {
  if (s.mapping != ibl::Mapping::linear) throw Error("--format gltf has linear levels", "--mapping");
  if (!is_power_of_two(s.size)) throw Error("--format gltf needs a power of two", "--size");
  if (s.sh_order < 2) throw Error("--format gltf needs degree 2", "--sh-order");
}

/// What the baker holds at once: the panorama, its sums and its harmonics, and directions and values of the faces.
void check_memory(const ibl::BakeSettings& settings, const ibl::Source& source) {
  constexpr std::uint64_t kPerTexel = 96, kPerFaceTexel = 160, kAlways = std::uint64_t{1} << 28;
  const auto texels = static_cast<std::uint64_t>(source.map.width) * static_cast<std::uint64_t>(source.map.height);
  const auto size = static_cast<std::uint64_t>(settings.size);
  require_memory(kAlways + texels * kPerTexel + 6 * size * size * kPerFaceTexel, available_memory(),
                 fmt::format("a bake of {0}x{0} texels", settings.size), "--size");
}

std::string name_of(const BakeOrder& order) {
  if (!order.has_light()) return "tables";
  const std::string& from = order.light.scene.empty() ? order.light.environment : order.light.scene;
  return is_built_in_environment(from) ? from : std::filesystem::path(from).filename().string();
}

}  // namespace

void follow_profile(std::optional<int> size, std::optional<int> levels, BakeOrder& order) {
  const ibl::Profile& profile = *order.profile;
  ibl::BakeSettings& s = order.settings;
  s.size = size.value_or(profile.size);
  // Of what the engine filters itself nothing but level 0 is written; a small cube has fewer.
  const auto most = static_cast<int>(std::bit_width(static_cast<unsigned>(s.size)));
  s.levels = levels.value_or(profile.is_filtered ? std::min(profile.levels, most) : 1);
  s.roughness.clear();
  for (int level = 0; level < s.levels; ++level) {
    s.roughness.push_back(static_cast<double>(ibl::roughness_of_level(profile, level, s.levels, s.size)));
  }
}

void follow_gltf(std::optional<int> levels, std::optional<ibl::Mapping> mapping, BakeOrder& order) {
  constexpr int kLevels = 5;
  order.settings.levels = levels.value_or(kLevels);
  order.settings.mapping = mapping.value_or(ibl::Mapping::linear);
}

void check_order(const BakeOrder& order) {
  const ibl::BakeSettings& s = order.settings;
  const bool is_gltf = order.profile == nullptr && order.format.kind == BakeFormat::Kind::gltf;
  if (is_gltf) check_gltf(s);
  if (s.sheen && (is_gltf || order.profile != nullptr)) {
    throw Error((is_gltf ? "--format gltf" : std::string(order.profile->name)) + " has no levels of the sheen lobe",
                "--sheen");
  }
  if (s.error > 0.0 && s.proof_directions == 0) throw Error("nothing is measured with --proof 0", "--error");
  constexpr int kMostLevels = 30;  // that an int can count the texels of
  if (s.levels > kMostLevels || (s.levels > 1 && s.size % (1 << (s.levels - 1)) != 0)) {
    throw Error(fmt::format("{} do not halve a face of {} texels without rest", s.levels, s.size), "--levels");
  }
  if (s.specular.method == ibl::Method::fis && !is_power_of_two(s.size)) {
    throw Error("fis needs a --size that is a power of two", "--method");
  }
}

BakeResult bake(const BakeOrder& order, const LoadedLight* light, const Job& job) {
  check_order(order);
  BakeResult result;
  result.name = name_of(order);
  result.order = order;
  if (light != nullptr) {
    ibl::BakeSettings& settings = result.order.settings;
    settings.specular.fis_size = settings.size;
    check_memory(settings, light->source);
    const Stopwatch watch;
    result.bake = bake_light(*light, settings, job);
    result.bake_s = watch.seconds();
    if (light->is_panorama) result.panorama = light->source.map;
    if (order.extracts_suns) result.suns = ibl::extract_suns(light->source);
  }
  if (order.table_size) {
    const Stopwatch watch;
    job.report({.fraction = 1.0, .what = "tables"});
    result.tables = ibl::make_tables(*order.table_size);
    result.tables_s = watch.seconds();
  }
  return result;
}

BakeResult bake(const BakeOrder& order, const Job& job) {
  check_order(order);
  if (!order.has_light()) return bake(order, nullptr, job);
  Diagnostics warnings;
  Job loading = job;
  loading.diagnostics = &warnings;
  const LoadedLight light = load_light(order.light, order.settings.size, loading);
  for (const Diagnostic& warning : warnings.warnings()) {
    if (job.diagnostics != nullptr) job.diagnostics->warn(warning.message, warning.where);
  }
  BakeResult result = bake(order, &light, job);
  result.warnings = warnings.warnings();
  return result;
}

}  // namespace candela
