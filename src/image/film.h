#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "image/image.h"
#include "image/mattes.h"
#include "image/surface_map.h"

namespace candela {

/// What a film can hold beside the picture. All linear, none filtered by exposure or tone curve.
enum class Layer {
  albedo,         ///< RGB, directional reflectance of the first hit
  normal,         ///< XYZ world space shading normal, unit or 0 where nothing was hit
  camera_normal,  ///< the same in camera space: right, up, towards the viewer
  base_color,     ///< RGB, what its material says, textures and vertex colours included; 0 where nothing was hit
  depth,          ///< metres along the camera's axis, +inf where nothing was hit
  distance,       ///< metres along the ray from the camera, +inf where nothing was hit
  position,       ///< XYZ world space, metres
  uv,             ///< the mesh's first texture coordinates
  motion,         ///< pixels, right and down, from here to where the surface is in the next picture
  object_id,      ///< 1 + number of the node of the first hit, 0 = background
  instance,       ///< 1 + place of the node in the scene, which tells the instances of a node apart
  mesh,           ///< 1 + number of its mesh
  material,       ///< 1 + number of its material
  face            ///< 1 + place of the triangle in its primitive
};

/// What a layer is. A new one is a value of the enum, a row here, and, if it has a mean, what the path tracer makes of
/// the first hit and the rasterizer's quantity of its name, else what scene/surface_layers.h makes of a surface.
struct LayerInfo {
  Layer layer;
  std::string_view name;      ///< on the command line and in EXR files
  std::string_view channels;  ///< a letter for each, as EXR files have them
  bool has_mean;              ///< over the samples of a pixel; else it is that of the pixel's centre
  float nothing;              ///< where nothing is hit
  bool is_number = false;     ///< an integer, which OpenEXR files have as one
};
/// Largest number of a layer: floats hold all up to it.
inline constexpr std::uint32_t kLargestNumber = 1u << 24;
inline constexpr auto kLayers = std::to_array<LayerInfo>({
    {Layer::albedo, "albedo", "RGB", true, 1.0f},
    {Layer::normal, "normal", "RGB", true, 0.0f},
    {Layer::camera_normal, "camera-normal", "RGB", true, 0.0f},
    {Layer::base_color, "base-color", "RGB", true, 0.0f},
    {Layer::depth, "depth", "Z", false, kInfinity},
    {Layer::distance, "distance", "Z", false, kInfinity},
    {Layer::position, "position", "RGB", false, 0.0f},
    {Layer::uv, "uv", "UV", false, 0.0f},
    {Layer::motion, "motion", "XY", false, 0.0f},
    {Layer::object_id, "id", "Y", false, 0.0f, true},
    {Layer::instance, "instance", "Y", false, 0.0f, true},
    {Layer::mesh, "mesh", "Y", false, 0.0f, true},
    {Layer::material, "material", "Y", false, 0.0f, true},
    {Layer::face, "face", "Y", false, 0.0f, true},
});

constexpr const LayerInfo& layer_info(Layer layer) { return kLayers[static_cast<std::size_t>(layer)]; }
constexpr int layer_channels(Layer layer) { return static_cast<int>(layer_info(layer).channels.size()); }
constexpr std::string_view layer_name(Layer layer) { return layer_info(layer).name; }
/// By its name, or "node" for the id, or for one version "ray-depth" for the distance. Throws Error for an unknown
/// name, listing the known ones.
Layer parse_layer(std::string_view name);

/// What a denoiser knows of a picture beside its colours: means over the samples of each pixel, and how uncertain they
/// are. Linear, 3 channels unless said otherwise.
struct DenoisingFeatures {
  Image albedo;  ///< of the first surface that is neither mirror nor clear glass, as seen by these; 1 for lights
  Image normal;  ///< world space, of the same; 0 where there is none
  Image albedo_variance;   ///< of the mean, averaged over the channels: 1 channel
  Image normal_variance;   ///< the same
  Image seen;              ///< lamps and background, neither reflected nor refracted; A: variance of its luminance
  Image variance;          ///< of the mean of the picture's other light, by channel
  Image through_variance;  ///< of the mean of what Film::through lets through, by channel; empty where that is
};

/// The renderer's result: linear Rec.709 radiance before exposure and tone curve, alpha = coverage, and named layers.
struct Film {
  Image beauty;  ///< 4 channels, premultiplied
  /// Where glass shows the background: R, G, B are what the background behind a pixel is multiplied by (1 where nothing
  /// is in front), A is how much of the pixel is glass or anything else. Empty where nothing lets it through: then it
  /// is 1 - alpha of the picture. Else that alpha is alpha_before(through).
  Image through;
  std::map<Layer, Image> layers;
  std::map<MatteKind, Mattes> mattes;
  std::optional<std::vector<InstanceMask>> masks;  ///< where they were asked for: of what is in the picture's frame
  /// What is at the pixels' centres, kept for Layer::motion, which takes another moment: see motion_layer().
  std::optional<SurfaceMap> surfaces;
  std::optional<DenoisingFeatures> features;    ///< where they were asked for
  Image noisy;                                  ///< the picture before it was denoised; empty where it was not
  std::map<std::string, std::string> metadata;  ///< scene, camera, samples, seed, version: written to the EXR header

  int width() const { return beauty.width; }
  int height() const { return beauty.height; }
};

/// Alpha of what lets `through` of the background show: before a grey one the picture keeps its luminance.
float alpha_before(vec3 through);

/// Gives a film what shows through it, and its picture the alpha that follows.
void set_through(Image through, Film& film);

/// Adds `share` of a film of the same size and layers to `sum`, an empty one at first. Layers that have no mean, and
/// masks, stay those of the first.
void accumulate(const Film& film, float share, Film& sum);

/// Whether one of these is that of a surface at each pixel's centre.
bool has_centre_layer(const std::set<Layer>& layers);
/// How many of these are means over the samples of a pixel.
std::size_t count_mean_layers(const std::set<Layer>& layers);

/// Of the pixels of a film with these layers, the picture included.
std::uint64_t film_bytes_per_pixel(const std::set<Layer>& layers, bool has_features = false);

/// Writes 32-bit float EXR, compressed without loss: R,G,B,A of the beauty, and each layer as `name.R` … (`depth.Z`,
/// `id.Y`, whose numbers are 32-bit integers), mattes as Cryptomatte 1.2 has them, and the picture before it was
/// denoised as `noisy.R` …. The alpha channel is left out when every pixel is opaque. What coloured glass lets through
/// is `through.R` …: picture + through × background. Throws Error where the path cannot be written.
void write_exr(const std::filesystem::path& path, const Film& film);

}  // namespace candela
