#include "base/parts.h"
#include "raster/render.h"

// The doors of the rasterizer in a build without it: nobody passes.
namespace candela::raster {

namespace {

[[noreturn]] void refuse() { throw absent_part("the rasterizer", "CANDELA_WITH_RASTER"); }

}  // namespace

void check_built() { refuse(); }
std::uint64_t picture_bytes(const Settings&) { refuse(); }

struct Device::Parts {};
Device::Device() { refuse(); }
Device::~Device() = default;
std::shared_ptr<Device> Device::of_current_context() { refuse(); }

class Drawer::Impl {};
Drawer::Drawer(std::shared_ptr<const Scene>, const Environment&, const shade::ShadingModel&, std::shared_ptr<Device>) {
  refuse();
}
Drawer::Drawer(Scene, const Environment&, const shade::ShadingModel&, std::shared_ptr<Device>) { refuse(); }
Drawer::~Drawer() = default;
void Drawer::set_probes(std::vector<Probe>) { refuse(); }
void Drawer::set_scene(std::shared_ptr<const Scene>) { refuse(); }
Film Drawer::render(const View&, const Settings&, const Job&, Statistics*) { refuse(); }
Film Drawer::render(const MomentOf&, const Settings&, const Job&, Statistics*) { refuse(); }
void Drawer::draw_frame(const View&, const Settings&, const Job&, int) { refuse(); }
void Drawer::present(ivec2, float, ToneCurve) { refuse(); }
void Drawer::set_environment(const Environment&, BakedLight) { refuse(); }
void Drawer::turn_environment(float, float) { refuse(); }
DisplayImage Drawer::read_shown(float, ToneCurve) { refuse(); }
SurfaceMap Drawer::read_surfaces(const View&) { refuse(); }
Film Drawer::read_frame() { refuse(); }
void Drawer::reload_shaders() { refuse(); }

BakedLight bake_light_of(const Scene&, const Environment&, const std::filesystem::path&) { refuse(); }

Film render(const Scene&, const Environment&, const View&, const Settings&, const Job&, Statistics*) { refuse(); }

}  // namespace candela::raster
