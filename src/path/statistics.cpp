#include "path/statistics.h"

#include <algorithm>

namespace candela::path {

void add_work(const Statistics& picture, Statistics& all) {
  all.build_s += picture.build_s;
  all.render_s += picture.render_s;
  all.samples += picture.samples;
  all.spared_samples += picture.spared_samples;
  all.camera_rays += picture.camera_rays;
  all.bounce_rays += picture.bounce_rays;
  all.shadow_rays += picture.shadow_rays;
  all.non_finite_samples += picture.non_finite_samples;
  all.triangles = picture.triangles;
  all.instances = picture.instances;
  all.interrupted |= picture.interrupted;
  all.timed_out |= picture.timed_out;
  if (!picture.noise) return;
  if (!all.noise) all.noise.emplace();
  all.noise->share_above = std::max(all.noise->share_above, picture.noise->share_above);
  all.noise->worst = std::max(all.noise->worst, picture.noise->worst);
}

}  // namespace candela::path
