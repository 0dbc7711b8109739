#include "io/texture_budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <queue>

#include "base/error.h"
#include "scene/material_table.h"

namespace candela::io {

namespace {

/// As people write it in the option.
std::string amount_text(std::uint64_t bytes) {
  constexpr double kKilo = 1000.0;
  const auto amount = static_cast<double>(bytes);
  if (amount < kKilo * kKilo) return fmt::format("{:.4g} KB", amount / kKilo);
  if (amount < kKilo * kKilo * kKilo) return fmt::format("{:.4g} MB", amount / (kKilo * kKilo));
  return fmt::format("{:.4g} GB", amount / (kKilo * kKilo * kKilo));
}

bool is_texel(ivec2 size) { return size.x == 1 && size.y == 1; }

std::vector<int> levels_to_drop(std::span<const TextureExtent> images, const TextureBudget& budget) {
  struct Candidate {
    std::uint64_t bytes;
    std::size_t image;
    bool operator<(const Candidate& other) const {
      return bytes != other.bytes ? bytes < other.bytes : image > other.image;
    }
  };
  std::vector<int> levels(images.size(), 0);
  std::priority_queue<Candidate> largest;
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const std::uint64_t bytes = texture_bytes(images[i], 0, budget.counts_levels);
    sum += bytes;
    if (!images[i].is_here && !is_texel(images[i].size)) largest.push({bytes, i});
  }
  while (sum > budget.bytes) {
    if (largest.empty()) {
      throw Error(
          fmt::format("{} images have no room in {} of texture memory", images.size(), amount_text(budget.bytes)));
    }
    const Candidate top = largest.top();
    largest.pop();
    const int level = ++levels[top.image];
    const std::uint64_t bytes = texture_bytes(images[top.image], level, budget.counts_levels);
    sum -= top.bytes - bytes;
    if (!is_texel(size_of_level(images[top.image].size, level))) largest.push({bytes, top.image});
  }
  return levels;
}

std::string what_is_dropped(std::span<const TextureExtent> images, const std::vector<int>& levels,
                            const TextureBudget& budget) {
  std::map<int, std::size_t> counts;
  for (const int level : levels) {
    if (level > 0) ++counts[level];
  }
  if (counts.empty()) return {};
  std::string text;
  for (const auto& [level, count] : counts) {
    text += fmt::format("{}{} {} {}", text.empty() ? "" : ", ", count, count == 1 ? "loses" : "lose",
                        level == 1 ? "one level" : fmt::format("{} levels", level));
  }
  const auto deepest = static_cast<std::size_t>(std::max_element(levels.begin(), levels.end()) - levels.begin());
  const ivec2 full = images[deepest].size, left = size_of_level(full, levels[deepest]);
  return fmt::format("to fit into {} of texture memory, of {} images {}; at worst {} x {} texels become {} x {}",
                     amount_text(budget.bytes), images.size(), text, full.x, full.y, left.x, left.y);
}

}  // namespace

ImageUses uses_of_images(std::span<const Material> materials, std::span<const Texture> textures, std::size_t images) {
  struct Uses {
    bool color = false, normal = false, data = false;
  };
  std::vector<Uses> uses(images);
  for (const Material& material : materials) {
    for (const TextureRow& row : kTextureRows) {
      const TextureSlot& slot = material.*row.slot;
      if (!slot) continue;
      Uses& u = uses[static_cast<std::size_t>(textures[static_cast<std::size_t>(slot.texture)].image)];
      u.color |= row.use == TextureUse::color;
      u.normal |= row.use == TextureUse::normal;
      u.data |= row.use == TextureUse::data;
    }
  }
  ImageUses result;
  for (const Uses& u : uses) {
    const bool is_normal = u.normal && !u.data;
    result.kinds.push_back(u.color ? TexelKind::color : is_normal ? TexelKind::normal : TexelKind::data);
    result.copies.push_back(u.color && (u.normal || u.data) ? 2 : 1);
  }
  return result;
}

std::uint64_t texture_bytes(const TextureExtent& image, int level, bool counts_levels) {
  std::uint64_t texels = 0;
  for (int k = level;; ++k) {
    const ivec2 size = size_of_level(image.size, k);
    texels += static_cast<std::uint64_t>(size.x) * static_cast<std::uint64_t>(size.y);
    if (!counts_levels || is_texel(size)) break;
  }
  return texels * 4 * static_cast<std::uint64_t>(image.bits / 8) * static_cast<std::uint64_t>(image.copies);
}

TexturePlan plan_textures(std::span<const TextureExtent> images, const TextureBudget& budget, int threads) {
  TexturePlan plan;
  plan.levels = levels_to_drop(images, budget);
  plan.told = what_is_dropped(images, plan.levels, budget);
  std::uint64_t kept = 0;
  for (const TextureExtent& image : images) {
    if (image.is_here) kept += texture_bytes(image, 0, false);
  }
  std::uint64_t most = 0;  // of the batch, at full size
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (images[i].is_here) continue;
    const std::uint64_t full = texture_bytes(images[i], 0, false);
    kept += texture_bytes(images[i], plan.levels[i], false);
    most = std::max(most, full);
    if (plan.batches.empty() || kept + static_cast<std::uint64_t>(threads) * most > budget.bytes) {
      plan.batches.emplace_back();
      most = full;
    }
    plan.batches.back().push_back(i);
  }
  return plan;
}

void fit_textures(Scene& scene, const TextureBudget& budget, Diagnostics& diagnostics, const std::string& where) {
  const ImageUses uses = uses_of_images(scene.materials, scene.textures, scene.images.size());
  std::vector<TextureExtent> extents;
  for (const auto& image : scene.images) {
    const int copies = budget.counts_levels ? uses.copies[extents.size()] : 1;
    extents.push_back({.size = {image->width, image->height}, .bits = image->bits, .copies = copies});
  }
  const TexturePlan plan = plan_textures(extents, budget, 1);
  for (std::size_t i = 0; i < extents.size(); ++i) {
    if (plan.levels[i] == 0) continue;
    scene.images[i] = std::make_shared<const TextureImage>(reduced(*scene.images[i], plan.levels[i], uses.kinds[i]));
  }
  if (!plan.told.empty()) diagnostics.warn(plan.told, where);
}

}  // namespace candela::io
