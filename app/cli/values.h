#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "candela/shot.h"

/// What the text of an option means. Every function throws UsageError for a text that is not exactly that.
namespace candela::cli {

/// A command line that makes no sense whatever the files hold: exit code 2.
class UsageError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The words that an option takes, and what each means.
template <class T, std::size_t n>
using Words = std::array<std::pair<std::string_view, T>, n>;

template <class T, std::size_t n>
T one_of(const std::string& text, const Words<T, n>& words) {
  std::string known;
  for (const auto& [word, value] : words) {
    if (text == word) return value;
    known += (known.empty() ? "" : ", ") + std::string(word);
  }
  throw UsageError("'" + text + "' is none of " + known);
}

inline constexpr Words<Engine, 2> kEngines{{{"path", Engine::path}, {"raster", Engine::raster}}};
inline constexpr Words<path::PixelFilter, 3> kFilters{{{"box", path::PixelFilter::box},
                                                       {"gaussian", path::PixelFilter::gaussian},
                                                       {"blackman-harris", path::PixelFilter::blackman_harris}}};
inline constexpr Words<path::Integrator, 3> kIntegrators{{{"full", path::Integrator::full},
                                                          {"minimal", path::Integrator::minimal},
                                                          {"surfaces", path::Integrator::surfaces}}};
inline constexpr Words<raster::Ambient, 5> kAmbients{{{"baked", raster::Ambient::baked},
                                                      {"harmonics", raster::Ambient::harmonics},
                                                      {"mips", raster::Ambient::mips},
                                                      {"constant", raster::Ambient::constant},
                                                      {"none", raster::Ambient::none}}};
inline constexpr Words<Falloff, 4> kFalloffs{{{"gltf", Falloff::gltf},
                                              {"inverse-square", Falloff::inverse_square},
                                              {"ue4", Falloff::ue4},
                                              {"polynomial", Falloff::polynomial}}};

/// A finite number within [low, high].
float parse_number(const std::string& text, float low, float high);
int parse_count(const std::string& text, int low, int high);

/// Of a noise pattern: a whole number from 0.
std::uint32_t parse_seed(const std::string& text);

ivec2 parse_size(const std::string& text);           ///< "1280x720"
double parse_duration(const std::string& text);      ///< seconds from "30", "30s", "1.5m", "2h", "500ms"
double parse_moment(const std::string& text);        ///< the same, 0 too
std::uint64_t parse_bytes(const std::string& text);  ///< "2GB", "512M", "64MiB", "1.5G"; K, M and G are thousands
float parse_angle(const std::string& text);          ///< radians from "45", "45deg", "0.8rad"
float parse_field_of_view(const std::string& text);  ///< an angle between 0 and 180 degrees
vec3 parse_vec3(const std::string& text);            ///< "x,y,z"
vec3 parse_color(const std::string& text);           ///< linear from "#rgb", "#rrggbb" (sRGB), "r,g,b" or a name
Orbit parse_orbit(const std::string& text);          ///< "azimuth,elevation[,distance]", degrees
std::vector<std::string> parse_names(const std::string& text);  ///< "a,b,c", none of them empty
std::set<Layer> parse_layers(const std::string& text);
std::set<MatteKind> parse_mattes(const std::string& text);
shade::ShadingModel parse_shading(const std::string& text);

struct BackgroundChoice {
  Background kind = Background::environment;
  std::optional<vec3> color = {};  ///< linear; shows through where the film is transparent
  float opacity = 1.0f;            ///< of that colour
};
/// A colour may have an alpha here: "#rgba", "#rrggbbaa".
BackgroundChoice parse_background(const std::string& text);
/// Whether glass shows the environment.
bool parse_glass(const std::string& text);
GroundChoice parse_ground(const std::string& text);    ///< "shadow", "mirror:X", a colour, or "COLOUR+mirror:X"
FalloffChoice parse_falloff(const std::string& text);  ///< a kind, or "polynomial:a0,a1,a2"

/// Metres, or empty for "auto".
std::optional<float> parse_focus(const std::string& text);

/// One printable line: line breaks and other control characters become blanks.
std::string one_line(const std::string& text);

}  // namespace candela::cli
