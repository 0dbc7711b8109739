#pragma once

#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <string>

#include "base/diagnostics.h"
#include "io/gltf.h"
#include "path/render.h"
#include "scene/scene.h"

namespace candela {

/// The scenes of the last few shots and what was built of them, for shots that want the same again.
class SceneKeep {
 public:
  /// How many are kept; 0, the default, keeps none.
  void set_capacity(std::size_t count);

  /// The scene of that key: the one that is kept, whose warnings are told again, or else what `make` returns, which may
  /// add to `diagnostics`.
  std::shared_ptr<const Scene> scene(const std::string& key, const std::function<Scene()>& make,
                                     Diagnostics* diagnostics);
  /// What was built of a scene that is kept, under light and shading that `key` names; or else what `make` returns.
  path::Tracer tracer(const std::shared_ptr<const Scene>& scene, const std::string& key,
                      const std::function<path::Tracer()>& make);

 private:
  struct Kept {
    std::string key;
    std::shared_ptr<const Scene> scene;
    std::vector<Diagnostic> warnings;
    std::string tracer_key;
    std::optional<path::Tracer> tracer;
  };
  std::list<Kept> kept_;  ///< the last one used first
  std::size_t capacity_ = 0;
};

/// A text that differs where the files of a scene have changed or are loaded otherwise.
std::string scene_key(const std::vector<io::ReferencedFile>& files, const std::string& name,
                      const io::LoadOptions& options);

}  // namespace candela
