#include "path/guide.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace candela::path {

namespace {

constexpr float kOneBelow = 0x1.fffffep-1f;

/// The cylinder around the sphere, unrolled: equal areas stay equal (Archimedes).
vec2 square_from_sphere(vec3 d) {
  const float turn = std::atan2(d.y, d.x) * (0.5f / kPi);
  return {std::clamp(0.5f * (d.z + 1.0f), 0.0f, kOneBelow),
          std::clamp(turn < 0.0f ? turn + 1.0f : turn, 0.0f, kOneBelow)};
}

vec3 sphere_from_square(vec2 p) {
  const float z = 2.0f * p.x - 1.0f;
  const float r = std::sqrt(std::max(1.0f - z * z, 0.0f));
  const float phi = 2.0f * kPi * p.y;
  return {r * std::cos(phi), r * std::sin(phi), z};
}

/// The quarter that `p` is in; `p` becomes its place there.
std::size_t descend(vec2& p) {
  p *= 2.0f;
  const std::size_t x = p.x >= 1.0f ? 1 : 0, y = p.y >= 1.0f ? 1 : 0;
  p -= vec2(x, y);
  return x + 2 * y;
}

int longest_axis(const Box3& box) {
  const vec3 s = box.size();
  if (s.x >= s.y && s.x >= s.z) return 0;
  return s.y >= s.z ? 1 : 2;
}

}  // namespace

GuidedKind guided_kind(const shade::Surface& surface) {
  constexpr float kSharp = 0.08f;    // alpha: the lobe is narrower than what a guide resolves
  constexpr float kDiffuse = 0.25f;  // share of the samples
  if (surface.chance_diffuse > kDiffuse || surface.alpha > 0.5f) return GuidedKind::diffuse;
  return surface.alpha > kSharp ? GuidedKind::glossy : GuidedKind::sharp;
}

Guide::Guide(const Box3& bounds) : bounds_(bounds), cells_(1), regions_(1), quads_(1) { cells_[0].first = 0; }

std::uint32_t Guide::find_region(vec3 position) const {
  Box3 box = bounds_;
  const Cell* cell = cells_.data();
  while (cell->axis >= 0) {
    const int axis = cell->axis;
    const float middle = 0.5f * (box.lower[axis] + box.upper[axis]);
    const bool is_upper = position[axis] >= middle;
    (is_upper ? box.lower : box.upper)[axis] = middle;
    cell = &cells_[cell->first + (is_upper ? 1 : 0)];
  }
  return cell->first;
}

vec3 Guide::sample(std::uint32_t region, vec2 u) const {
  // ----- in each cell a half by x, then a quarter of it by y; what is left of u chooses further inside
  vec2 corner(0.0f);
  float size = 1.0f;
  std::uint32_t index = regions_[region].root;
  while (true) {
    const Quad& quad = quads_[index];
    const float left = quad.shares[0] + quad.shares[2];
    std::size_t x = 0, y = 0;
    if (u.x < left) {
      u.x /= left;
    } else {
      x = 1;
      u.x = (u.x - left) / (1.0f - left);
    }
    const float lower = quad.shares[x] / (quad.shares[x] + quad.shares[x + 2]);
    if (u.y < lower) {
      u.y /= lower;
    } else {
      y = 1;
      u.y = (u.y - lower) / (1.0f - lower);
    }
    u = glm::min(u, vec2(kOneBelow));
    size *= 0.5f;
    corner += size * vec2(x, y);
    index = quad.children[x + 2 * y];
    if (index == 0) return sphere_from_square(corner + size * u);
  }
}

float Guide::pdf(std::uint32_t region, vec3 direction) const {
  vec2 p = square_from_sphere(direction);
  float pdf = 0.25f / kPi;
  std::uint32_t index = regions_[region].root;
  do {
    const Quad& quad = quads_[index];
    const std::size_t quarter = descend(p);
    pdf *= 4.0f * quad.shares[quarter];
    index = quad.children[quarter];
  } while (index != 0);
  return pdf;
}

std::uint32_t Guide::find_cell(std::uint32_t region, vec3 direction) const {
  vec2 p = square_from_sphere(direction);
  std::uint32_t index = regions_[region].root;
  while (true) {
    const std::size_t quarter = descend(p);
    const std::uint32_t child = quads_[index].children[quarter];
    if (child == 0) return 4 * index + static_cast<std::uint32_t>(quarter);
    index = child;
  }
}

std::uint64_t Guide::bytes() const {
  return cells_.size() * sizeof(Cell) + regions_.size() * sizeof(Region) + quads_.size() * sizeof(Quad);
}

GuideLearner::GuideLearner(const Guide& guide, bool has_sky)
    : guide_(guide), has_sky_(has_sky), tallies_(guide.regions_.size()), found_(guide.quads_.size()) {}

void GuideLearner::add(std::span<const GuideRecord> records) {
  for (const GuideRecord& record : records) {
    RegionTally& region = tallies_[record.region];
    ++region.count;
    Found& found = found_[record.cell / 4][record.cell % 4];
    found.light += static_cast<double>(record.light);
    found.paths += record.light > 0.0f ? 1.0 : 0.0;
    if (!(record.reflected > 0.0f)) continue;
    const auto kind = static_cast<std::size_t>(record.kind);
    ++region.kinds[kind].found;
    ++everywhere_[kind].found;
    const double square = static_cast<double>(record.reflected) * static_cast<double>(record.reflected);
    for (std::size_t i = 0; i < kMixes.size(); ++i) {
      const GuideMix& mix = kMixes[i];
      const float pdf =
          mix.learned * record.learned_pdf + mix.sky * record.sky_pdf + mix.by_material() * record.bsdf_pdf;
      const double moment = square * static_cast<double>(record.pdf / std::max(pdf, 1e-20f));
      region.kinds[kind].second_moment[i] += moment;
      everywhere_[kind].second_moment[i] += moment;
    }
  }
}

/// That of the least second moment; where few paths found light, what does well everywhere counts too.
GuideMix GuideLearner::best_mix(const Tally& tally, const Tally& everywhere) const {
  constexpr double kTrusted = 50.0;  // paths
  if (tally.found == 0) return {};
  if (!guide_.is_learned_) return has_sky_ ? GuideMix{0.25f, 0.25f} : GuideMix{0.4f, 0.0f};
  const std::size_t count = has_sky_ ? kMixes.size() : kMixesWithoutSky;
  const auto least = [&](const Tally& of) {
    return std::max(*std::min_element(of.second_moment.begin(), of.second_moment.begin() + static_cast<int>(count)),
                    1e-300);
  };
  const double scale = 1.0 / least(tally);
  const double scale_everywhere = kTrusted / static_cast<double>(tally.found) / least(everywhere);
  std::size_t best = 0;
  double best_score = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < count; ++i) {
    const double score = scale * tally.second_moment[i] + scale_everywhere * everywhere.second_moment[i];
    if (score < best_score) best = i, best_score = score;
  }
  return kMixes[best];
}

/// The next guide while it is made.
struct GuideLearner::Growth {
  Guide guide;
  std::size_t most_quads = 0;
};

Guide GuideLearner::next() const {
  constexpr std::size_t kMostQuads = 1U << 20;
  Growth growth{Guide(guide_.bounds_), kMostQuads};
  growth.guide.is_learned_ = true;
  growth.guide.regions_.clear();
  growth.guide.quads_.clear();
  // Cells are copied in the order of the old tree; what has seen enough is divided.
  struct Item {
    std::uint32_t to, from;
    Box3 box;
  };
  std::vector<Item> stack{{0, 0, guide_.bounds_}};
  while (!stack.empty()) {
    const Item item = stack.back();
    stack.pop_back();
    const Guide::Cell from = guide_.cells_[item.from];
    if (from.axis < 0) {
      divide_space(growth, item.to, item.box, from.first, tallies_[from.first].count);
      continue;
    }
    const auto first = static_cast<std::uint32_t>(growth.guide.cells_.size());
    growth.guide.cells_[item.to] = {from.axis, first};
    growth.guide.cells_.resize(first + 2);
    const int axis = from.axis;
    const float middle = 0.5f * (item.box.lower[axis] + item.box.upper[axis]);
    Box3 lower = item.box, upper = item.box;
    lower.upper[axis] = upper.lower[axis] = middle;
    stack.push_back({first, from.first, lower});
    stack.push_back({first + 1, from.first + 1, upper});
  }
  return std::move(growth.guide);
}

/// Halves a cell until each part may expect few enough of the records.
void GuideLearner::divide_space(Growth& growth, std::uint32_t cell, const Box3& box, std::uint32_t region,
                                double count) const {
  constexpr double kMostRecords = 3000.0;
  constexpr std::size_t kMostRegions = 1U << 14;
  if (count <= kMostRecords || growth.guide.regions_.size() >= kMostRegions) {
    add_region(growth, cell, region);
    return;
  }
  const int axis = longest_axis(box);
  const auto first = static_cast<std::uint32_t>(growth.guide.cells_.size());
  growth.guide.cells_[cell] = {static_cast<std::int8_t>(axis), first};
  growth.guide.cells_.resize(first + 2);
  const float middle = 0.5f * (box.lower[axis] + box.upper[axis]);
  Box3 lower = box, upper = box;
  lower.upper[axis] = upper.lower[axis] = middle;
  divide_space(growth, first, lower, region, 0.5 * count);
  divide_space(growth, first + 1, upper, region, 0.5 * count);
}

GuideLearner::Found GuideLearner::found_in(std::uint32_t quad, std::size_t quarter) const {
  const std::uint32_t child = guide_.quads_[quad].children[quarter];
  if (child == 0) return found_[quad][quarter];
  Found sum;
  for (std::size_t q = 0; q < 4; ++q) {
    const Found part = found_in(child, q);
    sum.light += part.light;
    sum.paths += part.paths;
  }
  return sum;
}

/// A quad of the new guide with this found in its quarters, divided further where it is bright and enough paths say so:
/// else the guide would look only where a few happened to find something. `quad` is the old one at this place, or none.
std::uint32_t GuideLearner::grow_quads(Growth& growth, std::uint32_t quad, const std::array<Found, 4>& found,
                                       double total, int depth) const {
  constexpr double kBright = 0.01;     // of all light in the region; Müller et al. 2017, §3.2
  constexpr double kFewestPaths = 24;  // six for each quarter
  constexpr int kDeepest = 14;
  std::vector<Guide::Quad>& quads = growth.guide.quads_;
  const auto index = static_cast<std::uint32_t>(quads.size());
  quads.emplace_back();
  const double sum = found[0].light + found[1].light + found[2].light + found[3].light;
  for (std::size_t q = 0; q < 4; ++q) {
    if (sum > 0.0) quads[index].shares[q] = static_cast<float>(found[q].light / sum);
    const bool is_bright = found[q].light > kBright * total && found[q].paths > kFewestPaths;
    if (!is_bright || depth >= kDeepest || quads.size() >= growth.most_quads) continue;
    const std::uint32_t old = quad == kNoQuad ? 0 : guide_.quads_[quad].children[q];
    std::array<Found, 4> inside;
    inside.fill({0.25 * found[q].light, 0.25 * found[q].paths});
    for (std::size_t k = 0; k < 4 && old != 0; ++k) inside[k] = found_in(old, k);
    const std::uint32_t child = grow_quads(growth, old != 0 ? old : kNoQuad, inside, total, depth + 1);
    quads[index].children[q] = child;
  }
  return index;
}

void GuideLearner::add_region(Growth& growth, std::uint32_t cell, std::uint32_t region) const {
  const std::uint32_t root = guide_.regions_[region].root;
  std::array<Found, 4> found;
  for (std::size_t q = 0; q < 4; ++q) found[q] = found_in(root, q);
  const double total = found[0].light + found[1].light + found[2].light + found[3].light;
  Guide::Region made;
  made.root = grow_quads(growth, root, found, total, 0);
  for (std::size_t kind = 0; kind < kGuidedKinds && total > 0.0; ++kind) {
    made.mixes[kind] = best_mix(tallies_[region].kinds[kind], everywhere_[kind]);
  }
  growth.guide.cells_[cell] = {-1, static_cast<std::uint32_t>(growth.guide.regions_.size())};
  growth.guide.regions_.push_back(made);
}

}  // namespace candela::path
