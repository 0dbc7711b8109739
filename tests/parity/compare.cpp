#include "parity/compare.h"

#include <fnmatch.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <sstream>

namespace candela::parity {
namespace {

struct Row {
  std::string pattern;  ///< of function names, * and ? as in a shell
  Limits limits;
};

/// Measured on llvmpipe (Mesa 22.3); every row has its reason.
const std::vector<Row>& rows() {
  static const std::vector<Row> kRows = {
      // A small difference of squared lengths of the planet's size, which have steps of 4 km².
      {"sky_distance_to_top", {.floor = 100.0}},
      // e^-depth: a depth of 10 and more has too few digits left behind the point.
      {"sky_transmittance_to_top", {.floor = 1e-2}},
      // A difference of cosines over the sun's 0.005 rad, and r / R next to 1 in a square root.
      {"sky_sun_visibility", {.relative = 1e-3, .floor = 0.1}},
      // 1 - e^-x of a small x.
      {"tone_exponential", {.floor = 1e-2}},
      {"tone_map", {.floor = 1e-2}},
      // The tails of the lobes: u next to 1 leaves few digits of what is above it.
      {"wavelength_sample", {.relative = 3e-4}},
      // acos, of which Mesa computes four digits.
      {"eon_rise", {.relative = 1e-3, .floor = 0.1}},
      {"eon_f", {.relative = 1e-3}},
      {"rough_diffuse_gain", {.relative = 1e-3}},
      // 1 less an albedo, which is next to 1 where a boundary is smooth.
      {"glass_escape_mean", {.floor = 1e-2}},
      {"coat_escape", {.floor = 1e-2}},
      // The same: near the normal almost all goes through.
      {"fresnel_rise", {.floor = 1e-2}},
      {"base_rise", {.floor = 1e-2}},
      // And of an index next to 1, where nothing is reflected.
      {"terms_fresnel_dielectric", {.floor = 1e-2}},
      // Sums over facets of width 0.001, whose lobe has one or two digits of its direction.
      {"model_specular", {.outliers = 1.5e-2}},
      // A share of one. Of narrow Blinn lobes the points of the sum, which are GGX's, see tails of 1e-5 alone. Where
      // such
      // a sum is a part of it, its narrowest lobes are as above.
      {"layers_shares", {.floor = 1e-2, .outliers = 5e-3}},
      {"surface_shares", {.floor = 1e-2, .outliers = 5e-3}},
      // Edges that cancel: what is left of terms of up to π, over 2 π.
      {"area_share", {.floor = 3e-2}},
      {"area_edge*", {.floor = 1e-2}},
      // A distance between colours that are nearly the same.
      {"workflow_residual", {.floor = 1e-2}},
      // u.y next to 1 leaves almost nothing of the half vector to normalise.
      {"ggx_sample_*", {.outliers = 3e-3}},
      {"coat_direction", {.outliers = 6e-3}},
      {"coat_sample_visible", {.outliers = 6e-3}},
      // The same, and facets of width 0.001: the weight of so narrow a lobe has one or two digits of its direction.
      {"surface_sample", {.outliers = 1e-2}},
      {"layers_sample", {.outliers = 1e-2}},
  };
  return kRows;
}

/// Members that have fewer digits than the others, wherever they stand: how many times as far apart they may be.
struct MemberRow {
  std::string pattern;  ///< of "Struct.member"
  double slack;
};

const std::vector<MemberRow>& member_rows() {
  static const std::vector<MemberRow> kRows = {
      // A share over what single scattering loses: 1 less an albedo, which leaves smooth surfaces two digits.
      {"Surface.*multi*", 100.0},
      // And that itself.
      {"Surface.glass_reflected", 100.0},  // a ratio of such
      {"Surface.*escape*", 100.0},
      {"Surface.single_albedo_o", 100.0},
      {"Surface.specular_albedo_o", 100.0},  // which it is a part of, of dark boundaries the larger
      // What is left of a position among tens of entries.
      {"TableCell.t", 30.0},
      // What is left of two reflectances that are nearly the same.
      {"Surface.film_beyond", 100.0},
  };
  return kRows;
}

double slack_of(const Value& leaf) {
  const std::string name = leaf.owner + "." + leaf.name;
  for (const MemberRow& row : member_rows()) {
    if (fnmatch(row.pattern.c_str(), name.c_str(), 0) == 0) return row.slack;
  }
  return 1.0;
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// No domain is meant to ask for infinity, or for what comes of kAbsent.
bool is_ordinary(float x) { return std::abs(x) < 1e30f; }

/// Infinite where a discrete value differs, or where anything is out of bounds. Absent is equal to absent.
double error_of_leaf(const Value& leaf, double floor, const float* a, const float* b) {
  double scale = floor;
  double difference = 0.0;
  for (int i = leaf.offset; i < leaf.offset + leaf.size; ++i) {
    if (a[i] == kAbsent && b[i] == kAbsent) continue;
    if (!is_ordinary(a[i]) || !is_ordinary(b[i])) return kInfinity;
    scale = std::max({scale, std::abs(static_cast<double>(a[i])), std::abs(static_cast<double>(b[i]))});
    difference = std::max(difference, std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i])));
  }
  const bool discrete = leaf.type == "bool" || leaf.type == "int";
  if (discrete) return difference == 0.0 ? 0.0 : kInfinity;
  return difference / (scale * slack_of(leaf));
}

std::string listing(const std::vector<Value>& values, const float* x) {
  std::ostringstream text;
  text.precision(9);
  for (const Value& value : values) {
    for (const Value& leaf : leaves(value)) {
      text << " " << (leaf.name.empty() ? leaf.type : leaf.name) << " (";
      for (int i = 0; i < leaf.size; ++i) text << (i == 0 ? "" : ", ") << x[leaf.offset + i];
      text << ")";
    }
  }
  return text.str();
}

}  // namespace

Limits limits_of(const std::string& function) {
  for (const Row& row : rows()) {
    if (fnmatch(row.pattern.c_str(), function.c_str(), 0) == 0) return row.limits;
  }
  return {};
}

Comparison compare(const Function& function, const Limits& limits, const std::vector<float>& inputs,
                   const std::vector<float>& cpp, const std::vector<float>& glsl) {
  const auto stride = static_cast<std::size_t>(function.output.size);
  const std::size_t count = cpp.size() / stride;
  const std::vector<Value> parts = leaves(function.output);

  std::vector<double> errors(count);
  for (std::size_t i = 0; i < count; ++i) {
    for (const Value& leaf : parts) {
      errors[i] = std::max(errors[i], error_of_leaf(leaf, limits.floor, &cpp[i * stride], &glsl[i * stride]));
    }
  }
  const auto furthest = static_cast<std::size_t>(std::max_element(errors.begin(), errors.end()) - errors.begin());
  const auto part = std::find_if(parts.begin(), parts.end(), [&](const Value& leaf) {
    return error_of_leaf(leaf, limits.floor, &cpp[furthest * stride], &glsl[furthest * stride]) >= errors[furthest];
  });

  Comparison result;
  result.inputs = static_cast<int>(count);
  for (const double error : errors) {
    if (error > limits.relative) {
      ++result.outliers;
    } else {
      result.worst = std::max(result.worst, error);
    }
  }
  result.holds = result.outliers <= limits.outliers * static_cast<double>(count);
  std::ostringstream evidence;
  evidence << result.outliers << " of " << count << " inputs differ by more than " << limits.relative
           << "; the furthest, " << errors[furthest] << " in " << (part->name.empty() ? part->type : part->name)
           << ":\n  inputs"
           << listing(function.inputs, inputs.data() + furthest * static_cast<std::size_t>(function.input_size))
           << "\n  C++ " << listing({function.output}, &cpp[furthest * stride]) << "\n  GLSL"
           << listing({function.output}, &glsl[furthest * stride]);
  result.evidence = evidence.str();
  std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(count / 2), errors.end());
  result.typical = errors[count / 2];
  return result;
}

}  // namespace candela::parity
