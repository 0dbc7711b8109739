#include "candela/scene_keep.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace candela {

void SceneKeep::set_capacity(std::size_t count) {
  capacity_ = count;
  while (kept_.size() > capacity_) kept_.pop_back();
}

std::shared_ptr<const Scene> SceneKeep::scene(const std::string& key, const std::function<Scene()>& make,
                                              Diagnostics* diagnostics) {
  const auto found = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& kept) { return kept.key == key; });
  if (found != kept_.end()) {
    kept_.splice(kept_.begin(), kept_, found);
    for (const Diagnostic& warning : kept_.front().warnings) {
      if (diagnostics != nullptr) diagnostics->warn(warning.message, warning.where);
    }
    return kept_.front().scene;
  }
  if (capacity_ == 0) return std::make_shared<const Scene>(make());
  while (kept_.size() >= capacity_) kept_.pop_back();  // before there is another
  const std::size_t told = diagnostics != nullptr ? diagnostics->warnings().size() : 0;
  Kept kept{.key = key, .scene = std::make_shared<const Scene>(make()), .warnings = {}, .tracer_key = {}, .tracer = {}};
  if (diagnostics != nullptr) {
    const auto& warnings = diagnostics->warnings();
    kept.warnings.assign(warnings.begin() + static_cast<std::ptrdiff_t>(told), warnings.end());
  }
  kept_.push_front(std::move(kept));
  return kept_.front().scene;
}

path::Tracer SceneKeep::tracer(const std::shared_ptr<const Scene>& scene, const std::string& key,
                               const std::function<path::Tracer()>& make) {
  const auto found = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& kept) { return kept.scene == scene; });
  if (found == kept_.end()) return make();
  if (!found->tracer || found->tracer_key != key) {
    found->tracer.reset();
    found->tracer.emplace(make());
    found->tracer_key = key;
  }
  return *found->tracer;
}

std::string scene_key(const std::vector<io::ReferencedFile>& files, const std::string& name,
                      const io::LoadOptions& options) {
  const auto measures = fmt::format("{} {}", options.measures.metres_per_unit.value_or(0.0f),
                                    options.measures.is_z_up ? static_cast<int>(*options.measures.is_z_up) : -1);
  std::string key = fmt::format("{}\n{}\n{}\n{}\n{} {} {}\n", name, options.variant, options.scene,
                                options.root.string(), measures, options.texture_memory, options.counts_texture_levels);
  for (const io::ReferencedFile& file : files) {
    std::error_code code;
    const auto time = std::filesystem::last_write_time(file.path, code).time_since_epoch().count();
    const auto size = std::filesystem::file_size(file.path, code);
    key += fmt::format("{} {} {}\n", file.path.string(), code ? 0 : time, code ? 0 : size);
  }
  return key;
}

}  // namespace candela
