#include "viewer/loading.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "cli/output.h"
#include "cli/values.h"
#include "content/make_environment.h"
#include "scene/environment.h"

namespace candela::viewer {

namespace fs = std::filesystem;

namespace {

/// The same mean radiance from everywhere.
Environment plain_light(const Environment& environment) {
  Environment plain;
  plain.intensity = environment.intensity;
  plain.rotation = environment.rotation;
  plain.constant = environment.constant;
  if (environment.map == nullptr) return plain;
  const Image& map = *environment.map;
  dvec3 sum(0.0);
  double weights = 0.0;
  const int step = std::max(map.height / 64, 1);
  for (int y = step / 2; y < map.height; y += step) {
    const double weight = map_solid_angle(y, map.width, map.height);
    for (int x = step / 2; x < map.width; x += step) sum += weight * dvec3(map.rgb(x, y)), weights += weight;
  }
  plain.constant += vec3(sum / std::max(weights, 1e-30));
  return plain;
}

/// Whether a first look without images is worth reading the file twice.
bool has_outline(const Shot& shot) {
  constexpr std::uintmax_t kMost = std::uintmax_t{64} << 20;  // larger ones have large meshes
  std::error_code code;
  const bool is_gltf = cli::has_extension(shot.scene, ".glb") || cli::has_extension(shot.scene, ".gltf");
  return is_gltf && fs::file_size(shot.scene, code) < kMost && !code;
}

}  // namespace

bool is_environment_file(const std::string& path) {
  constexpr std::array kExtensions = {".hdr", ".exr", ".ktx2", ".ktx", ".dds", ".png", ".jpg", ".jpeg"};
  return std::any_of(kExtensions.begin(), kExtensions.end(),
                     [&](const char* extension) { return cli::has_extension(path, extension); });
}

void Loading::outline(const Shot& shot, const Job& job) {
  if (!has_outline(shot)) return;
  try {
    Shot quick = shot;
    quick.load.decode_images = false;
    quick.load.texture_memory = 0;
    auto scene = std::make_shared<const Scene>(candela::load(quick.scene, nullptr, quick.load));
    if (!job.is_stopped()) mailbox_.post([this, scene] { told_.outlined(scene); });
  } catch (const Error&) {
    // What is wrong is told by whoever reads all of it.
  }
}

void Loading::load(Shot shot) {
  models_.ask([this, shot = std::move(shot)](const Job& job) {
    try {
      const StopScope scope(job.stop);
      outline(shot, job);
      auto model = std::make_shared<Model>(shot);
      StopScope::check();
      mailbox_.post([this, model] { told_.loaded(model); });
    } catch (const Interrupted&) {
      // Something else is wanted.
    } catch (const std::exception& error) {
      if (!job.is_stopped()) mailbox_.post([this, text = cli::one_line(error.what())] { told_.load_failed(text); });
    }
  });
}

void Loading::light(std::shared_ptr<Model> model, std::string name, fs::path cache, bool wants_plain) {
  lights_.ask(
      [this, model = std::move(model), name = std::move(name), cache = std::move(cache), wants_plain](const Job& job) {
        try {
          const StopScope scope(job.stop);
          const Scene& scene = *model->first();
          Diagnostics diagnostics;
          auto light = std::make_shared<FarLight>();
          light->name = name;
          light->environment = name.empty() ? default_light(scene, &diagnostics) : make_environment(name, &diagnostics);
          if (wants_plain) {
            auto plain = std::make_shared<FarLight>(*light);
            plain->baked = raster::bake_light_of(scene, plain_light(light->environment), {});
            plain->is_plain = true;
            StopScope::check();
            mailbox_.post([this, plain] { told_.lit(plain, {}); });
          }
          light->baked = raster::bake_light_of(scene, light->environment, cache);
          StopScope::check();
          mailbox_.post([this, light, warnings = diagnostics.warnings()] { told_.lit(light, warnings); });
        } catch (const Interrupted&) {
          // Something else is wanted.
        } catch (const std::exception& error) {
          if (!job.is_stopped())
            mailbox_.post([this, text = cli::one_line(error.what())] { told_.light_failed(text); });
        }
      });
}

void Loading::judge(const Model& model) {
  verdicts_.ask([this, name = model.name(), options = model.shot().load](const Job& job) {
    try {
      auto verdict = std::make_shared<Verdict>(candela::judge(name, options, job));
      if (!job.is_stopped()) mailbox_.post([this, verdict] { told_.judged(*verdict); });
    } catch (const Interrupted&) {
      // Something else is wanted.
    } catch (const std::exception& error) {
      auto verdict = std::make_shared<Verdict>();
      verdict->unreadable = cli::one_line(error.what());
      mailbox_.post([this, verdict] { told_.judged(*verdict); });
    }
  });
}

}  // namespace candela::viewer
