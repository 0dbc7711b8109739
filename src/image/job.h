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

/// The progress of a long operation.
struct Progress {
  double fraction = 0.0;                   ///< of the work; estimated if a time or noise limit ends it
  double seconds = 0.0;                    ///< since the start
  std::optional<double> remaining_s = {};  ///< if it can be estimated
  std::string what = {};                   ///< the current step, in a few words
  double samples_per_pixel = 0.0;          ///< of the picture so far, if one is path traced
};

/// Connects a long operation with its caller: rendering by either engine, baking, probes, measuring, figures, checking.
/// All members may be empty.
struct Job {
  std::function<void(const Progress&)> progress = {};  ///< one call at a time, a few per second
  /// The picture so far, if there is one: called every `partial_interval_s`, on the thread that started the work.
  std::function<void(Film)> partial = {};
  double partial_interval_s = 5.0;
  /// Set to end early. Pictures are returned as they are, and their statistics say so; all else throws Interrupted.
  const std::atomic<bool>* stop = nullptr;
  Diagnostics* diagnostics = nullptr;

  bool is_stopped() const { return stop != nullptr && stop->load(); }
  void report(const Progress& p) const {
    if (progress) progress(p);
  }
};

/// Splits work into equal parts, done one after the other, each with its own job without partial pictures.
class JobParts {
 public:
  /// `whole` must outlive it; it must outlive its parts.
  JobParts(const Job& whole, std::size_t count) : whole_(whole), count_(count) {}
  /// Its progress text follows `prefix`.
  Job part(std::size_t index, const std::string& prefix = {}) const;

 private:
  const Job& whole_;
  std::size_t count_;
  Stopwatch watch_;
};

}  // namespace candela
