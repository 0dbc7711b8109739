// The density of sampling is the inverse Jacobian of the map from random numbers to directions, without statistics: of
// a closure of many lobes it is the sum over all random numbers that lead to a direction.

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include "laws/bsdf_laws.h"

namespace candela::laws {

namespace {

constexpr float kEnd = 0x1.fffffep-1f;

bool is_drawn(const SurfaceSample& s) { return s.pdf > 0.0f && !s.is_delta; }

/// Part of u.z that chooses one lobe, whatever u.xy is. Of a glass lobe its lower end reflects and its upper end
/// refracts.
struct Lobe {
  float lower;
  float upper;
};

/// One way to draw a direction: a lobe, and the side it leaves to.
struct Branch {
  Lobe lobe;
  bool is_below;
};

bool same_direction(const SurfaceSample& a, const SurfaceSample& b) {
  return a.is_delta == b.is_delta && glm::length(a.wi - b.wi) < 1e-6f;
}

/// Where u.z begins to give another direction than at `lower`; `same` says so of a u.z.
float bisect(float lower, float upper, const std::function<bool(float)>& same) {
  for (int k = 0; k < 26; ++k) {
    const float middle = 0.5f * (lower + upper);
    (same(middle) ? lower : upper) = middle;
  }
  return upper;
}

std::vector<float> edges_at(const Closure& closure, vec2 u) {
  constexpr int kSteps = 256;
  std::vector<float> edges;
  const auto draw = [&](float z) { return closure.draw(vec3(u.x, u.y, z)); };
  for (int i = 0; i + 1 < kSteps; ++i) {
    const float lower = (static_cast<float>(i) + 0.5f) / kSteps;
    const float upper = lower + 1.0f / kSteps;
    const SurfaceSample first = draw(lower);
    if (same_direction(first, draw(upper))) continue;
    edges.push_back(bisect(lower, upper, [&](float z) { return same_direction(first, draw(z)); }));
  }
  return edges;
}

/// Edges that all random numbers share are those between lobes; others are Fresnel's choice between two sides.
std::vector<Branch> find_branches(const Closure& closure) {
  const std::vector<vec2> probes = {vec2(0.31f, 0.27f), vec2(0.62f, 0.83f), vec2(0.13f, 0.56f)};
  std::vector<float> edges = {0.0f};
  for (const float edge : edges_at(closure, probes[0])) {
    const bool is_shared = std::all_of(probes.begin() + 1, probes.end(), [&](vec2 u) {
      const std::vector<float> others = edges_at(closure, u);
      return std::any_of(others.begin(), others.end(), [&](float x) { return std::abs(x - edge) < 1e-5f; });
    });
    if (is_shared) edges.push_back(edge);
  }
  edges.push_back(1.0f);
  std::vector<Branch> branches;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    for (const bool is_below : {false, true}) branches.push_back({{edges[i], edges[i + 1]}, is_below});
  }
  return branches;
}

std::optional<vec3> direction_of(const Closure& closure, const Branch& branch, vec2 u) {
  const float width = branch.lobe.upper - branch.lobe.lower;
  const float z = branch.is_below ? branch.lobe.upper - 1e-4f * width : branch.lobe.lower + 1e-4f * width;
  const SurfaceSample s = closure.draw(vec3(u.x, u.y, std::min(z, kEnd)));
  if (!is_drawn(s) || (s.wi.z < 0.0f) != branch.is_below) return std::nullopt;
  return s.wi;
}

/// Share of u.z that takes this branch at u.
float chance(const Closure& closure, const Branch& branch, vec2 u) {
  const float width = branch.lobe.upper - branch.lobe.lower;
  const auto side = [&](float t) {
    return closure.draw(vec3(u.x, u.y, std::min(branch.lobe.lower + t * width, kEnd)));
  };
  const SurfaceSample first = side(1e-4f);
  if (same_direction(first, side(1.0f - 1e-4f))) return width;
  const float turn = bisect(1e-4f, 1.0f - 1e-4f, [&](float t) { return same_direction(first, side(t)); });
  return width * (branch.is_below ? 1.0f - turn : turn);
}

/// ∂wi/∂u as the two columns in the plane across wi; none where a neighbour takes another branch.
std::optional<glm::mat2> derivative(const Closure& closure, const Branch& branch, vec2 u, vec3 x, vec3 y) {
  glm::mat2 columns;
  for (int axis = 0; axis < 2; ++axis) {
    constexpr float kStep = 1e-3f;
    vec2 step(0.0f);
    step[axis] = std::min({kStep, 0.5f * u[axis], 0.5f * (1.0f - u[axis])});
    const auto ahead = direction_of(closure, branch, u + step);
    const auto behind = direction_of(closure, branch, u - step);
    if (!ahead || !behind || step[axis] <= 0.0f) return std::nullopt;
    const vec3 d = (*ahead - *behind) / (2.0f * step[axis]);
    columns[axis] = vec2(dot(d, x), dot(d, y));
  }
  return columns;
}

/// The random numbers that lead a branch to `target`, if any do: Newton's method from the nearest points of a grid.
std::optional<vec2> numbers_for(const Closure& closure, const Branch& branch, vec3 target, vec3 x, vec3 y) {
  constexpr int kGrid = 14;
  struct Start {
    float distance;
    vec2 u;
  };
  std::vector<Start> starts;
  for (int row = 0; row < kGrid; ++row) {
    for (int column = 0; column < kGrid; ++column) {
      const vec2 u = (vec2(column, row) + 0.5f) / static_cast<float>(kGrid);
      if (const auto wi = direction_of(closure, branch, u)) starts.push_back({glm::length(*wi - target), u});
    }
  }
  std::sort(starts.begin(), starts.end(), [](const Start& a, const Start& b) { return a.distance < b.distance; });
  starts.resize(std::min<std::size_t>(starts.size(), 6));
  for (const Start& start : starts) {
    vec2 u = start.u;
    for (int k = 0; k < 16; ++k) {
      const auto wi = direction_of(closure, branch, u);
      const auto d = derivative(closure, branch, u, x, y);
      if (!wi || !d || std::abs(glm::determinant(*d)) < 1e-9f) break;
      const vec3 off = target - *wi;
      if (glm::length(off) < 2e-6f) return u;
      vec2 step = glm::inverse(*d) * vec2(dot(off, x), dot(off, y));
      step *= std::min(1.0f, 0.2f / std::max(glm::length(step), 1e-6f));
      u = glm::clamp(u + step, vec2(1e-4f), vec2(1.0f - 1e-4f));
    }
  }
  return std::nullopt;
}

double density(const Closure& closure, const std::vector<Branch>& branches, vec3 target) {
  const vec3 x = shade::shade_tangent(target);
  const vec3 y = glm::cross(target, x);
  double sum = 0.0;
  for (const Branch& branch : branches) {
    if (branch.is_below != (target.z < 0.0f)) continue;
    const auto u = numbers_for(closure, branch, target, x, y);
    if (!u) continue;
    const auto d = derivative(closure, branch, *u, x, y);
    if (d) sum += static_cast<double>(chance(closure, branch, *u) / std::abs(glm::determinant(*d)));
  }
  return sum;
}

}  // namespace

Verdict pdf_is_inverse_jacobian(const Bsdf& bsdf, const Trial& /*trial*/) {
  constexpr int kTargets = 12;
  std::vector<double> errors;
  for (const vec3 wo : view_directions()) {
    const Closure closure = bsdf.seen_from(wo);
    const std::vector<Branch> branches = find_branches(closure);
    for (int i = 0; i < kTargets; ++i) {
      const SurfaceSample s = closure.draw(laws::lattice_point(37 * i + 5));
      // Where a lobe is narrower than the steps of single precision there is no derivative to take.
      if (!is_drawn(s) || std::abs(s.wi.z) < 0.02f || s.pdf > 1e3f) continue;
      const auto pdf = static_cast<double>(closure.eval(s.wi).pdf);
      errors.push_back(std::abs(density(closure, branches, s.wi) / pdf - 1.0));
    }
  }
  if (errors.empty()) return {};
  // The search may miss a root near the rim of the square: a twentieth of the targets may be off, a wrong density is
  // off on all.
  std::sort(errors.begin(), errors.end());
  const double typical = errors[errors.size() / 2];
  const double most = errors[errors.size() * 9 / 10];
  std::ostringstream evidence;
  evidence << errors.size() << " directions, density off by " << typical << " in the middle and " << most
           << " at the ninth tenth";
  return {typical < 0.004 && most < 0.02, evidence.str()};
}

}  // namespace candela::laws
