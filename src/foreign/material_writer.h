#pragma once

#include <functional>
#include <map>
#include <string>

#include "foreign/draft.h"
#include "foreign/look.h"

namespace candela::foreign {

/// Makes glTF materials, textures and images of looks.
class MaterialWriter {
 public:
  /// `picture` gives the member of `images` for a map's file: {"uri"} or {"bufferView", "mimeType"}.
  MaterialWriter(Draft& draft, std::function<nlohmann::json(const std::string& file)> picture)
      : draft_(draft), picture_(std::move(picture)) {}

  /// Appends a material; its place. Phong becomes metallic-roughness so: base colour Kd, metallic 0,
  /// roughness⁴ = 2 / (Ns + 2) (Walter et al. 2007, "Microfacet Models for Refraction through Rough Surfaces", §5.2,
  /// whose α_p = 2 / α_b² - 2, with α = roughness²), F0 = 0.08 Ks, so that a Ks of a half is glass of index 1.5, and no
  /// mirror at all where Ks is black.
  std::size_t add(const Look& look);

 private:
  void write_surface(const Look& look, nlohmann::json& material);
  void write_phong(const Look& look, nlohmann::json& material);
  void write_layers(const Look& look, nlohmann::json& material);
  void write_color(const Look& look, nlohmann::json& material);
  void write_roughness(const Look& look, nlohmann::json& pbr);
  void write_bumps(const Look& look, nlohmann::json& material);
  nlohmann::json& extension(nlohmann::json& material, const char* name);
  nlohmann::json texture(const Map& map);
  nlohmann::json texture_of_image(const Map& map, std::size_t image);
  std::size_t image(const std::string& file);
  int source(const Map& map);
  std::size_t mixture(nlohmann::json recipe);

  Draft& draft_;
  std::function<nlohmann::json(const std::string&)> picture_;
  std::map<std::string, std::size_t> images_;
  std::map<std::string, int> sources_;
  std::map<std::string, std::size_t> mixtures_, textures_;
};

}  // namespace candela::foreign
