#include "scene/metals.h"

#include <array>

namespace candela {
namespace {

constexpr std::string_view kJohnsonChristy =
    "Johnson & Christy 1974, Optical constants of transition metals: Ti, V, Cr, Mn, Fe, Co, Ni, and Pd";
constexpr std::string_view kSopra =
    "SOPRA, Optical constants database (every 0.05 eV), as in pbrt; after Palik 1985, Handbook of Optical Constants of "
    "Solids";
constexpr std::string_view kQuerry = "Querry 1985, Optical constants (70 % Cu, 30 % Zn)";
constexpr std::string_view kRakic =
    "Rakić et al. 1998, Optical properties of metallic films for vertical-cavity optoelectronic devices "
    "(Brendel-Bormann model)";
constexpr std::string_view kWeaver = "Weaver et al. 1975, Optical properties of crystalline tungsten";

// name, n, k, measured n, measured k, source
constexpr std::array<Metal, 13> kMetals = {{
    {"aluminium",
     {1.4317f, 0.9266f, 0.6131f},
     {7.7502f, 6.5957f, 5.4622f},
     {1.4748f, 0.9586f, 0.6180f},
     {7.7941f, 6.6870f, 5.4694f},
     kSopra},
    {"brass",
     {0.4403f, 0.5219f, 1.1300f},
     {4.1751f, 2.6647f, 1.8149f},
     {0.4440f, 0.5270f, 1.0940f},
     {3.6950f, 2.7650f, 1.8290f},
     kQuerry},
    {"chromium",
     {3.2470f, 3.1113f, 2.3001f},
     {3.2870f, 3.3370f, 3.1131f},
     {3.1071f, 3.1812f, 2.3230f},
     {3.3314f, 3.3291f, 3.1350f},
     kJohnsonChristy},
    {"cobalt",
     {2.2579f, 2.0336f, 1.7257f},
     {4.2284f, 3.7944f, 3.2380f},
     {2.2371f, 2.0524f, 1.7365f},
     {4.2357f, 3.8242f, 3.2745f},
     kJohnsonChristy},
    {"copper",
     {0.1494f, 0.9729f, 1.2212f},
     {3.4714f, 2.6165f, 2.3757f},
     {0.2166f, 0.9582f, 1.1658f},
     {3.6377f, 2.5771f, 2.3939f},
     kSopra},
    {"gold",
     {0.0027f, 0.4127f, 1.5702f},
     {3.1378f, 2.3652f, 1.7204f},
     {0.1678f, 0.3504f, 1.5085f},
     {3.1378f, 2.7141f, 1.8788f},
     kSopra},
    {"iron",
     {2.9233f, 2.9168f, 2.5595f},
     {3.0774f, 2.9381f, 2.7441f},
     {2.9114f, 2.9497f, 2.5845f},
     {3.0893f, 2.9318f, 2.7670f},
     kJohnsonChristy},
    {"nickel",
     {2.0321f, 1.9009f, 1.7397f},
     {4.2002f, 3.5692f, 2.8951f},
     {1.9900f, 1.9212f, 1.7290f},
     {4.2086f, 3.6158f, 2.9435f},
     kJohnsonChristy},
    {"palladium",
     {1.7953f, 1.6202f, 1.4066f},
     {4.3644f, 3.8113f, 3.2138f},
     {1.7893f, 1.6412f, 1.4080f},
     {4.3750f, 3.8455f, 3.2540f},
     kJohnsonChristy},
    {"platinum",
     {2.3577f, 2.0661f, 1.8386f},
     {4.2538f, 3.6785f, 3.0907f},
     {2.3757f, 2.0849f, 1.8453f},
     {4.2655f, 3.7153f, 3.1365f},
     kRakic},
    {"silver",
     {0.1290f, 0.1231f, 0.1609f},
     {4.1027f, 3.3197f, 2.5002f},
     {0.1394f, 0.1248f, 0.1517f},
     {4.1288f, 3.3396f, 2.4704f},
     kSopra},
    {"titanium",
     {2.7476f, 2.5063f, 2.2532f},
     {3.8432f, 3.3977f, 3.0117f},
     {2.7407f, 2.5418f, 2.2670f},
     {3.8143f, 3.4345f, 3.0385f},
     kJohnsonChristy},
    {"tungsten",
     {3.6374f, 3.4925f, 3.3323f},
     {2.9240f, 2.7488f, 2.4929f},
     {3.6713f, 3.5221f, 3.3196f},
     {2.9314f, 2.7414f, 2.5171f},
     kWeaver},
}};

struct Alias {
  std::string_view alias, name;
};

constexpr std::array<Alias, 14> kAliases = {{{"Ag", "silver"},
                                             {"Al", "aluminium"},
                                             {"Au", "gold"},
                                             {"Co", "cobalt"},
                                             {"Cr", "chromium"},
                                             {"Cu", "copper"},
                                             {"CuZn", "brass"},
                                             {"Fe", "iron"},
                                             {"Ni", "nickel"},
                                             {"Pd", "palladium"},
                                             {"Pt", "platinum"},
                                             {"Ti", "titanium"},
                                             {"W", "tungsten"},
                                             {"aluminum", "aluminium"}}};

}  // namespace

std::span<const Metal> metals() { return kMetals; }

const Metal* find_metal(std::string_view name) {
  for (const Alias& alias : kAliases) {
    if (alias.alias == name) name = alias.name;
  }
  for (const Metal& metal : kMetals) {
    if (metal.name == name) return &metal;
  }
  return nullptr;
}

}  // namespace candela
