#pragma once

#include <memory>

#include "image/job.h"
#include "path/camera.h"
#include "path/guide.h"
#include "path/integrator.h"

namespace candela::path {

/// A picture that a guide is wanted for.
struct GuideTask {
  const PathContext& context;  ///< without a guide
  const Camera& camera;
  int width = 0;
  int height = 0;
  std::uint32_t seed = 0;
  bool is_forced = false;  ///< without asking whether it pays
};

struct LearnedGuide {
  std::unique_ptr<const Guide> guide;  ///< null where following the material does as well
  RayCounts counts;                    ///< of what it took
  std::uint64_t paths = 0;
  bool is_stopped = false;  ///< by the job, before an answer was found
};

/// Learns from paths of its own, which no picture shows; the result depends on the task alone, not on the number of
/// threads. Whether guiding pays is measured: the error of some pixels, with and without, times the rays of each.
LearnedGuide learn_guide(const GuideTask& task, const Job& job);

}  // namespace candela::path
