#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "base/diagnostics.h"
#include "base/error.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "candela/candela.h"
#include "candela/shot.h"
#include "cli/films.h"
#include "cli/interrupt.h"
#include "cli/jobs.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/render_outputs.h"
#include "cli/render_statistics.h"
#include "cli/threads.h"
#include "cli/values.h"
#include "cli/verbs.h"
#include "image/image_file.h"
#include "io/camera_file.h"

namespace candela::cli {

namespace fs = std::filesystem;

namespace {

/// A picture that cannot be held is refused here, not by the system in the middle of the work.
void check_memory(const RenderOptions& o) {
  const ivec2 size = o.shot.size;
  std::uint64_t writing = 0;
  for (const std::string& output : o.outputs) {
    writing = std::max(writing, writing_bytes(output, size.x, size.y, o.shot.layers));
  }
  require_memory(picture_bytes(o.shot) + writing, available_memory(), fmt::format("a picture of {}x{}", size.x, size.y),
                 "--size");
}

void warn_of_formats(const RenderOptions& o, Diagnostics& diagnostics) {
  for (const fs::path output : o.outputs) {
    // With --noise they say where samples go.
    if (is_linear_format(output) && o.develop_given && !o.shot.traced.noise) {
      diagnostics.warn("--exposure, --tonemap and --bloom have no effect on linear radiance", output.string());
    }
    if (o.background.color && has_extension(output, ".hdr")) {
      diagnostics.warn("--background's colour has no effect on linear radiance, and this format has no transparency",
                       output.string());
    }
    const bool keeps_alpha = has_extension(output, ".png") || has_extension(output, ".webp") ||
                             has_extension(output, ".exr") || has_extension(output, ".part") ||
                             (is_film(o, output.string()) && !has_extension(output, ".mp4"));
    const bool has_alpha = !o.background.color || o.background.opacity < 1.0f;
    if (o.background.kind == Background::transparent && has_alpha && !keeps_alpha) {
      diagnostics.warn("this format has no transparency", output.string());
    }
  }
}

/// With --strict the first warning is the error that ends the work; `shown` of them were printed already.
void report_warnings(const RenderOptions& o, const Diagnostics& diagnostics, std::size_t shown,
                     ProgressLine& progress) {
  const auto& warnings = diagnostics.warnings();
  const bool fails = o.strict && shown < warnings.size();
  for (std::size_t i = fails ? shown + 1 : shown; i < warnings.size(); ++i) progress.warn(warnings[i]);
  if (!fails) return;
  const std::size_t more = warnings.size() - shown - 1;
  throw Error(warnings[shown].message + (more > 0 ? fmt::format(" (--strict; and {} more)", more) : " (--strict)"),
              warnings[shown].where);
}

/// The picture so far, on disk: what is there when the machine goes down. Its cost is bounded by a twentieth of the
/// time.
class PartialWriter {
 public:
  explicit PartialWriter(ProgressLine& progress) : progress_(progress) {}

  void write(const std::vector<fs::path>& outputs, const Film& film, const DevelopSettings& develop) {
    constexpr double kShareOfTime = 0.05;
    const bool is_shown = std::any_of(outputs.begin(), outputs.end(), [](const fs::path& output) {
      return is_device(output) || !standard_output_format(output.string()).empty();
    });
    if (disabled_ || is_shown || since_last_.seconds() < last_cost_s_ / kShareOfTime) return;
    const Stopwatch cost;
    try {
      write_outputs(outputs, film, develop);
    } catch (const Error& error) {
      disabled_ = true;  // the end may go better; say it once
      progress_.warn({error.message(), error.where()});
    }
    last_cost_s_ = cost.seconds();
    since_last_ = {};
  }

 private:
  ProgressLine& progress_;
  Stopwatch since_last_;
  double last_cost_s_ = 0.0;
  bool disabled_ = false;
};

std::string traced_text(const fs::path& output, const TakenPicture& picture, double total_s) {
  const path::Statistics& s = picture.traced;
  return fmt::format("{}{}: {}x{}, {:.4g} samples per pixel in {}, {:.2f} Msamples/s",
                     s.interrupted ? "interrupted, " : "", output.string(), picture.film.width(), picture.film.height(),
                     s.mean_samples_per_pixel, duration_text(total_s),
                     static_cast<double>(s.samples) / std::max(s.render_s, 1e-9) * 1e-6);
}

std::string drawn_text(const std::string& output, const RenderOptions& o, const TakeResult& result, double total_s) {
  const raster::Statistics& s = result.drawn;
  return fmt::format("{}{}: {}x{}, {} {} in {}, {} each, on {}", result.interrupted ? "interrupted, " : "", output,
                     o.shot.size.x, o.shot.size.y, s.frames, s.frames == 1 ? "frame" : "frames", duration_text(total_s),
                     duration_text(s.frame_s / s.frames), s.driver);
}

/// From where the pictures are taken, each known by the name of its first file.
void write_cameras(const RenderOptions& o, const Take& take, const PictureNames& names) {
  if (!o.written_cameras) return;
  const fs::path folder = fs::absolute(*o.written_cameras).parent_path();
  std::vector<PosedCamera> cameras;
  const std::vector<View> views = take.views();
  for (std::size_t i = 0; i < views.size(); ++i) {
    const fs::path& picture = names[i][0];
    cameras.push_back(
        {.name = picture.stem().string(),
         .view = views[i],
         .size = o.shot.size,
         .picture = fs::absolute(picture).lexically_normal().lexically_relative(folder.lexically_normal())});
  }
  io::write_cameras(*o.written_cameras, cameras, o.shot.size);
}

std::vector<fs::path> stills_of(const RenderOptions& o, const std::vector<fs::path>& names) {
  std::vector<fs::path> stills;
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (!is_film(o, o.outputs[k])) stills.push_back(names[k]);
  }
  return stills;
}

/// A picture that was stopped half-way is no part of a film.
void add_to_films(const RenderOptions& o, const Take& take, const TakenPicture& picture,
                  const std::vector<fs::path>& names, Films& films) {
  std::optional<DisplayImage> shown;
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (!is_film(o, o.outputs[k]) || (!picture.is_whole() && picture.index > 0)) continue;
    if (!shown) shown = develop(picture.film, picture.develop);
    films.add(names[k], *shown, take.real_time_rate(picture.index));
  }
}

/// Returns how long it took.
double finish_films(Films& films, const Stopwatch& total, ProgressLine& progress) {
  const Stopwatch watch;
  for (const std::string& line : films.finish()) {
    progress.line(fmt::format("{}, in {}", line, duration_text(total.seconds())));
  }
  return watch.seconds();
}

void write_made_part(const fs::path& output, const PicturePart& part) {
  const FolderFor folder(output);
  write_part(output, part);
}

/// What the commands of a list have in common; a command alone is a list of one.
struct Run {
  std::shared_ptr<Stage> stage = std::make_shared<Stage>();
  Inputs inputs;                  ///< and what earlier commands have written
  std::vector<fs::path> written;  ///< by the command at hand
};

/// Where the pictures of a scene stand in a data set.
struct DatasetPlace {
  Dataset* dataset = nullptr;  ///< null: there is none
  std::size_t scene = 0;
};

/// `prefix` tells which of several scenes it is.
TakeResult render_scene(const RenderOptions& given, Run& run, int threads, ProgressLine& progress,
                        DatasetPlace place = {}, const std::string& prefix = {}, Job job = {}) {
  const Stopwatch total;
  RenderOptions o = given;
  // What is wrong with a name that was given is told before anything is loaded.
  if (!o.has_default_name) check_overwriting(o, name_pictures(o, labels_before_loading(o.shot)), run.inputs);
  check_paths(o);
  progress.phase(prefix + "loading " + o.shot.scene);
  Diagnostics diagnostics;
  Take take(o.shot, &diagnostics, run.stage);
  run.inputs.add(take.files());
  choose_default_name(o, take.labels(), run.inputs);
  const PictureNames names = name_pictures(o, take.labels());
  check_overwriting(o, names, run.inputs);
  const std::vector<fs::path> written = written_files(o, names);
  run.written.insert(run.written.end(), written.begin(), written.end());
  take.prepare();
  if (o.checkpoint) take.set_checkpoint({.file = *o.checkpoint, .resumes = o.resumes});
  if (place.dataset != nullptr) place.dataset->check(take.views());
  warn_of_formats(o, diagnostics);
  Times times{.load_s = total.seconds()};
  report_warnings(o, diagnostics, 0, progress);
  const std::size_t reported = diagnostics.warnings().size();
  write_cameras(o, take, names);

  const bool is_raster = o.shot.engine == Engine::raster;
  progress.phase(prefix + (is_raster ? "drawing" : "building"));
  const Interrupt interrupt;
  PartialWriter partial(progress);
  Films films(o);
  std::size_t index = o.shot.pictures ? o.shot.pictures->first - 1 : 0;
  if (!job.progress) job = progress.job();
  if (!o.shot.part)
    job.partial = [&](const Film& film) { partial.write(stills_of(o, names[index]), film, take.develop()); };
  TakeResult result = take.render(
      [&](const TakenPicture& picture) {
        const Stopwatch writing;
        const std::vector<fs::path>& outputs = names[picture.index];
        index = picture.index + 1;
        const std::vector<fs::path> stills = stills_of(o, outputs);
        if (picture.part) {
          for (const fs::path& output : stills) write_made_part(output, *picture.part);
        } else {
          write_outputs(stills, picture.film, picture.develop);
        }
        add_to_films(o, take, picture, outputs, films);
        if (place.dataset != nullptr) place.dataset->add(picture, outputs[0], place.scene, o.stems[place.scene]);
        times.write_s += writing.seconds();
        times.total_s = total.seconds();
        for (const fs::path& output : stills) {
          if (!is_raster) progress.line(traced_text(output, picture, times.total_s));
        }
      },
      job);
  times.write_s += finish_films(films, total, progress);
  if (o.checkpoint && !result.interrupted) {
    std::error_code code;
    fs::remove(*o.checkpoint, code);  // the picture is there
  }
  times.denoise_s = result.denoise_s;
  times.total_s = total.seconds();
  if (is_raster) {
    for (const std::string& output : o.outputs) {
      if (!is_film(o, output)) progress.line(drawn_text(output, o, result, times.total_s));
    }
  } else {
    warn_of_noise(o, result.traced, diagnostics);
  }
  if (o.stats) {
    write_stats(o, is_raster ? stats_json(o, result.drawn, times, diagnostics)
                             : stats_json(o, result.traced, times, threads, diagnostics));
  }
  report_warnings(o, diagnostics, reported, progress);
  return result;
}

/// A set that was stopped is not what was asked for, unlike one picture, which is there with fewer samples.
void report_interruption(std::size_t done, std::size_t asked, bool is_last_unfinished) {
  throw Interrupted(
      fmt::format("{} of {} pictures are there{}", done, asked, is_last_unfinished ? ", the last one unfinished" : ""));
}

/// A picture of each scene, whatever becomes of the others; throws at the end when one has none.
void render_batch(const RenderOptions& o, Run& run, int threads, ProgressLine& progress, Dataset* dataset) {
  const fs::path folder = o.outputs[0];
  check_writable(folder / "NAME.png");
  // The picture of one scene must not be a texture of the next.
  add_scene_files(o.scenes, o.shot.load.root, run.inputs);
  const std::vector<fs::path> outputs = batch_outputs(o.stems, folder, run.inputs);
  std::size_t failed = 0, done = 0;
  bool is_last_unfinished = false;
  const PictureRange asked = o.pictures.value_or(PictureRange{1, o.scenes.size()});
  const Job whole = progress.job();
  const JobParts parts(whole, asked.count());
  for (std::size_t i = asked.first - 1; i < asked.last && !Interrupt::requested(); ++i) {
    RenderOptions one = o;
    one.shot.scene = o.scenes[i];
    if (dataset != nullptr) {
      const bool has_many = o.shot.has_many_pictures();
      const std::string stem = without_placeholders(outputs[i].stem().string());
      one.outputs = {
          dataset->pattern(i, o.scenes.size(), has_many ? literal_in_pattern(stem) : stem, has_many).string()};
    } else {
      one.outputs = {batch_pattern(o, outputs[i])};
    }
    try {
      const std::string prefix = fmt::format("scene {} of {}, ", i + 1, o.scenes.size());
      const TakeResult result =
          render_scene(one, run, threads, progress, {dataset, i}, prefix, parts.part(i + 1 - asked.first, prefix));
      done += result.done;
      is_last_unfinished = result.is_last_unfinished;
    } catch (const Error& error) {
      if (o.scenes.size() == 1) throw;
      ++failed;
      progress.failed({error.message(), error.where()});
    }
  }
  const bool is_cut_short = is_last_unfinished || done + failed < asked.count();
  if (is_cut_short && asked.count() > 1) report_interruption(done, asked.count(), is_last_unfinished);
  if (failed > 0) throw Error(fmt::format("{} of {} scenes have no picture", failed, asked.count()), folder.string());
}

void render_all(const RenderOptions& o, Run& run, int threads, ProgressLine& progress, Dataset* dataset) {
  run.inputs.add(inputs_of_options(o));
  if (o.is_batch) return render_batch(o, run, threads, progress, dataset);
  const TakeResult result = render_scene(o, run, threads, progress, {dataset, 0});
  if (!o.shot.has_many_pictures() || !result.interrupted) return;
  const bool is_in_film_alone =
      std::all_of(o.outputs.begin(), o.outputs.end(), [&](const std::string& output) { return is_film(o, output); });
  const bool is_last_kept = !is_in_film_alone || result.done == 1;  // as in add_to_films()
  if (result.is_last_unfinished && !is_last_kept) return report_interruption(result.done - 1, result.asked, false);
  report_interruption(result.done, result.asked, result.is_last_unfinished);
}

void run_render(const RenderOptions& o, Run& run) {
  ProgressLine progress(o.quiet);
  check_memory(o);
  const Threads threads(o.threads);
  const bool is_set = o.shot.has_many_pictures() || o.scenes.size() > 1;
  std::optional<Interrupt> between;
  if (is_set) between.emplace();
  if (!o.dataset) return render_all(o, run, threads.threads(), progress, nullptr);
  Diagnostics diagnostics;
  Dataset dataset(*o.dataset, o.dataset_folder, *o.instances, &diagnostics);
  try {
    render_all(o, run, threads.threads(), progress, &dataset);
  } catch (...) {
    dataset.finish();  // of the pictures that are there
    throw;
  }
  dataset.finish();
  report_warnings(o, diagnostics, 0, progress);
}

/// What the lines of a list read, as far as they can be understood before their turn.
Inputs inputs_of_jobs(const std::string& list) {
  Inputs inputs;
  std::set<std::pair<std::string, fs::path>> seen;
  std::ifstream lines(list);
  for (std::string line; !Interrupt::requested() && std::getline(lines, line);) {
    try {
      const std::vector<std::string> words = without_verb(words_of(line));
      if (words.empty()) continue;
      const RenderOptions o = parse_job(words, list);
      inputs.add(inputs_of_options(o));
      for (const std::string& scene : o.scenes) {
        if (seen.emplace(scene, o.shot.load.root).second) add_scene_files({scene}, o.shot.load.root, inputs);
      }
    } catch (const std::exception&) {
      // Told when it is its turn.
    }
  }
  return inputs;
}

/// Each line is a command line of its own; what they load is shared.
void render_jobs(const RenderOptions& given) {
  constexpr std::size_t kModels = 4;  // lists often come back to one; more would fill the memory
  Run run;
  run.stage->scenes().set_capacity(kModels);
  ProgressLine progress(given.quiet);
  const Interrupt interrupt;
  // The picture of one job must not be a texture of the next. What is not there yet, an earlier one may make for it.
  std::error_code ignored;
  const bool can_be_read_twice = given.jobs != "-" && fs::is_regular_file(given.jobs, ignored);
  if (can_be_read_twice) run.inputs.add_existing(inputs_of_jobs(given.jobs));
  const auto render = [&](const std::vector<std::string>& words) {
    run.written.clear();
    run_render(parse_job(words, given.jobs, given.quiet), run);
    // Of a job that failed the next one may be another attempt.
    for (const fs::path& file : run.written) run.inputs.add_written(file, "written by an earlier job");
  };
  run_jobs(given.jobs, render, progress);
}

}  // namespace

Verb add_render(Command& command) {
  const auto options = std::make_shared<RenderOptions>();
  add_render_options(command, *options);
  return [options, &command] {
    if (options->jobs.empty()) {
      finish_options(command, *options);
      Run run;
      return run_render(*options, run);
    }
    for (const std::string& name : command.given()) {
      const bool counts = name == "--jobs" || name == "--quiet";
      if (!counts) throw UsageError(name + ": --jobs takes it from each line of " + options->jobs);
    }
    render_jobs(*options);
  };
}

}  // namespace candela::cli
