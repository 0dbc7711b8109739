#include "parity/domains.h"

#include <fnmatch.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>

#include "base/error.h"
#include "shade/light_choice.glsl.h"
#include "shade/surface_params.glsl.h"
#include "shade/thin_film.glsl.h"
#include "support/random.h"

namespace candela::parity {
namespace {

using test::Pcg32;

/// Fills the floats of one value of a basic type.
using Domain = std::function<void(Pcg32& random, float* x, int size)>;

/// One float in 64 is the lower end and one the upper: formulas break at their ends first.
float between(Pcg32& random, float low, float high) {
  const float end = random.next_float() * 64.0f;
  const float u = random.next_float();
  if (end < 1.0f) return low;
  if (end < 2.0f) return high;
  return std::min(low + (high - low) * u, high);
}

Domain uniform(float low, float high) {
  return [=](Pcg32& random, float* x, int size) {
    for (int i = 0; i < size; ++i) x[i] = between(random, low, high);
  };
}

/// All magnitudes between two positive ends alike.
Domain magnitude(float low, float high) {
  return [=](Pcg32& random, float* x, int size) {
    for (int i = 0; i < size; ++i) x[i] = std::exp(between(random, std::log(low), std::log(high)));
  };
}

/// One of the numbers first … last.
Domain whole(int first, int last) {
  return [=](Pcg32& random, float* x, int size) {
    for (int i = 0; i < size; ++i) {
      x[i] =
          std::min(std::floor(static_cast<float>(first) + static_cast<float>(last - first + 1) * random.next_float()),
                   static_cast<float>(last));
    }
  };
}

/// A unit vector whose z is uniform between two ends. x and y are independent of the frame.
Domain direction(float low, float high) {
  return [=](Pcg32& random, float* x, int size) {
    if (size != 3) throw Error("a direction has three components");
    const float z = between(random, low, high);
    const float r = std::sqrt(std::max(0.0f, 1.0f - z * z));
    const float phi = 6.2831853f * random.next_float();
    x[0] = r * std::cos(phi);
    x[1] = r * std::sin(phi);
    x[2] = z;
  };
}

/// `value` for a quarter of the inputs, else like `rest`: materials have features that are off.
Domain often(float value, const Domain& rest) {
  return [=](Pcg32& random, float* x, int size) {
    if (random.next_float() < 0.25f) {
      std::fill_n(x, size, value);
    } else {
      rest(random, x, size);
    }
  };
}

/// The frame's normal for half of the inputs.
Domain often_up(const Domain& rest) {
  return [=](Pcg32& random, float* x, int size) {
    rest(random, x, size);
    if (random.next_float() < 0.5f) {
      x[0] = x[1] = 0.0f;
      x[2] = 1.0f;
    }
  };
}

/// A set of lobes: each bit of kLobe… by chance, those of `always` always.
Domain lobes(int always = 0, int possible = 2 * shade::kLobeCoatAnisotropy - 1) {
  return [=](Pcg32& random, float* x, int) {
    // Every sixteenth has none, as most materials.
    const bool none = random.next_float() < 1.0f / 16.0f;
    const auto chosen = static_cast<int>(random.next() & static_cast<std::uint32_t>(possible));
    *x = static_cast<float>((none ? 0 : chosen) | always);
  };
}

/// Split-sum terms (A, B): both at least 0, together at most 1.
Domain split_sum() {
  return [](Pcg32& random, float* x, int size) {
    if (size != 2) throw Error("split-sum terms are two");
    x[0] = between(random, 0.0f, 1.0f);
    x[1] = (1.0f - x[0]) * between(random, 0.0f, 1.0f);
  };
}

constexpr float kBelowOne = 0x1.fffffep-1f;

struct Row {
  /// Compared with "function:parameter" (members: "function:parameter.member"), "Struct.member", the bare name and
  /// the bare type, in this order; each may be written "type name" to mean that type alone. * and ? as in a shell.
  /// A pattern with a slash is compared with "function:parameter/maker:parameter", for inputs of what makes a struct.
  std::string pattern;
  Domain domain;
};

/// The first row that matches, more special ones above. A type stands at the end for what no name decides.
const std::vector<Row>& rows() {
  static const std::vector<Row> kRows = {
      // ----- a lobe's own functions, for surfaces that have it
      {"coat_*:s/*p.lobes", lobes(shade::kLobeClearcoat)},
      {"sheen_over_coat*:s/*p.lobes", lobes(shade::kLobeFuzz | shade::kLobeClearcoat)},
      {"sheen_*_on_top:s/*p.lobes", lobes(shade::kLobeFuzz)},
      {"sheen_*:s/*p.lobes", lobes(shade::kLobeSheen)},
      {"edge_*:s/*p.lobes", lobes(shade::kLobeEdgeColor)},
      {"edge_*:s/*p.metallic", uniform(0.1f, 1.0f)},
      {"edge_*:p.lobes", lobes(shade::kLobeEdgeColor)},
      {"fuzz_*:s/*p.lobes", lobes(shade::kLobeClearcoat)},
      {"glass_*:s/*p.lobes", lobes(shade::kLobeTransmission)},
      {"below_*:s/*p.lobes", lobes(shade::kLobeDiffuseTransmission)},
      {"below_*:at/*p.lobes", lobes(shade::kLobeClearcoat)},
      {"rough_diffuse_*:s/*p.lobes", lobes(shade::kLobeDiffuseRoughness)},
      {"rough_diffuse_*:s/*p.diffuse_roughness", uniform(0.1f, 1.0f)},
      {"retro_*:s/*p.lobes", lobes(shade::kLobeRetroreflection)},
      {"model_sheen:s/*p.lobes", lobes(shade::kLobeModel | shade::kLobeSheen)},
      {"coat_tint:s/*p.clearcoat_darkening", uniform(0.1f, 1.0f)},
      {"coat_direction:s/*p.clearcoat_roughness", uniform(0.1f, 1.0f)},  // a mirror has no facets to ask for
      {"coat_dv:s/*p.clearcoat_roughness", uniform(0.1f, 1.0f)},
      {"coat_*_visible:s/*p.clearcoat_roughness", uniform(0.1f, 1.0f)},
      {"glass_add_below:s/*p.roughness", uniform(0.05f, 1.0f)},
      {"sheen_scale:s/*p.sheen_roughness", uniform(0.0f, 0.2f)},  // narrow fibres, seen flatly: elsewhere it is 1
      {"sheen_scale:mu", uniform(0.0f, 0.1f)},
      {"retro_facets:s/*p.roughness", uniform(0.05f, 1.0f)},
      {"anisotropy_*:s/*p.lobes", lobes(shade::kLobeModel)},
      {"iridescence_*:s/*p.lobes", lobes(shade::kLobeIridescence)},
      {"iridescence_*:s/*p.iridescence", uniform(0.1f, 1.0f)},
      {"iridescence_*:s/*p.film_nm", uniform(50.0f, 1200.0f)},
      {"iridescence_*:s/*p.metallic", uniform(0.0f, 0.9f)},
      {"surface_straight:s/*p.lobes", lobes(shade::kLobeTransmission)},
      {"layers_eval_below:s/*p.lobes", lobes(shade::kLobeTransmission)},
      {"terms_film*:s/*p.lobes", lobes(shade::kLobeIridescence)},
      {"layers_scatters_through:s/*p.lobes", lobes(shade::kLobeTransmission)},
      {"terms_diffuse_shape:s/*p.lobes", lobes(shade::kLobeModel)},
      {"glass_*:s/*p.metallic", uniform(0.0f, 0.9f)},
      {"glass_*:s/*p.scatter", uniform(0.0f, 0.9f)},
      {"glass_*:s/*p.transmission", uniform(0.05f, 1.0f)},
      {"terms_*:s/*p.lobes", lobes(shade::kLobeModel)},
      {"terms_dv:s/*p.roughness", uniform(0.05f, 1.0f)},  // a mirror has no facets to ask for
      {"terms_*visible:s/*p.roughness", uniform(0.05f, 1.0f)},
      {"*_is_delta:s/*p.lobes", lobes(0, shade::kLobeConductor | shade::kLobeTransmission | shade::kLobeClearcoat)},
      {"*_is_delta:s/*p.*roughness", often(0.0f, often(0.0f, often(0.0f, uniform(0.0f, 1.0f))))},
      {"*_is_delta:s/*p.metallic", often(1.0f, often(1.0f, uniform(0.0f, 1.0f)))},
      {"layers_*:s/*p.lobes", lobes(shade::kLobeModel)},
      {"model_*:s/*p.lobes", lobes(shade::kLobeModel)},
      {"layers_*:at/*p.lobes", lobes(shade::kLobeClearcoat)},
      {"base_*:s/*p.lobes", often(0.0f, lobes())},

      // ----- tables: cells that lie inside them
      {"table_over*/*:count", whole(2, shade::kTableLayers)},
      {"table_anisotropic*/*:count", whole(2, shade::kTableAzimuths)},
      {"*/table_cell*:count", whole(2, shade::kTableMu)},
      {"table_cell*:count", whole(2, shade::kTableMu)},
      {"table_over*:at", whole(shade::kTableCoatOver, shade::kTableSheenOver)},
      {"table_anisotropic*:at",
       whole(shade::kTableAnisotropic,
             shade::kTableAnisotropic + shade::kTableAnisotropicSlice - 2 * shade::kTableWidths)},
      {"table_film*:i", whole(0, shade::kFilmCosines - 1)},
      {"table_bilinear:width", whole(2, shade::kTableMu)},
      {"table_*:at", whole(0, shade::kTableSize - 2 * shade::kTableMu * shade::kTableMu)},
      {"table_cosine_entry:entry", whole(shade::kTableCosine, shade::kTableSize - 4)},
      {"table_*:entry", whole(0, shade::kTableSize - 3)},
      {"wavelength_lobe:i", whole(0, 4)},

      // ----- one function
      {"fresnel_rise:eta", uniform(1.0f, 2.5f)},
      {"fresnel_rise:scale", uniform(1.0f, 1.25f)},
      {"fresnel_rise_scale:eta", uniform(1.0f, 2.5f)},
      {"table_curve*:eta", uniform(1.0f, 6.0f)},
      {"area_*:[abcd]", uniform(-2.0f, 2.0f)},
      {"*refract*:wi", direction(-1.0f, -0.02f)},
      {"surface_*:wi", direction(-0.3f, 1.0f)},  // a quarter of them below the surface
      {"base_eval:wi", direction(-0.3f, 1.0f)},
      {"layers_eval:wi", direction(-1.0f, 1.0f)},
      {"layers_eval_below:wi", direction(-1.0f, -0.02f)},
      {"glass_add_below:wi", direction(-1.0f, -0.02f)},
      {"below_eval:wi", direction(-1.0f, -0.02f)},
      {"layers_at:w", direction(-1.0f, 1.0f)},
      {"coat_*:w", direction(-1.0f, 1.0f)},
      {"coat_*:[oi]", direction(0.02f, 1.0f)},
      {"shade_tangent:n", direction(-1.0f, 1.0f)},
      {"image_light_horizon:mirrored", direction(-1.0f, 1.0f)},
      {"image_light_level:levels", whole(2, 8)},
      {"image_light_lookup:mirrored", direction(-1.0f, 1.0f)},
      {"film_*:c", whole(0, 2)},
      {"film_*:opd", uniform(0.0f, 4.0f)},  // µm
      {"film_gaussian:i", whole(0, shade::kFilmGaussians - 1)},
      {"film_*:nu", uniform(1.5f, 2.5f)},  // 1/µm
      {"film_*:sigma", uniform(0.04f, 0.11f)},
      {"film_*:eta2", uniform(0.2f, 6.0f)},
      {"film_boundary_*:g", uniform(0.1f, 2.0f)},
      {"thin_film_*:eta1", often(1.0f, uniform(1.0f, 1.5f))},
      {"thin_film_*:eta2", uniform(1.1f, 2.0f)},
      {"*_conductor*:n", uniform(0.1f, 4.0f)},
      {"*film*:k", often(0.0f, uniform(0.0f, 8.0f))},
      {"wavelength_logistic:x", uniform(-20.0f, 20.0f)},
      {"units_*:efficacy", magnitude(1.0f, 683.0f)},
      {"units_*:albedo", uniform(0.05f, 1.0f)},
      {"sky_*:mu", uniform(-1.0f, 1.0f)},
      {"sky_sun_visibility:mu_sun", uniform(-0.06f, 0.01f)},  // about the horizon, where the disc is cut
      {"sky_sun_visibility:r", uniform(6360.001f, 6366.0f)},
      {"sky_*:r", uniform(6360.001f, 6419.9f)},
      {"sky_*:t", uniform(0.0f, 800.0f)},
      {"sky_*:cos_*", uniform(-1.0f, 1.0f)},
      {"sky_*:transmittance", uniform(0.0f, 1.0f)},
      {"sky_*:extinction", magnitude(1e-3f, 1.0f)},
      {"sky_*:source", magnitude(1e-3f, 1.0f)},
      {"srgb_*:linear", uniform(0.0f, 1.0f)},
      {"srgb_*:code", uniform(0.0f, 1.0f)},
      {"tone_*:curve", whole(0, 7)},  // one more than there are
      {"tone_hable_curve:x", magnitude(1e-3f, 1e3f)},
      {"tone_agx_contrast:x", uniform(0.0f, 1.0f)},
      {"tone_*:color", magnitude(1e-4f, 1e3f)},

      {"footprint_*:t", uniform(-3.0f, 3.0f)},
      {"footprint_*:wrap", whole(0, 2)},
      {"footprint_texel:i", whole(-1, 8)},
      {"footprint_texel:size", whole(8, 8)},
      {"footprint_*:size", whole(1, 64)},
      {"panorama_angle:[xy]", uniform(-1.0f, 1.0f)},
      {"panorama_*:sin_theta", uniform(1e-3f, 1.0f)},
      {"medium_transmittance:extinction", magnitude(1e-3f, 1e1f)},
      {"medium_transmittance:distance", magnitude(1e-3f, 1e1f)},
      {"medium_*:extinction", magnitude(1e-2f, 1e2f)},
      {"phase_*:g", often(0.0f, uniform(-0.95f, 0.95f))},

      {"light_*:side", whole(0, 2)},
      {"light_*:cosine", uniform(-1.0f, 1.0f)},
      {"light_*:cos_axis", uniform(-1.0f, 1.0f)},
      {"light_mean_height:height", uniform(-2.0f, 2.0f)},
      {"light_cut_*:place", whole(0, shade::kLightCut - 1)},
      {"light_stratum:samples", whole(1, 4)},
      {"light_place:i", whole(0, 3)},
      {"light_sun_facing:sin2_radius", magnitude(1e-6f, 1e-2f)},
      {"light_*:solid_angle", magnitude(1e-6f, 1e1f)},
      {"mis_weight:[ab]", magnitude(1e-3f, 1e3f)},
      {"mis_weight:power", often(1.0f, whole(2, 2))},
      {"LightReceiver.position", uniform(-2.0f, 2.0f)},
      {"LightReceiver.normal", direction(-1.0f, 1.0f)},
      {"LightReceiver.side", whole(0, 2)},
      {"LightNode.center", uniform(-2.0f, 2.0f)},
      {"LightNode.radius", often(0.0f, magnitude(1e-3f, 2.0f))},
      {"LightNode.axis", direction(-1.0f, 1.0f)},
      {"LightNode.cos_*", uniform(-1.0f, 1.0f)},
      {"LightNode.strength", magnitude(1e-3f, 1e3f)},
      {"LightNode.range", often(3.4e38f, magnitude(1e-1f, 1e2f))},
      {"LightEstimate.importance", often(0.0f, magnitude(1e-3f, 1e3f))},
      {"LightCut.size", whole(1, shade::kLightCut - 1)},
      {"LightCut.errors", often(0.0f, whole(0, 1 << 23))},
      {"PunctualLamp.kind", whole(0, 1)},
      {"PunctualLamp.falloff", whole(0, 3)},
      {"PunctualLamp.direction", direction(-1.0f, 1.0f)},

      // ----- members
      {"ShadingModel.distribution", whole(0, 3)},
      {"ShadingModel.masking", whole(0, 5)},
      {"ShadingModel.fresnel", whole(0, 3)},
      {"ShadingModel.diffuse", whole(0, 3)},
      {"ShadingModel.blend", whole(0, 4)},
      {"SurfaceParams.lobes", lobes()},
      {"SurfaceParams.ior", often(0.0f, uniform(1.0f, 2.5f))},
      {"SurfaceParams.film_ior", uniform(1.1f, 2.0f)},
      {"SurfaceParams.film_nm", uniform(50.0f, 800.0f)},
      {"SurfaceParams.conductor_n", uniform(0.1f, 4.0f)},
      {"SurfaceParams.conductor_k", uniform(0.1f, 8.0f)},
      {"SurfaceParams.anisotropy", often(0.0f, uniform(0.0f, 1.0f))},
      {"SurfaceParams.transmission", often(1.0f, uniform(0.0f, 1.0f))},
      {"SurfaceParams.clearcoat_ior", often(1.5f, uniform(1.0f, 2.5f))},
      {"SurfaceParams.clearcoat_color", often(1.0f, uniform(0.1f, 1.0f))},
      {"SurfaceParams.clearcoat_darkening", often(0.0f, uniform(0.0f, 1.0f))},
      {"SurfaceParams.clearcoat_anisotropy", often(0.0f, uniform(0.0f, 1.0f))},
      {"SurfaceParams.clearcoat_direction", direction(-0.5f, 0.5f)},
      {"SurfaceParams.retroreflection", uniform(0.0f, 1.0f)},
      {"SurfaceParams.eta", magnitude(0.4f, 2.5f)},
      {"SurfaceParams.clearcoat_normal", often_up(direction(0.3f, 1.0f))},

      // ----- names that mean the same everywhere
      {"vec3 wo", direction(0.02f, 1.0f)},
      {"vec3 wi", direction(0.02f, 1.0f)},
      {"vec3 w", direction(0.02f, 1.0f)},
      {"vec3 wm", direction(0.02f, 1.0f)},
      {"vec3 wh", direction(0.02f, 1.0f)},
      {"vec3 n", direction(0.02f, 1.0f)},
      {"vec3 normal", direction(0.02f, 1.0f)},
      {"vec3 *direction", direction(-1.0f, 1.0f)},
      {"cos_angle", uniform(-1.0f, 1.0f)},
      {"cos_inner", uniform(0.8f, 1.0f)},
      {"cos_outer", uniform(0.3f, 0.79f)},
      {"cos_*", uniform(0.02f, 1.0f)},
      {"[uv]", uniform(0.0f, kBelowOne)},
      {"u_side", uniform(0.0f, kBelowOne)},
      {"vec2 ab", split_sum()},
      {"vec2 mean", split_sum()},
      {"uv", uniform(0.0f, kBelowOne)},
      {"*roughness*", often(0.0f, uniform(0.03f, 1.0f))},
      {"*alpha*", uniform(0.03f, 1.0f)},
      {"a[xy]", uniform(0.03f, 1.0f)},
      {"*anisotropy*", uniform(-0.9f, 0.9f)},
      {"metallic", often(1.0f, often(0.0f, uniform(0.0f, 1.0f)))},
      {"*rotation*", uniform(0.0f, 6.2831853f)},
      {"eta", uniform(0.4f, 2.5f)},
      {"*ior*", uniform(1.0f, 2.5f)},
      {"n", uniform(0.1f, 4.0f)},  // complex index of a metal, n + ik
      {"k", uniform(0.1f, 8.0f)},
      {"abbe*", uniform(20.0f, 90.0f)},
      {"dispersion", often(0.0f, uniform(0.0f, 1.0f))},
      {"*thickness*_nm", often(0.0f, uniform(0.0f, 1000.0f))},
      {"*wavelength*_um", uniform(0.38f, 0.78f)},
      {"*wavelength*", uniform(380.0f, 780.0f)},
      {"lambda*", uniform(380.0f, 780.0f)},
      {"*_nm", uniform(380.0f, 780.0f)},
      {"*temperature*", uniform(1000.0f, 12000.0f)},
      {"*kelvin*", uniform(1000.0f, 12000.0f)},
      {"*distance*", magnitude(1e-2f, 1e3f)},
      {"*range*", magnitude(1e-1f, 1e3f)},
      {"altitude", uniform(0.0f, 60.0f)},
      {"*shininess*", magnitude(1.0f, 1e3f)},
      {"glossiness", often(1.0f, uniform(0.0f, 1.0f))},
      {"*_deg", uniform(0.0f, 360.0f)},
      {"ev100", uniform(-4.0f, 16.0f)},
      {"area", magnitude(1e-4f, 1e2f)},
      {"lumens", magnitude(1e-1f, 1e4f)},
      {"candela", magnitude(1e-1f, 1e4f)},
      {"lux", magnitude(1e-1f, 1e5f)},
      {"nit", magnitude(1e-1f, 1e5f)},
      {"*_cd", magnitude(1e-1f, 1e4f)},
      {"*_lm", magnitude(1e-1f, 1e4f)},
      {"*_lux", magnitude(1e-1f, 1e5f)},

      // ----- types
      {"bool", whole(0, 1)},
      {"int", whole(0, 7)},
      {"*", uniform(0.0f, 1.0f)},
  };
  return kRows;
}

struct Maker {
  std::string pattern;                 ///< of a type, or as in Row
  std::vector<std::string> functions;  ///< one of them, by chance, makes a value of the type
};

/// Structs whose members depend on each other are what a function of src/shade returns for random inputs of its own,
/// computed in C++, so that both languages start from the same bits. "" draws member by member, as for other structs.
const std::vector<Maker>& makers() {
  static const std::vector<Maker> kMakers = {
      {"ShadingModel",
       {"", "shading_model_candela", "shading_model_gltf", "shading_model_ue4", "shading_model_learnopengl",
        "shading_model_thesis", "shading_model_blinn_phong"}},
      {"SkyMedium", {"sky_medium"}},
      {"Surface", {"surface_prepare"}},
      {"LayersAt", {"layers_at"}},
      {"TableCell table_ggx*:roughness", {"table_ggx_roughness"}},
      {"TableCell curve", {"table_curve", "table_curve_schlick"}},
      {"TableCell", {"table_cell", "table_cell_mu"}},
      {"FilmFringes", {"film_fringes"}},
      {"FilmGaussian", {"film_gaussian_of"}},
      {"FilmBoundary", {"film_boundary_s", "film_boundary_p"}},
      {"WavelengthLobe", {"wavelength_lobe"}},
  };
  return kMakers;
}

bool matches(const std::string& pattern, const Value& value, const std::string& path) {
  const bool is_long = pattern.find('/') != std::string::npos;
  const std::string inner = path.substr(path.rfind('/') + 1);
  const std::array<std::string, 3> names = {is_long ? path : inner, value.owner + "." + value.name, value.name};
  const bool found = std::any_of(names.begin(), names.end(), [&](const std::string& name) {
    return fnmatch(pattern.c_str(), name.c_str(), 0) == 0 ||
           fnmatch(pattern.c_str(), (value.type + " " + name).c_str(), 0) == 0;
  });
  return found || pattern == value.type;
}

/// Fills the inputs of a function, x being the first of all of them.
using Plan = std::function<void(Pcg32& random, float* x)>;

Plan plan_of_values(const std::vector<Value>& values, const std::string& prefix);

/// A struct that some function makes.
Plan plan_of_maker(const Maker& maker, const Value& value, const std::string& path) {
  std::vector<Plan> plans;
  for (const std::string& name : maker.functions) {
    if (name.empty()) {
      plans.push_back(plan_of_values(value.members, path + "."));
      continue;
    }
    const Function* function = find_function(name);
    if (function == nullptr || function->output.type != value.type) {
      throw Error(name + " does not make a " + value.type, "tests/parity/domains.cpp");
    }
    const Plan inner = plan_of_values(function->inputs, path + "/" + function->name + ":");
    plans.emplace_back([function, inner, offset = value.offset](Pcg32& random, float* x) {
      std::vector<float> inputs(static_cast<std::size_t>(function->input_size));
      inner(random, inputs.data());
      function->call(inputs.data(), x + offset);
    });
  }
  return [plans](Pcg32& random, float* x) { plans[random.next() % plans.size()](random, x); };
}

Plan plan_of_value(const Value& value, const std::string& path) {
  const auto& known = makers();
  const auto maker =
      std::find_if(known.begin(), known.end(), [&](const Maker& m) { return matches(m.pattern, value, path); });
  if (maker != known.end()) return plan_of_maker(*maker, value, path);
  if (!value.members.empty()) return plan_of_values(value.members, path + ".");

  const auto& table = rows();
  const auto row =
      std::find_if(table.begin(), table.end(), [&](const Row& r) { return matches(r.pattern, value, path); });
  if (row == table.end()) throw Error("has no domain in tests/parity/domains.cpp", path);
  return [row, type = value.type, offset = value.offset, size = value.size](Pcg32& random, float* x) {
    row->domain(random, x + offset, size);
    // Whatever the row says, an int and a bool stay what they are.
    if (type == "int") x[offset] = std::floor(x[offset]);
    if (type == "bool") x[offset] = x[offset] >= 0.5f ? 1.0f : 0.0f;
  };
}

Plan plan_of_values(const std::vector<Value>& values, const std::string& prefix) {
  std::vector<Plan> plans;
  plans.reserve(values.size());
  for (const Value& value : values) plans.push_back(plan_of_value(value, prefix + value.name));
  return [plans](Pcg32& random, float* x) {
    for (const Plan& plan : plans) plan(random, x);
  };
}

/// FNV-1a: a seed that stays when other functions come and go.
std::uint64_t seed_of(const std::string& name) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char letter : name) hash = (hash ^ static_cast<unsigned char>(letter)) * 0x100000001b3U;
  return hash;
}

}  // namespace

std::vector<float> draw_inputs(const Function& function, int count) {
  const auto size = static_cast<std::size_t>(function.input_size);
  std::vector<float> inputs(size * static_cast<std::size_t>(count));
  Pcg32 random(seed_of(function.name));
  const Plan plan = plan_of_values(function.inputs, function.name + ":");
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) plan(random, inputs.data() + i * size);
  return inputs;
}

}  // namespace candela::parity
