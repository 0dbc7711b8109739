#include "figures/symbols.h"

#include <algorithm>
#include <array>

namespace candela::figures {

namespace {

/// One letter has several meanings in the field, which what stands around it tells apart.
struct SymbolRow {
  Symbol symbol;
  std::array<std::string_view, 3> found_as;  ///< parts of formulas; empty = no more
};

constexpr auto kRows = std::to_array<SymbolRow>({
    {{"n", "the surface’s normal"}, {"(n·", "E(n)", "|n·"}},
    {{"l", "the direction to the light"}, {"·l)", "(l, v)", "·l|"}},
    {{"v", "the direction to the eye"}, {"·v", "(v", ", v)"}},
    {{"h", "half way between l and v: the normal of the facets that mirror"}, {"(h)", "·h", ""}},
    {{"Ω", "the hemisphere above the surface"}, {"Ω", "", ""}},
    {{"θ", "an angle to the normal"}, {"θ", "", ""}},
    {{"L_i", "radiance that arrives"}, {"L_i", "", ""}},
    {{"L_o", "radiance that leaves"}, {"L_o", "", ""}},
    {{"L_e", "radiance of what glows"}, {"L_e", "", ""}},
    {{"L_λ", "radiance by wavelength"}, {"L_λ", "", ""}},
    {{"E(n)", "irradiance"}, {"E(n)", "", ""}},
    {{"E(d)", "irradiance at the distance d"}, {"E(d)", "", ""}},
    {{"E(v)", "the share of light from v that comes back"}, {"E(v)", "", ""}},
    {{"I", "the lamp’s intensity"}, {"{I}", "", ""}},
    {{"f", "the BRDF: radiance that leaves over irradiance"}, {"f(l, v)", "f L_i", "f (n"}},
    {{"D", "how many facets look along h, over solid angle"}, {"D(h)", "D F", "L_i D"}},
    {{"G", "the share of them that is neither masked nor in shadow"}, {"G(l, v)", "F G", "G_{"}},
    {{"G_1", "of one direction alone"}, {"G_1", "", ""}},
    {{"Λ", "what hides facets, over what shows"}, {"Λ", "", ""}},
    {{"F", "Fresnel’s reflectance"}, {"F(v·h)", "D F", "F ="}},
    {{"F_0", "reflectance at normal incidence"}, {"F_0", "", ""}},
    {{"F_{90}", "reflectance at grazing incidence"}, {"F_{90}", "", ""}},
    {{"α", "width of the facets’ distribution"}, {"α", "", ""}},
    {{"r", "roughness"}, {"r^2", "r)", "r = "}},
    {{"ρ", "albedo of the diffuse layer"}, {"ρ", "", ""}},
    {{"m", "metallic"}, {"(1 − m)", "m^2 +", ""}},
    {{"n_1, n_2", "indices of refraction before and beyond"}, {"n_1", "", ""}},
    {{"n + i k", "the metal’s index"}, {"i k", "k^2}", ""}},
    {{"p", "density of the samples"}, {"p(l_k)", "", ""}},
    {{"N", "number of samples"}, {"{N}", "", ""}},
    {{"σ_N", "standard deviation of their mean"}, {"σ_N", "", ""}},
    {{"σ_a, σ_s, σ_t", "absorption, scattering and both, per metre"}, {"σ_t", "", ""}},
    {{"Y_{l m}", "spherical harmonics"}, {"Y_{l m}", "", ""}},
    {{"λ", "wavelength"}, {"λ", "", ""}},
    {{"c", "a channel, linear"}, {"(c)", "12.92 c", ""}},
    {{"dω", "solid angle"}, {"dω", "", ""}},
});

}  // namespace

std::vector<Symbol> symbols_in(const std::vector<std::string>& formulas) {
  std::vector<Symbol> symbols;
  for (const SymbolRow& row : kRows) {
    const bool is_there = std::any_of(formulas.begin(), formulas.end(), [&](const std::string& formula) {
      return std::any_of(row.found_as.begin(), row.found_as.end(), [&](std::string_view part) {
        return !part.empty() && formula.find(part) != std::string::npos;
      });
    });
    if (is_there) symbols.push_back(row.symbol);
  }
  return symbols;
}

}  // namespace candela::figures
