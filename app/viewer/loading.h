#pragma once

#include <functional>
#include <memory>
#include <string>

#include "candela/verdict.h"
#include "viewer/model.h"
#include "viewer/worker.h"

namespace candela::viewer {

/// Reads models and environments, bakes light and judges assets, each in a thread of its own. What comes of it is
/// posted; asking again stops what is under way.
class Loading {
 public:
  struct Told {
    /// Meshes and cameras of a model whose images are still being read.
    std::function<void(std::shared_ptr<const Scene>)> outlined;
    std::function<void(std::shared_ptr<Model>)> loaded;
    std::function<void(std::string)> load_failed;  ///< one line
    std::function<void(std::shared_ptr<const FarLight>, std::vector<Diagnostic>)> lit;
    std::function<void(std::string)> light_failed;  ///< one line
    std::function<void(Verdict)> judged;
  };
  Loading(Mailbox& mailbox, Told told) : mailbox_(mailbox), told_(std::move(told)) {}

  void load(Shot shot);
  /// The light of that name (empty: the model's own, or what it wishes for); where nothing else lights the model
  /// meanwhile, first a plain one.
  void light(std::shared_ptr<Model> model, std::string name, std::filesystem::path cache, bool wants_plain);
  void judge(const Model& model);

  bool is_loading() const { return models_.is_busy(); }
  bool is_lighting() const { return lights_.is_busy(); }
  bool is_judging() const { return verdicts_.is_busy(); }
  void stop_lighting() { lights_.stop(); }

 private:
  void outline(const Shot& shot, const Job& job);

  Mailbox& mailbox_;
  Told told_;
  Worker models_, lights_, verdicts_;
};

/// Whether a file is taken for an environment, by its name.
bool is_environment_file(const std::string& path);

}  // namespace candela::viewer
