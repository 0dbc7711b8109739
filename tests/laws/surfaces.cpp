#include "laws/surfaces.h"

#include <sstream>

namespace candela::laws {

namespace {

using shade::SurfaceParams;
using shade::vec3;

// Every law would be silent about a member that the table leaves at its default.
static_assert(sizeof(SurfaceParams) == 10 * sizeof(float), "vary the new parameter in looks() below");

struct Look {
  const char* name;
  float ior;
  float specular;
  vec3 specular_color;
  vec3 base_color;
};

std::vector<Look> looks() {
  const vec3 white(1.0f);
  const vec3 ochre(0.8f, 0.5f, 0.2f);
  const vec3 red(1.0f, 0.2f, 0.1f);
  return {
      {"ochre", 1.5f, 1.0f, white, ochre},
      {"white", 1.5f, 1.0f, white, white},
      {"black", 1.5f, 1.0f, white, vec3(0.0f)},
      {"matched ior", 1.0f, 1.0f, white, white},
      {"water", 1.33f, 1.0f, white, white},
      {"diamond", 2.42f, 1.0f, white, white},
      {"ior 0", 0.0f, 1.0f, white, ochre},
      {"no specular", 1.5f, 0.0f, white, white},
      {"half specular", 1.5f, 0.5f, white, white},
      {"red specular", 1.5f, 1.0f, red, white},
      {"red half specular diamond", 2.42f, 0.5f, red, ochre},
      {"black without specular", 1.5f, 0.0f, white, vec3(0.0f)},
  };
}

}  // namespace

std::vector<NamedSurface> surfaces() {
  std::vector<NamedSurface> table;
  for (const float metallic : {0.0f, 0.5f, 1.0f}) {
    for (const float roughness : {0.0f, 0.05f, 0.1f, 0.3f, 0.5f, 0.8f, 1.0f}) {
      for (const Look& look : looks()) {
        SurfaceParams p = shade::surface_params_default();
        p.base_color = look.base_color;
        p.metallic = metallic;
        p.roughness = roughness;
        p.ior = look.ior;
        p.specular = look.specular;
        p.specular_color = look.specular_color;
        std::ostringstream name;
        name << look.name << ", metallic " << metallic << ", roughness " << roughness;
        table.push_back({name.str(), p});
      }
    }
  }
  return table;
}

}  // namespace candela::laws
