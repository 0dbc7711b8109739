#include "path/guide_training.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "base/parallel.h"

namespace candela::path {

namespace {

constexpr std::uint32_t kSalt = 0x6775'6964;

/// The trial: some pixels, each measured twice by as many samples.
constexpr std::size_t kTrialPixels = 512;
constexpr std::uint32_t kTrialSamples = 32;

/// Paths in a row, of which the records stay together.
constexpr std::size_t kBatch = 512;

struct Stopped {};

struct Trial {
  double error = 0.0;     ///< mean over the pixels of what two measurements differ by, squared, over what is there
  double indirect = 0.0;  ///< the same of indirect light alone
  double variance = 0.0;  ///< of the samples' indirect light, likewise
  double cost = 0.0;      ///< rays
};

struct TrialPixel {
  std::array<double, 2> light{};  ///< of both measurements
  std::array<double, 2> indirect{};
  double indirect2 = 0.0;  ///< mean square of the samples
};

class Trainer {
 public:
  Trainer(const GuideTask& task, const Job& job) : task_(task), job_(job), context_(task.context) {}

  LearnedGuide run();

 private:
  struct Batch {
    std::vector<GuideRecord> records;
    RayCounts counts;
  };

  PathSample trace(vec2 film, SobolSampler& sampler, Batch& batch) const;
  template <typename Body>
  void run_batches(std::size_t count, GuideLearner& learner, const Body& body);
  Trial measure(const Guide& guide, GuideLearner& learner);
  void train(std::size_t paths, std::uint32_t round, GuideLearner& learner);
  std::size_t budget() const;

  const GuideTask& task_;
  const Job& job_;
  PathContext context_;
  LearnedGuide result_;
};

PathSample Trainer::trace(vec2 film, SobolSampler& sampler, Batch& batch) const {
  const vec2 u_lens = task_.camera.has_lens() ? sampler.next_2d() : vec2(0.5f);
  const Ray ray = task_.camera.generate(film, u_lens).ray;
  ++batch.counts.camera;
  const Hit hit = context_.geometry.intersect(ray, sampler.next_hash());
  return trace_path_recorded(context_, ray, hit, sampler, batch.counts, batch.records);
}

/// `body(i, batch)` for every i below `count`; what the batches record is added in their order.
template <typename Body>
void Trainer::run_batches(std::size_t count, GuideLearner& learner, const Body& body) {
  constexpr std::size_t kTogether = 64;
  std::vector<Batch> batches(kTogether);
  for (std::size_t begin = 0; begin < count; begin += kTogether) {
    if (job_.is_stopped()) throw Stopped();
    const std::size_t together = std::min(kTogether, count - begin);
    parallel_for(0, together, 1, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        batches[i].records.clear();
        batches[i].counts = {};
        body(begin + i, batches[i]);
      }
    });
    for (std::size_t i = 0; i < together; ++i) {
      learner.add(batches[i].records);
      result_.counts.camera += batches[i].counts.camera;
      result_.counts.bounce += batches[i].counts.bounce;
      result_.counts.shadow += batches[i].counts.shadow;
    }
  }
}

/// Where little light is, an error counts less than in proportion.
Trial compare(const std::vector<TrialPixel>& pixels) {
  double mean = 0.0;
  for (const TrialPixel& p : pixels) mean += 0.5 * (p.light[0] + p.light[1]);
  mean /= static_cast<double>(pixels.size());
  const double least = 0.1 * mean;
  Trial trial;
  for (const TrialPixel& p : pixels) {
    const double light = 0.5 * (p.light[0] + p.light[1]), indirect = 0.5 * (p.indirect[0] + p.indirect[1]);
    const double scale = 1.0 / std::max(light * light + least * least, 1e-30);
    const double all = p.light[0] - p.light[1], part = p.indirect[0] - p.indirect[1];
    trial.error += scale * all * all;
    trial.indirect += scale * part * part;
    trial.variance += scale * std::max(p.indirect2 - indirect * indirect, 0.0);
  }
  return trial;
}

/// A batch for some pixels that are spread evenly over the film.
Trial Trainer::measure(const Guide& guide, GuideLearner& learner) {
  constexpr std::size_t kPixels = kBatch / (2 * kTrialSamples);
  context_.guide = &guide;
  std::vector<TrialPixel> pixels(kTrialPixels);
  const RayCounts before = result_.counts;
  run_batches(kTrialPixels / kPixels, learner, [&](std::size_t index, Batch& batch) {
    for (std::size_t k = index * kPixels; k < (index + 1) * kPixels; ++k) {
      SobolSampler place(hash_combine(task_.seed, kSalt), static_cast<std::uint32_t>(k));
      const vec2 corner = glm::floor(place.next_2d() * vec2(task_.width, task_.height));
      for (std::uint32_t half = 0; half < 2; ++half) {
        const std::uint32_t seed = hash_combine(hash_combine(task_.seed ^ kSalt, static_cast<std::uint32_t>(k)), half);
        for (std::uint32_t s = 0; s < kTrialSamples; ++s) {
          SobolSampler sampler(seed, s);
          const PathSample sample = trace(corner + sampler.next_2d(), sampler, batch);
          const float light = luminance(sample.radiance);
          if (!std::isfinite(light)) continue;
          const auto indirect = static_cast<double>(luminance(sample.indirect));
          pixels[k].light[half] += static_cast<double>(light) / kTrialSamples;
          pixels[k].indirect[half] += indirect / kTrialSamples;
          pixels[k].indirect2 += indirect * indirect / (2 * kTrialSamples);
        }
      }
    }
  });
  result_.paths += 2 * kTrialPixels * kTrialSamples;
  Trial trial = compare(pixels);
  const RayCounts& after = result_.counts;
  trial.cost =
      static_cast<double>(after.bounce - before.bounce + after.shadow - before.shadow + after.camera - before.camera);
  return trial;
}

void Trainer::train(std::size_t paths, std::uint32_t round, GuideLearner& learner) {
  const std::uint32_t seed = hash_combine(hash_combine(task_.seed, kSalt), round);
  run_batches(paths / kBatch, learner, [&](std::size_t index, Batch& batch) {
    for (std::size_t k = 0; k < kBatch; ++k) {
      SobolSampler sampler(seed, static_cast<std::uint32_t>(index * kBatch + k));
      trace(sampler.next_2d() * vec2(task_.width, task_.height), sampler, batch);
    }
  });
  result_.paths += paths;
}

/// Most paths to learn from: what a guide can know does not grow with the picture for long.
std::size_t Trainer::budget() const {
  constexpr std::size_t kLeast = 3U << 14, kMost = 1U << 20, kPerPixel = 6;
  const std::size_t pixels = static_cast<std::size_t>(task_.width) * static_cast<std::size_t>(task_.height);
  return std::clamp(kPerPixel * pixels, kLeast, kMost);
}

/// A guide changes the noise of indirect light; by how much, all samples tell, and not just two means.
bool pays(const Trial& without, const Trial& with) {
  constexpr double kOverhead = 1.2;  // what a ray costs that is led, over one that is not
  constexpr double kGain = 0.85;     // to be sure of it
  const double share = std::min(without.indirect / without.error, 1.0);
  const double left = 1.0 - share + share * with.variance / without.variance;
  return left * with.cost * kOverhead < kGain * without.cost;
}

LearnedGuide Trainer::run() {
  constexpr double kLeastIndirect = 0.5;  // of the error: a guide takes some of it at most
  constexpr std::size_t kFirstRound = 1U << 14;

  const bool has_sky = task_.context.lights.environment().can_sample();
  auto guide = std::make_unique<Guide>(task_.context.geometry.bounds());
  std::optional<GuideLearner> learner(std::in_place, *guide, has_sky);
  Trial without;
  if (task_.is_forced) {
    context_.guide = guide.get();
    train(kFirstRound, 0, *learner);
  } else {
    without = measure(*guide, *learner);
  }
  if (!task_.is_forced && !(without.indirect > kLeastIndirect * without.error)) return std::move(result_);

  // ----- each round twice the one before, led by what that has learned
  std::uint32_t round = 0;
  for (std::size_t paths = kFirstRound, left = budget(); paths <= left; left -= paths, paths *= 2) {
    auto next = std::make_unique<Guide>(learner->next());
    learner.emplace(*next, has_sky);
    guide = std::move(next);
    context_.guide = guide.get();
    train(paths, ++round, *learner);
  }
  auto last = std::make_unique<Guide>(learner->next());
  learner.emplace(*last, has_sky);
  const Trial with = measure(*last, *learner);
  if (task_.is_forced || pays(without, with)) result_.guide = std::move(last);
  return std::move(result_);
}

}  // namespace

LearnedGuide learn_guide(const GuideTask& task, const Job& job) {
  try {
    return Trainer(task, job).run();
  } catch (const Stopped&) {
    LearnedGuide stopped;
    stopped.is_stopped = true;
    return stopped;
  }
}

}  // namespace candela::path
