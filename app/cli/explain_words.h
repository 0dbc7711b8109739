#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "candela/explain.h"

/// The words of an explanation, which its text and its page share.
namespace candela::cli {

std::string vec_words(vec3 v);  ///< "0.1 0.2 0.3", four digits
float angle_deg(float cosine);

using NamedColor = std::pair<std::string_view, vec3>;
/// Those that are not black, by the names of LobeParts and SurfaceShares.
std::vector<NamedColor> parts_of(const shade::LobeParts& parts);
std::vector<NamedColor> shares_of(const path::PixelSurface& surface);

std::string surface_words(const Scene& scene, const path::PixelSurface& surface);
std::string property_words(const PropertyValue& property, vec3 value);
std::string property_origin(const PropertyValue& property);  ///< "0.5 in the file, times its texture"
std::string facets_words(const path::PixelSurface& surface);

std::string lamp_name(const Scene& scene, const path::LampTerms& lamp);
std::string lamp_words(const path::LampTerms& lamp);
std::string lamp_terms_words(const path::LampTerms& lamp);

std::string frame_term_name(const FrameTerm& term);  ///< as of `render --show`
std::string lookup_words(const FarLookup& read, int levels);
/// How the frame's luminance differs from the truth's; empty where that is black.
std::string ratio_words(vec3 frame, const path::PixelEstimate& truth);

std::string_view source_kind_name(path::LightKind kind);
std::string_view event_name(path::PathEvent event);
std::string source_name(const Scene& scene, const path::LightSource& source);
std::string path_words(const Scene& scene, const path::LightPath& path);

}  // namespace candela::cli
