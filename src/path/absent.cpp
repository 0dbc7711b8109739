#include "base/parts.h"
#include "path/capture.h"
#include "path/direct_light.h"
#include "path/pixel_paths.h"
#include "path/pixel_surface.h"
#include "path/render.h"

// The doors of the path tracer in a build without it: nobody passes.
namespace candela::path {

namespace {

[[noreturn]] void refuse() { throw absent_part("the path tracer", "CANDELA_WITH_PATH"); }

}  // namespace

void check_built() { refuse(); }
const char* integrator_name(Integrator) { refuse(); }
std::uint64_t picture_bytes(const Settings&) { refuse(); }

struct PreparedEnvironment {};
FarLight::FarLight(const Environment&) { refuse(); }

struct Tracer::Parts {};
Tracer::Tracer(std::shared_ptr<const Scene>, const FarLight&, const shade::ShadingModel&) { refuse(); }
Tracer::Tracer(std::shared_ptr<const Scene>, const Environment&, const shade::ShadingModel&) { refuse(); }
Tracer::Tracer(Scene, const Environment&, const shade::ShadingModel&) { refuse(); }
Tracer::Tracer(const Tracer&, std::shared_ptr<const Scene>, const FarLight&) { refuse(); }
bool Tracer::take_materials(const std::shared_ptr<const Scene>&, const FarLight&, const shade::ShadingModel&) {
  refuse();
}
Film Tracer::render(const View&, const Settings&, const Job&, Statistics*) const { refuse(); }
const Scene& Tracer::scene() const { refuse(); }
double Tracer::build_s() const { refuse(); }

class Picture::Impl {};
Picture::Picture(const Tracer&, const View&, const Settings&) { refuse(); }
Picture::~Picture() = default;
void Picture::trace(int, const Job&) { refuse(); }
Film Picture::film() const { refuse(); }
Statistics Picture::statistics() const { refuse(); }
const Accumulator& Picture::sums() const { refuse(); }
bool Picture::has_through() const { refuse(); }
std::vector<std::byte> Picture::state() const { refuse(); }
void Picture::set_state(std::span<const std::byte>) { refuse(); }

Film render(const Scene&, const Environment&, const View&, const Settings&, const Job&, Statistics*) { refuse(); }
DirectLight trace_direct_light(const Tracer&, const View&, const Settings&, const Job&) { refuse(); }
void check_pixel(ivec2, ivec2) { refuse(); }
std::optional<FacetTerms> facet_terms(const shade::Surface&, vec3, vec3) { refuse(); }
std::optional<PixelSurface> find_pixel_surface(const Tracer&, const View&, ivec2, ivec2) { refuse(); }
PixelEstimate trace_pixel(const Tracer&, const View&, const Settings&, ivec2, const PixelPathSettings&, const Job&) {
  refuse();
}
Cubemap capture_environment(const Tracer&, vec3, int, const Settings&, const Job&, Statistics*) { refuse(); }

}  // namespace candela::path
