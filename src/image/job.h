#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>

#include "base/diagnostics.h"
#include "base/stopwatch.h"
#include "image/film.h"

namespace candela {

/// How far a long work is.
struct Progress {
  double fraction = 0.0;                   ///< of the work; estimated where a time or noise limit ends it
  double seconds = 0.0;                    ///< since it began
  std::optional<double> remaining_s = {};  ///< where that can be told
  std::string what = {};                   ///< is being done, in a few words
  double samples_per_pixel = 0.0;          ///< of the picture so far, where one is path traced
};

/// What a long work and whoever waits for it share: rendering by either engine, baking, probes, measuring, figures,
/// judging. Empty, nobody waits.
struct Job {
  std::function<void(const Progress&)> progress = {};  ///< one call at a time, a few in a second
  /// The picture so far, where a work has one: every `partial_interval_s`, from the thread that began the work.
  std::function<void(Film)> partial = {};
  double partial_interval_s = 5.0;
  /// Set to end early. Pictures end with what there is, which their statistics tell; all else throws Interrupted.
  const std::atomic<bool>* stop = nullptr;
  Diagnostics* diagnostics = nullptr;

  bool is_stopped() const { return stop != nullptr && stop->load(); }
  void report(const Progress& p) const {
    if (progress) progress(p);
  }
};

/// Work in equal parts, one after the other, each a job of its own that has no partial pictures.
class JobParts {
 public:
  /// `whole` must outlive it; it must outlive its parts.
  JobParts(const Job& whole, std::size_t count) : whole_(whole), count_(count) {}
  /// What it does is told after `prefix`.
  Job part(std::size_t index, const std::string& prefix = {}) const;

 private:
  const Job& whole_;
  std::size_t count_;
  Stopwatch watch_;
};

}  // namespace candela
