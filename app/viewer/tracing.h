#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "path/render.h"
#include "viewer/model.h"
#include "viewer/worker.h"

namespace candela::viewer {

/// A path traced picture as far as it has come.
struct Traced {
  DisplayImage image;
  std::uint64_t number = 0;          ///< of the look
  std::shared_ptr<const Film> film;  ///< of the size that was asked for; null of a first small look
  DevelopSettings develop;
  double samples = 0.0;  ///< of each pixel
  double seconds = 0.0;
  bool is_denoised = false;
};

/// The thread that traces paths. The picture of a look converges until another one is wanted; what comes of it is
/// posted.
class Tracing {
 public:
  struct Told {
    std::function<void(std::shared_ptr<const Traced>)> traced;
    std::function<void(std::string)> failed;  ///< one line
  };
  Tracing(Mailbox& mailbox, Told told) : mailbox_(mailbox), told_(std::move(told)) {}

  /// `exposure` is what the picture beside it has.
  void trace(Look look, int samples, std::optional<denoise::Method> denoiser);
  /// In place of what it is at: passes what `candela explain` says of a pixel, or why it says nothing.
  void explain(Look look, ivec2 pixel, std::function<void(std::string)> explained);
  void stop() { worker_.stop(); }
  bool is_busy() const { return worker_.is_busy(); }

 private:
  struct Prepared {
    std::shared_ptr<Model> model;
    Moment moment;
    std::shared_ptr<const FarLight> light;
    float rotation = 0.0f, intensity = 1.0f;
    std::shared_ptr<const Scene> scene;
  };
  void prepare(const Look& look);
  void converge(const Look& look, int samples, std::optional<denoise::Method> denoiser, const Job& job);
  void tell(const Look& look, Film film, double samples, double seconds, std::optional<denoise::Method> denoiser,
            bool is_whole, const Job& job);

  Mailbox& mailbox_;
  Told told_;

  // ----- of the thread
  std::unique_ptr<path::Tracer> tracer_;
  std::unique_ptr<path::FarLight> far_light_;
  Prepared prepared_;

  Worker worker_;  ///< last, so that it ends first
};

}  // namespace candela::viewer
