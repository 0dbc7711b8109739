#include "candela/shot.h"

namespace candela {

const Environment& Stage::environment(const std::string& name, Diagnostics* diagnostics) {
  auto found = environments_.find(name);
  if (found == environments_.end()) {
    Loaded loaded;
    loaded.environment = make_environment(name, &loaded.diagnostics);
    found = environments_.emplace(name, std::move(loaded)).first;
  }
  if (diagnostics != nullptr) {
    for (const Diagnostic& warning : found->second.diagnostics.warnings()) {
      diagnostics->warn(warning.message, warning.where);
    }
  }
  return found->second.environment;
}

std::shared_ptr<raster::Device> Stage::device() {
  if (device_ == nullptr) device_ = std::make_shared<raster::Device>();
  return device_;
}

std::shared_ptr<const path::FarLight> Stage::far_light(const std::string& key, const Environment& environment) {
  if (far_light_ == nullptr || far_light_key_ != key) {
    far_light_.reset();  // before there is another
    far_light_ = std::make_shared<const path::FarLight>(environment);
    far_light_key_ = key;
  }
  return far_light_;
}

}  // namespace candela
