#pragma once

#include <functional>
#include <map>
#include <string>

#include "candela/shot.h"

/// How one picture of a shot is made ready, named and denoised: what Take and LiveScene have in common.
namespace candela {

/// The shot with what its members imply of each other. Throws Error where this build is without its engine.
Shot takeable(Shot shot);

/// The ground that a shot, which has one, lays under the scene.
Ground ground_of(const Shot& shot, const Scene& scene);

/// Every point and spot of the scene fades so.
void set_falloff(const FalloffChoice& choice, Scene& scene);

/// Whether a part of a mesh has all that its material reads of its vertices.
bool is_complete(const Scene& scene, const Primitive& primitive);
/// Gives it what it lacks, as the readers of files do.
void complete_primitive(const Material& material, Primitive& primitive);

/// How its picture is developed, as far as known before it is there.
DevelopSettings develop_of(const Shot& shot, const Scene& scene, const Environment& environment);

/// What is built in stands in for a library that is not there, and `warn` is told why.
void choose_denoiser(Shot& shot, const std::function<void(std::string)>& warn);

/// How much of the progress of a picture that is denoised is that of its samples.
inline constexpr double kShareOfSamples = 0.97;

/// Stopped on the way, it is the picture as it was traced, which is not what was asked for; `warn` is told.
void take_noise_out(denoise::Method method, TakenPicture& picture, const Job& job,
                    const std::function<void(std::string)>& warn);

/// What every file of a picture says of it. `camera` in words; `samples` per pixel, or frames.
std::map<std::string, std::string> picture_metadata(const Shot& shot, const Environment& environment,
                                                    const std::string& camera, double samples, bool is_denoised);

/// A text that differs where shading models differ.
std::string shading_key(const shade::ShadingModel& model);

}  // namespace candela
