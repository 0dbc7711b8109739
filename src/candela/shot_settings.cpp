#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "base/error.h"
#include "base/named_row.h"
#include "candela/shot.h"

namespace candela {

PictureRange parse_pictures(const std::string& text) {
  PictureRange range;
  const char *at = text.data(), *const end = at + text.size();
  const auto first = std::from_chars(at, end, range.first);
  range.last = range.first;
  const bool has_last = first.ec == std::errc() && first.ptr != end && *first.ptr == '-';
  const auto last = has_last ? std::from_chars(first.ptr + 1, end, range.last) : first;
  const bool is_whole = last.ec == std::errc() && last.ptr == end;
  if (!is_whole || range.first < 1 || range.last < range.first) {
    throw Error("'" + text + "' are no pictures: the first eight are 1-8");
  }
  return range;
}

Quality parse_quality(std::string_view name) { return row_named(kQualities, name, "unknown quality").quality; }

void set_quality(Quality quality, Shot& shot) {
  for (const QualityInfo& info : kQualities) {
    if (info.quality != quality) continue;
    shot.traced.samples = info.samples;
    shot.traced.noise = info.noise > 0.0f ? std::optional(info.noise) : std::nullopt;
    shot.denoiser = denoise::Method::regression;
    shot.drawn.frames = info.frames;
  }
}

Studio parse_studio(std::string_view name) { return row_named(kStudios, name, "unknown studio").studio; }

void set_studio(Studio studio, Shot& shot) {
  for (const StudioInfo& info : kStudios) {
    if (info.studio != studio) continue;
    shot.environment = info.environment;
    shot.ground = GroundChoice{.color = info.paper, .mirror = info.mirror};
  }
}

namespace {

/// An engine's settings with what a shot says of the picture, which both engines know.
template <class Settings>
Settings with_picture(Settings settings, const Shot& shot) {
  settings.width = shot.size.x;
  settings.height = shot.size.y;
  settings.background = shot.background;
  settings.environment_in_glass = shot.environment_in_glass;
  settings.layers = shot.layers;
  settings.mattes = shot.mattes;
  settings.has_masks = shot.has_masks;
  return settings;
}

/// Parts have whole blocks of samples, as even as can be.
void set_part(const PartRange& part, path::Settings& settings) {
  constexpr int kBlock = path::kSamplesOfBlock;
  const int blocks = (settings.samples + kBlock - 1) / kBlock;
  if (part.count > blocks) {
    throw Error(fmt::format("{} samples are {} of sixteen: no more parts than that", settings.samples,
                            blocks == 1 ? "one block" : fmt::format("{} blocks", blocks)),
                "--part");
  }
  const auto first_block = [&](int index) {
    return static_cast<int>(static_cast<std::int64_t>(blocks) * index / part.count);
  };
  settings.first_sample = kBlock * first_block(part.index - 1);
  settings.samples = std::min(settings.samples, kBlock * first_block(part.index));
}

}  // namespace

path::Settings traced_settings(const Shot& shot) {
  path::Settings settings = with_picture(shot.traced, shot);
  settings.has_features |= shot.denoiser.has_value();
  if (shot.exposure) settings.develop.exposure = *shot.exposure;
  settings.develop.tone_curve = shot.tone_curve;
  if (shot.part) set_part(*shot.part, settings);
  return settings;
}
raster::Settings drawn_settings(const Shot& shot) { return with_picture(shot.drawn, shot); }

std::uint64_t picture_bytes(const Shot& shot) {
  const std::uint64_t pixels = static_cast<std::uint64_t>(shot.size.x) * static_cast<std::uint64_t>(shot.size.y);
  return shot.engine == Engine::raster
             ? raster::picture_bytes(drawn_settings(shot))
             : path::picture_bytes(traced_settings(shot)) + (shot.denoiser ? denoise::bytes_per_pixel() * pixels : 0);
}

}  // namespace candela
