#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "content/demo.h"
#include "figures/figure.h"
#include "scene/metals.h"

// Rows of balls: the four of the textbooks, and one for every parameter of the material.

namespace candela::figures {
namespace {

constexpr int kBalls = 11;

Material ball(vec3 color, float metallic, float roughness) {
  Material material;
  material.base_color = color;
  material.metallic = metallic;
  material.roughness = roughness;
  return material;
}

const vec3 kGold(1.0f, 0.782f, 0.344f);  // F0, linear Rec.709
const vec3 kBlue(0.018f, 0.078f, 0.391f);

path::Settings path_settings(const FigureContext& context, int width, int height) {
  path::Settings settings;
  settings.width = width;
  settings.height = height;
  settings.samples = context.settings().samples;
  settings.background = Background::transparent;
  settings.environment_in_glass = true;  // the pages are of any colour
  return settings;
}

raster::Settings raster_settings(int width, int height) {
  raster::Settings settings;
  settings.width = width;
  settings.height = height;
  settings.frames = 16;  // as many points of a pixel as the path tracer has, about
  settings.background = Background::transparent;
  settings.environment_in_glass = true;
  return settings;
}

/// The row by the path tracer, and by the rasterizer with how far each ball is from it.
void add_rows(FigureContext& context, Figure& figure, const std::string& name, const std::vector<Material>& materials,
              const std::vector<std::string>& scale) {
  const int count = static_cast<int>(materials.size());
  const int side = context.pixels(100);
  path::Settings settings = path_settings(context, side, side);
  settings.samples *= 2;  // the errors below should not be of its own noise
  const Film truth = trace_balls(context, materials, settings);
  const DevelopSettings shown{.exposure = 1.0f};
  figure.panels.push_back({name + ".png",
                           develop(truth, shown),
                           fmt::format("path traced, {} samples per pixel", settings.samples),
                           {},
                           scale});
  if (const std::optional<Film> drawn = context.draw(sphere_row(materials), context.environment("studio"),
                                                     sphere_view(count), raster_settings(side * count, side))) {
    figure.panels.push_back(
        {name + "-raster.png",
         develop(*drawn, shown),
         "in real time: prefiltered light, split sum; below each ball its relative RMS error, without edges",
         {},
         errors_of_each(*drawn, truth, count)});
  } else {
    figure.left_out.emplace_back("the row in real time, which needs OpenGL");
  }
}

/// A row over `kBalls` values from 0 to 1.
void add_unit_row(FigureContext& context, Figure& figure, const std::string& name,
                  const std::function<Material(float)>& material) {
  std::vector<Material> materials;
  std::vector<std::string> scale;
  for (int i = 0; i < kBalls; ++i) {
    const float t = static_cast<float>(i) / (kBalls - 1);
    materials.push_back(material(t));
    scale.push_back(fmt::format("{:.1f}", t));
  }
  add_rows(context, figure, name, materials, scale);
}

const char* const kGltf = "Khronos Group 2021, glTF 2.0 Specification, Appendix B";
const char* const kKaris = "Karis 2013, Real Shading in Unreal Engine 4";

Figure roughness_dielectric(FigureContext& context) {
  Figure figure;
  figure.text = {
      "A blue plastic of index 1.5. At 0 the lamps of the studio are mirrored sharply; at 1 their reflection has "
      "melted into the diffuse colour, and only the rim still shows that there is a boundary."};
  figure.formulas = {"α = r^2"};
  figure.sources = {"Burley 2012, Physically-Based Shading at Disney", kKaris};
  figure.functions = {"path::render", "raster::Drawer::render"};
  figure.commands = {"candela render demo:row-roughness -o row-roughness.png --size 840x140"};
  add_unit_row(context, figure, "roughness-dielectric", [](float r) { return ball(kBlue, 0.0f, r); });
  return figure;
}

Figure roughness_metal(FigureContext& context) {
  Figure figure;
  figure.text = {
      "Gold. A metal has no diffuse layer: all that is seen is its reflection, from a mirror to a satin whose light "
      "has bounced several times between the facets and is the more saturated for it."};
  figure.formulas = {"α = r^2"};
  figure.sources = {"Burley 2012, Physically-Based Shading at Disney", kKaris};
  figure.functions = {"path::render", "raster::Drawer::render"};
  figure.commands = {"candela render demo:row-roughness-metal -o row-roughness-metal.png --size 840x140"};
  add_unit_row(context, figure, "roughness-metal", [](float r) { return ball(kGold, 1.0f, r); });
  return figure;
}

Figure f0_row(FigureContext& context) {
  Figure figure;
  figure.text = {
      "The reflectance of the boundary at normal incidence, over black. Dielectrics live at the far left: water "
      "0.02, plastic and glass 0.04, gems up to 0.17. Metals begin at about 0.5. Between is next to nothing in "
      "nature but germanium and silicon. Even F₀ = 0 keeps a rim, for at the horizon everything reflects."};
  figure.formulas = {"F(v·h) = F_0 + (1 − F_0) (1 − v·h)^5", "F_0 = ( \\frac{n_1 − n_2}{n_1 + n_2} )^2"};
  figure.sources = {"Schlick 1994, An Inexpensive BRDF Model for Physically-based Rendering", kGltf};
  figure.functions = {"path::render with Material::specular_color"};
  add_unit_row(context, figure, "f0", [](float f0) {
    Material material = ball(vec3(0.0f), 0.0f, 0.2f);
    material.specular_glossiness = true;
    material.ior = 0.0f;
    material.specular_color = vec3(f0);
    return material;
  });
  return figure;
}

Figure metallic_row(FigureContext& context) {
  Figure figure;
  figure.text = {
      "One base colour, read as the albedo of a diffuse layer at 0 and as the F₀ of a metal at 1. Values between are "
      "for the edges of textures, where a pixel holds some of both: Candela mixes the two whole materials, never "
      "their F₀."};
  figure.formulas = {"F_0 = \\op{mix}(0.04, \\op{base colour}, \\op{metallic})",
                     "f = (1 − m) f_{\\op{dielectric}} + m f_{\\op{metal}}"};
  figure.sources = {kGltf, kKaris};
  figure.functions = {"path::render", "raster::Drawer::render"};
  figure.commands = {"candela render demo:row-metallic -o row-metallic.png --size 840x140"};
  add_unit_row(context, figure, "metallic", [](float m) { return ball(kGold, m, 0.25f); });
  return figure;
}

// ----- one page per parameter

struct Parameter {
  const char* demo;  ///< of io/demo_rows.cpp
  const char* title;
  const char* property;  ///< where glTF has it
  const char* range;     ///< with its default and unit
  const char* text;
  const char* formula;
  const char* source;
  std::string (*value)(const Material&);  ///< what is written under a ball
};

std::string two_digits(float v) { return fmt::format("{:.2g}", v); }
std::string metal_name(const Material& material) {
  for (const Metal& metal : metals()) {
    if (metal.n == material.conductor_n && metal.k == material.conductor_k) return std::string(metal.name);
  }
  return {};
}
std::string color_text(vec3 c) { return fmt::format("{:.2g}", luminance(c)); }

const std::array kParameters{
    Parameter{"row-metallic", "Metallic", "pbrMetallicRoughness.metallicFactor", "0 to 1, default 1",
              "Whether the base colour is that of a diffuse layer below a boundary of index 1.5, or the reflectance "
              "of a metal.",
              "f = (1 − m) f_{\\op{dielectric}} + m f_{\\op{metal}}", kGltf,
              [](const Material& m) { return two_digits(m.metallic); }},
    Parameter{"row-roughness", "Roughness of a dielectric", "pbrMetallicRoughness.roughnessFactor", "0 to 1, default 1",
              "How much the facets of the surface turn from its normal. 0 is a mirror.",
              "D(h) = \\frac{α^2}{π ((n·h)^2 (α^2 − 1) + 1)^2} ; α = r^2", kGltf,
              [](const Material& m) { return two_digits(m.roughness); }},
    Parameter{"row-roughness-metal", "Roughness of a metal", "pbrMetallicRoughness.roughnessFactor",
              "0 to 1, default 1",
              "The same on gold. What bounces between facets is not lost: rough metals keep their brightness and "
              "gain colour.",
              "D(h) = \\frac{α^2}{π ((n·h)^2 (α^2 − 1) + 1)^2} ; α = r^2",
              "Kulla & Conty 2017, Revisiting Physically Based Shading at Imageworks",
              [](const Material& m) { return two_digits(m.roughness); }},
    Parameter{"row-ior", "Index of refraction", "KHR_materials_ior.ior",
              "1 and above, or 0 for full reflection; default 1.5",
              "How much slower light is inside than in air, and so how much the boundary reflects: air 1, water 1.33, "
              "glass 1.5, sapphire 1.76, diamond 2.42.",
              "F_0 = ( \\frac{n − 1}{n + 1} )^2", "Born & Wolf 1999, Principles of Optics, §1.5",
              [](const Material& m) { return fmt::format("{:.3g}", m.ior); }},
    Parameter{"row-specular", "Specular", "KHR_materials_specular.specularFactor", "0 to 1, default 1",
              "Takes the boundary of a dielectric away, as an artist’s means for cavities and cloth.",
              "F = s ( F_0 + (1 − F_0) (1 − v·h)^5 )", "Khronos Group, KHR_materials_specular",
              [](const Material& m) { return two_digits(m.specular); }},
    Parameter{"row-clearcoat", "Clearcoat", "KHR_materials_clearcoat.clearcoatFactor", "0 to 1, default 0",
              "A layer of varnish of index 1.5 over everything else; what it reflects does not reach the base.",
              "f = f_{\\op{coat}} + T(v) T(l) f_{\\op{base}}", "Khronos Group, KHR_materials_clearcoat",
              [](const Material& m) { return two_digits(m.clearcoat); }},
    Parameter{"row-clearcoat-roughness", "Clearcoat roughness", "KHR_materials_clearcoat.clearcoatRoughnessFactor",
              "0 to 1, default 0", "From a polished varnish to a satin one, over the same base.",
              "α_{\\op{coat}} = r_{\\op{coat}}^2", "Khronos Group, KHR_materials_clearcoat",
              [](const Material& m) { return two_digits(m.clearcoat_roughness); }},
    Parameter{"row-sheen-color", "Sheen colour", "KHR_materials_sheen.sheenColorFactor",
              "0 to 1 per channel, default 0", "Fibres that stand up from cloth and catch light at its rim.",
              "D(h) = \\frac{(2 + \\frac{1}{α}) \\op{sin}^{1 / α} θ}{2 π}",
              "Estevez & Kulla 2017, Production Friendly Microfacet Sheen BRDF",
              [](const Material& m) { return color_text(m.sheen_color); }},
    Parameter{"row-sheen-roughness", "Sheen roughness", "KHR_materials_sheen.sheenRoughnessFactor", "0 to 1, default 0",
              "From fibres that stand upright to ones that lie any way: velvet to felt.",
              "D(h) = \\frac{(2 + \\frac{1}{α}) \\op{sin}^{1 / α} θ}{2 π}",
              "Estevez & Kulla 2017, Production Friendly Microfacet Sheen BRDF",
              [](const Material& m) { return two_digits(m.sheen_roughness); }},
    Parameter{"row-anisotropy", "Anisotropy", "KHR_materials_anisotropy.anisotropyStrength", "0 to 1, default 0",
              "Brushed metal: facets turn further across the scratches than along them.",
              "α_t = \\op{mix}(α, 1, a^2) ; α_b = α", "Burley 2012, Physically-Based Shading at Disney",
              [](const Material& m) { return two_digits(m.anisotropy); }},
    Parameter{"row-anisotropy-rotation", "Anisotropy rotation", "KHR_materials_anisotropy.anisotropyRotation",
              "radians, counter-clockwise from the tangent; default 0", "Which way the scratches run.",
              "D(h) = \\frac{1}{π α_t α_b ( \\frac{(t·h)^2}{α_t^2} + \\frac{(b·h)^2}{α_b^2} + (n·h)^2 )^2}",
              "Heitz 2018, Sampling the GGX Distribution of Visible Normals, eq. 1",
              [](const Material& m) { return fmt::format("{:.0f}°", degrees(m.anisotropy_rotation)); }},
    Parameter{"row-clearcoat-anisotropy", "Clearcoat anisotropy",
              "KHR_materials_clearcoat_anisotropy.clearcoatAnisotropyStrength", "0 to 1, default 0",
              "A lacquer that was brushed, over matter that was not.", "α_t = \\op{mix}(α, 1, a^2) ; α_b = α",
              "Khronos Group, KHR_materials_clearcoat_anisotropy (draft)",
              [](const Material& m) { return two_digits(m.clearcoat_anisotropy); }},
    Parameter{"row-fuzz", "Fuzz", "KHR_materials_fuzz.fuzzFactor", "0 to 1, default 0",
              "Dust, down, soot: fibres on top of everything, the varnish included.",
              "f = w f_{\\op{fibres}} + (1 − w + w s(v) s(l)) f_{\\op{below}}",
              "Khronos Group, KHR_materials_fuzz (draft)", [](const Material& m) { return two_digits(m.fuzz); }},
    Parameter{"row-fuzz-color", "Fuzz colour", "KHR_materials_fuzz.fuzzColorFactor", "0 to 1 per channel, default 1",
              "What the fibres are made of; black ones take away as much as white ones give.",
              "D(h) = \\frac{(2 + \\frac{1}{α}) \\op{sin}^{1 / α} θ}{2 π}", "Khronos Group, KHR_materials_fuzz (draft)",
              [](const Material& m) { return color_text(m.fuzz_color); }},
    Parameter{"row-edge-color", "Edge colour", "EXT_materials_specular_edge_color.specularEdgeColorEnabled",
              "true or false, default false", "The specular colour is that of the whole reflection, up to the rim.",
              "F = c s ( F_0 + (1 − F_0) (1 − v·h)^5 )", "Khronos Group, EXT_materials_specular_edge_color (draft)",
              [](const Material& m) { return color_text(m.specular_color); }},
    Parameter{"row-edge-color-metal", "Edge colour of a metal",
              "EXT_materials_specular_edge_color.specularEdgeColorEnabled", "true or false, default false",
              "Of a metal the specular colour is the tint near 82°, where metals dip.",
              "F(82°) = c F_{\\op{Schlick}}(82°)",
              "Kutz, Hasan & Edmondson 2021, Novel Aspects of the Adobe Standard Material",
              [](const Material& m) { return color_text(m.specular_color); }},
    Parameter{"row-diffuse-roughness", "Diffuse roughness", "KHR_materials_diffuse_roughness.diffuseRoughnessFactor",
              "0 to 1, default 0",
              "Clay, plaster, the moon: flatter, and brighter where the light comes from behind the eye.",
              "f = f_{\\op{EON}}(ρ, r)",
              "Portsmouth, Kutz & Hill 2025, EON: A Practical Energy-Preserving Rough Diffuse BRDF",
              [](const Material& m) { return two_digits(m.diffuse_roughness); }},
    Parameter{"row-retroreflection", "Retroreflection", "KHR_materials_retroreflection.retroreflectionFactor",
              "0 to 1, default 0", "Facets that send light back to where it came from, as road signs do.",
              "f = (1 − w) f(v, l) + w f(v, R l)", "Portsmouth et al. 2026, Minimal Retroreflective Microfacet Model",
              [](const Material& m) { return two_digits(m.retroreflection); }},
    Parameter{
        "row-iridescence-thickness", "Film thickness", "KHR_materials_iridescence.iridescenceThicknessMaximum",
        "nanometres, default 400",
        "A film as thin as a wavelength: what its two sides reflect meets in or out of step.",
        "Δφ = \\frac{2 π}{λ} 2 n d \\, \\op{cos} \\, θ_2",
        "Belcour & Barla 2017, A Practical Extension to Microfacet Theory for the Modeling of Varying Iridescence",
        [](const Material& m) { return fmt::format("{:.0f} nm", m.iridescence_thickness_max_nm); }},
    Parameter{
        "row-iridescence-ior", "Film index", "KHR_materials_iridescence.iridescenceIor", "1 and above, default 1.3",
        "The more the film differs from what is above and below it, the stronger its colours.",
        "Δφ = \\frac{2 π}{λ} 2 n d \\, \\op{cos} \\, θ_2",
        "Belcour & Barla 2017, A Practical Extension to Microfacet Theory for the Modeling of Varying Iridescence",
        [](const Material& m) { return fmt::format("{:.2f}", m.iridescence_ior); }},
    Parameter{"row-transmission", "Transmission", "KHR_materials_transmission.transmissionFactor", "0 to 1, default 0",
              "The share of the light past the boundary that goes on instead of coming back diffusely.",
              "f = (1 − t) f_{\\op{diffuse}} + t f_{\\op{transmitted}} + f_{\\op{reflected}}",
              "Walter, Marschner, Li & Torrance 2007, Microfacet Models for Refraction through Rough Surfaces",
              [](const Material& m) { return two_digits(m.transmission); }},
    Parameter{"row-transmission-ior", "Index of a body of glass", "KHR_materials_ior.ior", "1 and above, default 1.5",
              "The same index that decides what is reflected decides how far light is bent.",
              "n_1 \\, \\op{sin} \\, θ_1 = n_2 \\, \\op{sin} \\, θ_2", "Born & Wolf 1999, Principles of Optics, §1.5",
              [](const Material& m) { return fmt::format("{:.3g}", m.ior); }},
    Parameter{"row-transmission-roughness", "Roughness of glass", "pbrMetallicRoughness.roughnessFactor",
              "0 to 1, default 1",
              "Frosted glass: facets scatter what they let through as they scatter what they reflect.",
              "h = − \\frac{n_1 v + n_2 l}{|n_1 v + n_2 l|}",
              "Walter, Marschner, Li & Torrance 2007, Microfacet Models for Refraction through Rough Surfaces, eq. 16",
              [](const Material& m) { return two_digits(m.roughness); }},
    Parameter{"row-thin-transmission", "Transmission of a sheet", "KHR_materials_transmission.transmissionFactor",
              "0 to 1, default 0; KHR_materials_volume.thicknessFactor 0",
              "A sheet without thickness does not bend light; it tints what passes by its base colour.",
              "f = (1 − t) f_{\\op{diffuse}} + t f_{\\op{transmitted}} + f_{\\op{reflected}}",
              "Khronos Group, KHR_materials_transmission",
              [](const Material& m) { return two_digits(m.transmission); }},
    Parameter{"row-attenuation", "Attenuation distance", "KHR_materials_volume.attenuationDistance",
              "metres, above 0; default infinity",
              "How far light goes until only the attenuation colour is left of it.", "T(d) = c^{d / d_0}",
              "Beer 1852, Bestimmung der Absorption des rothen Lichts in farbigen Flüssigkeiten",
              [](const Material& m) { return fmt::format("{:.3g} mm", 1000.0f * m.attenuation_distance); }},
    Parameter{
        "row-dispersion", "Dispersion", "KHR_materials_dispersion.dispersion",
        "20 / Abbe number, 0 and above; default 0",
        "Blue light is slower in glass than red, and bends further. Flint glass is near 0.6; more is for the stage.",
        "V = \\frac{n_d − 1}{n_F − n_C}", "Khronos Group, KHR_materials_dispersion",
        [](const Material& m) { return two_digits(m.dispersion); }},
    Parameter{"row-diffuse-transmission", "Diffuse transmission",
              "KHR_materials_diffuse_transmission.diffuseTransmissionFactor", "0 to 1, default 0",
              "Paper and leaves: diffuse light comes out on the other side. Here a lamp is inside.",
              "f = (1 − t) \\frac{ρ}{π} + t \\frac{ρ_t}{π}", "Khronos Group, KHR_materials_diffuse_transmission",
              [](const Material& m) { return two_digits(m.diffuse_transmission); }},
    Parameter{"row-subsurface", "Mean free path",
              "KHR_materials_volume_scatter, KHR_materials_volume.attenuationDistance", "metres, above 0",
              "How far light goes in wax before it is scattered: from a cloud to something nearly solid.",
              "p(d) = σ_t \\op{exp}(−σ_t d) , σ_t = σ_a + σ_s", "Chandrasekhar 1950, Radiative Transfer",
              [](const Material& m) { return fmt::format("{:.2g} mm", 1000.0f * m.attenuation_distance); }},
    Parameter{"row-scatter-anisotropy", "Scattering anisotropy", "KHR_materials_volume_scatter.scatterAnisotropy",
              "−1 to 1, default 0", "Whether matter scatters light back, evenly, or onwards.",
              "p(θ) = \\frac{1}{4 π} \\frac{1 − g^2}{(1 + g^2 − 2 g \\, \\op{cos} \\, θ)^{3/2}}",
              "Henyey & Greenstein 1941, Diffuse radiation in the Galaxy",
              [](const Material& m) { return two_digits(m.scatter_anisotropy); }},
    Parameter{"row-emission", "Emission", "emissiveFactor, KHR_materials_emissive_strength.emissiveStrength",
              "cd/m², default 0", "Light that the surface sends out by itself, on top of what it reflects.",
              "L_o = L_e + ∫_Ω f L_i (n·l) \\text{ d}l", "Kajiya 1986, The Rendering Equation",
              [](const Material& m) { return two_digits(max_component(m.emission)); }},
    Parameter{"row-conductor", "Measured metals", "extras.candela.conductor", "n and k per primary",
              "Silver, aluminium, titanium, iron, brass, copper and gold by their complex index.",
              "F_0 = \\frac{(n − 1)^2 + k^2}{(n + 1)^2 + k^2}",
              "Johnson & Christy 1974, Optical constants of transition metals", metal_name},
    Parameter{"row-specular-glossiness", "Specular and glossiness", "KHR_materials_pbrSpecularGlossiness",
              "0 to 1, default 1",
              "The other workflow: a reflection of any colour over a diffuse layer of any colour, here from a matt "
              "blue plastic to a gilt mirror by way of what the metallic workflow cannot say.",
              "F_0 = \\op{specular} , r = 1 − \\op{glossiness}", "Khronos Group, KHR_materials_pbrSpecularGlossiness",
              [](const Material& m) { return two_digits(1.0f - m.roughness); }},
    Parameter{"row-lobes", "All together", "", "",
              "Gold, brushed steel, an oxide film, car paint, velvet, wax and glass.",
              "L_o = ∫ f L_i |n·l| \\text{ d}l", kGltf, nullptr}};

/// Exactly what the command that stands beside it renders.
Figure parameter_row(FigureContext& context, const Parameter& parameter) {
  Figure figure;
  figure.text = {parameter.text};
  figure.formulas = {parameter.formula};
  figure.sources = {parameter.source};
  const std::string name = parameter.demo;
  if (parameter.property[0] != '\0') {
    figure.table.head = {"property of glTF", "range"};
    figure.table.rows = {{parameter.property, parameter.range}};
  }
  const Scene scene = content::make_demo(name);
  const Environment& environment = context.environment(*scene.preferred_environment);
  path::Settings settings;
  settings.width = context.pixels(840);
  settings.height = context.pixels(140);
  // Light that goes through bodies is found by luck.
  const bool is_quiet = std::none_of(scene.materials.begin(), scene.materials.end(), [](const Material& m) {
    return m.transmission > 0.0f || m.diffuse_transmission > 0.0f;
  });
  settings.samples = std::max(1, context.settings().samples / (is_quiet ? 2 : 1));
  settings.bounces = 32;
  const float aspect = static_cast<float>(settings.width) / static_cast<float>(settings.height);
  const View view = scene_camera(scene, "0", aspect);
  const DevelopSettings shown{.exposure = scene.preferred_exposure};
  std::vector<std::string> scale;
  if (parameter.value != nullptr) {
    for (const Material& material : scene.materials) {
      if (material.name.starts_with("ball ") && material.name.size() == 6) scale.push_back(parameter.value(material));
    }
  }
  const Film truth = context.trace(scene, environment, view, settings);
  const std::string size = fmt::format("{}x{}", settings.width, settings.height);
  figure.commands = {
      fmt::format("candela render demo:{0} -o {0}.png --size {1} --spp {2} --bounces 32", name, size, settings.samples),
      fmt::format("candela render demo:{0} -o {0}-raster.png --size {1} --engine raster", name, size)};
  figure.panels.push_back({name + ".png",
                           develop(truth, shown),
                           fmt::format("path traced, {} samples per pixel", settings.samples),
                           {},
                           scale});
  raster::Settings drawing;
  drawing.width = settings.width;
  drawing.height = settings.height;
  if (const std::optional<Film> drawn = context.draw(scene, environment, view, drawing)) {
    figure.panels.push_back({name + "-raster.png", develop(*drawn, shown), "in real time, by OpenGL",
                             "relative RMS error " + percent_text(relative_error(drawn->beauty, truth.beauty)) +
                                 ", the path tracer’s noise included"});
  } else {
    figure.left_out.emplace_back("the row in real time, which needs OpenGL");
    figure.commands.pop_back();
  }
  return figure;
}

}  // namespace

void add_sphere_figures(std::vector<FigureInfo>& list) {
  const Chapter c = Chapter::spheres;
  list.push_back({"roughness-dielectric", "Roughness of a dielectric", c, roughness_dielectric});
  list.push_back({"roughness-metal", "Roughness of a metal", c, roughness_metal});
  list.push_back({"f0", "Reflectance at normal incidence", c, f0_row});
  list.push_back({"metallic", "Metallic", c, metallic_row});
}

void add_parameter_figures(std::vector<FigureInfo>& list) {
  for (const Parameter& parameter : kParameters) {
    list.push_back({parameter.demo, parameter.title, Chapter::parameters,
                    [&parameter](FigureContext& context) { return parameter_row(context, parameter); }});
  }
}

}  // namespace candela::figures
