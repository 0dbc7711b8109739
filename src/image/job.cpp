#include "image/job.h"

#include <utility>

namespace candela {

Job JobParts::part(std::size_t index, const std::string& prefix) const {
  Job job = whole_;
  job.partial = nullptr;
  if (!whole_.progress) return job;
  job.progress = [this, index, prefix](Progress p) {
    p.fraction = (static_cast<double>(index) + p.fraction) / static_cast<double>(count_);
    p.seconds = watch_.seconds();
    p.remaining_s = p.fraction > 0.0 ? std::optional(p.seconds * (1.0 - p.fraction) / p.fraction) : std::nullopt;
    p.what = prefix + p.what;
    whole_.progress(p);
  };
  return job;
}

}  // namespace candela
