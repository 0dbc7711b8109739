#include "cli/render_outputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <span>
#include <string_view>

#include "base/error.h"
#include "base/file.h"
#include "base/text.h"
#include "candela/viewpoint.h"
#include "cli/films.h"
#include "cli/output.h"

namespace candela::cli {

namespace fs = std::filesystem;

namespace {

/// A placeholder of a name, and what of a picture stands there.
struct Placeholder {
  std::string_view text;
  std::string PictureLabel::*part;
  const char* option;
};
constexpr std::array<Placeholder, 4> kPlaceholders{{{"{variant}", &PictureLabel::variant, "--variants"},
                                                    {"{animation}", &PictureLabel::animation, "--animations"},
                                                    {"{view}", &PictureLabel::view, "--views"},
                                                    {"{camera}", &PictureLabel::camera, "--cameras"}}};

/// Whether the pictures of a shot may differ in this.
bool is_varied(const Shot& shot, const Placeholder& placeholder) {
  if (placeholder.part == &PictureLabel::variant) return shot.variants.has_value();
  if (placeholder.part == &PictureLabel::animation) return shot.animations.has_value();
  if (placeholder.part == &PictureLabel::view) return !shot.views.empty();
  return shot.camera_sphere || !shot.cameras.empty();
}
bool is_varied_often(const Shot& shot, const Placeholder& placeholder) {
  if (placeholder.part == &PictureLabel::view) return shot.views.size() > 1;
  if (placeholder.part == &PictureLabel::camera) return shot.camera_sphere || shot.cameras.size() > 1;
  return is_varied(shot, placeholder);
}

/// A name out of a scene as part of a file's name: without what is a folder, or no name on some system.
std::string file_part(const std::string& name) {
  constexpr std::string_view kUnfit = "/\\:*?\"<>|";
  std::string part;
  for (const char c : name) {
    const bool fits = static_cast<unsigned char>(c) >= 0x20 && kUnfit.find(c) == std::string_view::npos;
    part += fits ? c : '-';
  }
  return part.empty() ? "unnamed" : part;
}

const Placeholder* placeholder_at(const std::string& name, std::size_t i) {
  const std::string_view rest = std::string_view(name).substr(i);
  const auto found = std::find_if(kPlaceholders.begin(), kPlaceholders.end(),
                                  [&](const Placeholder& placeholder) { return rest.starts_with(placeholder.text); });
  return found == kPlaceholders.end() ? nullptr : &*found;
}

/// The placeholder that a name shows at `i` as it is: {{view} is {view}.
const Placeholder* literal_at(const std::string& name, std::size_t i) {
  return name[i] == '{' ? placeholder_at(name, i + 1) : nullptr;
}

bool has_placeholder(const std::string& name, const Placeholder& placeholder) {
  for (std::size_t i = 0; i < name.size(); ++i) {
    if (literal_at(name, i) != nullptr) {
      ++i;
    } else if (placeholder_at(name, i) == &placeholder) {
      return true;
    }
  }
  return false;
}

std::string filled(const std::string& name, const Shot& shot, const PictureLabel& label) {
  std::string text;
  for (std::size_t i = 0; i < name.size();) {
    if (const Placeholder* literal = literal_at(name, i)) {
      text += literal->text;
      i += 1 + literal->text.size();
      continue;
    }
    const Placeholder* placeholder = placeholder_at(name, i);
    if (placeholder != nullptr && is_varied(shot, *placeholder)) {
      text += file_part(label.*placeholder->part);
      i += placeholder->text.size();
    } else {
      text += name[i++];
    }
  }
  return text;
}

}  // namespace

std::string without_placeholders(const std::string& name) {
  std::string text;
  for (std::size_t i = 0; i < name.size(); ++i) {
    if (placeholder_at(name, i) != nullptr) text += '{';
    text += name[i];
  }
  return text;
}

PictureNames name_pictures(const RenderOptions& o, const std::vector<PictureLabel>& labels) {
  PictureNames names(labels.size());
  for (const std::string& output : o.outputs) {
    std::map<std::string, int> counts;
    for (std::size_t i = 0; i < labels.size(); ++i) {
      if (!o.shot.has_many_pictures()) {
        names[i].emplace_back(filled(output, o.shot, labels[i]));
        continue;
      }
      const int number = counts[filled(output, o.shot, labels[i])]++;
      names[i].emplace_back(filled(frame_name(output, number), o.shot, labels[i]));
    }
  }
  return names;
}

std::vector<PictureLabel> labels_before_loading(const Shot& shot) {
  if (shot.variants || shot.animations) return {};
  std::vector<PictureLabel> labels;
  for (int moment = 0; moment < shot.sequence.value_or(1); ++moment) {
    for (const ViewpointName& name : viewpoint_names(shot)) {
      const PictureLabel label{.variant = {}, .animation = {}, .view = name.view, .camera = name.camera};
      labels.insert(labels.end(), static_cast<std::size_t>(shot.turntable.value_or(1)), label);
    }
  }
  return labels;
}

bool shares_names(const RenderOptions& o, const std::string& output) {
  return o.shot.turntable || o.shot.sequence ||
         std::any_of(kPlaceholders.begin(), kPlaceholders.end(), [&](const Placeholder& placeholder) {
           return is_varied_often(o.shot, placeholder) && !has_placeholder(output, placeholder);
         });
}

namespace {

/// Throws UsageError for the name of a film of one picture, or of a number of films.
void check_film_name(const RenderOptions& o, const std::string& output) {
  if (is_frame_pattern(output)) {
    throw UsageError("--output: " + output + " is a film, which has all pictures: no place for a number");
  }
  if (o.shot.has_many_pictures()) return;
  throw UsageError("--output: " + output + " is a film: give --turntable, --sequence or --cameras");
}

}  // namespace

void check_patterns(const RenderOptions& o) {
  for (const std::string& output : o.outputs) {
    for (const Placeholder& placeholder : kPlaceholders) {
      const bool is_there = has_placeholder(output, placeholder);
      if (is_there && !is_varied(o.shot, placeholder)) {
        throw UsageError(
            fmt::format("--output: {} has a {}, which only {} fills", output, placeholder.text, placeholder.option));
      }
      if (is_there || is_frame_pattern(output) || is_film(o, output) || !is_varied_often(o.shot, placeholder)) continue;
      throw UsageError(fmt::format("--output: {} has no place for the names of several pictures: NAME-{}.png", output,
                                   placeholder.text));
    }
    if (is_film(o, output)) {
      check_film_name(o, output);
    } else if ((o.shot.turntable || o.shot.sequence) && !is_frame_pattern(output)) {
      throw UsageError("--output: " + output + " has no place for the number of a picture: NAME%03d.png");
    }
  }
}

Inputs inputs_of_options(const RenderOptions& o) {
  Inputs inputs;
  for (const std::string& scene : o.scenes) inputs.add(scene, "the scene " + scene);
  if (o.camera_file) inputs.add(*o.camera_file, "the cameras");
  if (!o.job_list.empty() && o.job_list != "-") inputs.add(o.job_list, "the list of jobs");
  inputs.add_environment(o.shot.environment.value_or(""));
  if (!o.shot.drawn.shader_folder.empty()) inputs.add_folder(o.shot.drawn.shader_folder, "a shader");
  return inputs;
}

namespace {

/// Those that --pictures asks for.
std::span<const std::vector<fs::path>> names_asked_for(const RenderOptions& o, const PictureNames& names) {
  const std::span<const std::vector<fs::path>> all = names;
  if (!o.shot.pictures || o.shot.pictures->last > all.size()) return all;
  return all.subspan(o.shot.pictures->first - 1, o.shot.pictures->count());
}

}  // namespace

std::vector<fs::path> written_files(const RenderOptions& o, const PictureNames& names) {
  std::vector<fs::path> files;
  for (const std::vector<fs::path>& of_picture : names_asked_for(o, names)) {
    files.insert(files.end(), of_picture.begin(), of_picture.end());
  }
  if (o.stats && *o.stats != "-") files.push_back(*o.stats);
  if (o.written_cameras) files.push_back(*o.written_cameras);
  return files;
}

void check_overwriting(const RenderOptions& o, const PictureNames& names, const Inputs& inputs) {
  std::map<std::string, std::pair<fs::path, std::string>> seen;
  // All pictures of an output may go into one film.
  const auto check = [&](const fs::path& path, const std::string& film) {
    if (is_device(path) || !standard_output_format(path.string()).empty()) return;
    inputs.refuse(path);
    const auto [found, is_new] = seen.try_emplace(file_identity(path), path, film);
    if (is_new || (!film.empty() && found->second == std::pair(path, film))) return;
    throw Error("would be written twice, also as " + found->second.first.string(), path.string());
  };
  for (const std::vector<fs::path>& of_picture : names_asked_for(o, names)) {
    for (std::size_t k = 0; k < of_picture.size(); ++k) {
      check(of_picture[k], is_film(o, o.outputs[k]) ? o.outputs[k] : "");
    }
  }
  if (o.stats && *o.stats != "-") check(*o.stats, "");
  if (o.written_cameras) check(*o.written_cameras, "");
  if (o.checkpoint) check(*o.checkpoint, "");
  if (o.dataset) inputs.refuse_folder(o.dataset_folder);
}

void check_paths(const RenderOptions& o) {
  const std::vector<fs::path> paths = name_pictures(o, {PictureLabel()})[0];
  for (std::size_t k = 0; k < paths.size(); ++k) {
    check_writable(paths[k]);
    if (is_film(o, o.outputs[k])) {
      check_movie(paths[k], {.size = o.shot.size, .frame_rate = o.frames_per_second.value_or(24.0f)});
    }
  }
  if (o.stats && *o.stats != "-") check_writable(*o.stats);
  if (o.written_cameras) check_writable(*o.written_cameras);
  if (o.checkpoint) check_writable(*o.checkpoint);
}

void choose_default_name(RenderOptions& o, const std::vector<PictureLabel>& labels, const Inputs& inputs) {
  const auto is_taken = [&] {
    const PictureNames names = name_pictures(o, labels);
    return std::any_of(names.begin(), names.end(), [&](const std::vector<fs::path>& of_picture) {
      return std::any_of(of_picture.begin(), of_picture.end(), [&](const fs::path& p) { return inputs.contains(p); });
    });
  };
  if (!o.has_default_name || (o.stats && inputs.contains(*o.stats))) return;
  for (int attempt = 2; is_taken(); ++attempt) o.outputs = {default_output(o, attempt)};
}

void add_scene_files(const std::vector<std::string>& scenes, const fs::path& root, Inputs& inputs) {
  for (const std::string& scene : scenes) {
    try {
      if (!scene.starts_with("demo:")) inputs.add(io::files_of_gltf(scene, root));
    } catch (const Error&) {
      // Told when it is its turn.
    }
  }
}

namespace {

std::string numbered(const std::string& stem, int number) {
  return stem + (number > 1 ? fmt::format("-{}", number) : "") + ".png";
}

/// Names of a folder that are given to nobody else.
class FolderNames {
 public:
  FolderNames(fs::path folder, const Inputs& inputs) : folder_(std::move(folder)), inputs_(inputs) {}

  /// Whether it is free; then it is taken from here on.
  bool take(const std::string& name) {
    const std::string key = lower_case(name);
    const fs::path path = folder_ / name;
    if (names_.contains(key) || inputs_.contains(path)) return false;
    // Two names may be links to one file.
    if (!is_device(path) && !files_.insert(file_identity(path)).second) return false;
    names_.insert(key);
    return true;
  }

 private:
  fs::path folder_;
  const Inputs& inputs_;
  std::set<std::string> names_, files_;
};

}  // namespace

std::vector<fs::path> batch_outputs(const std::vector<std::string>& stems, const fs::path& folder,
                                    const Inputs& inputs) {
  FolderNames names(folder, inputs);
  std::vector<fs::path> outputs(stems.size());
  for (std::size_t i = 0; i < stems.size(); ++i) {
    const std::string own = numbered(stems[i], 1);
    if (names.take(own)) outputs[i] = folder / own;
  }
  for (std::size_t i = 0; i < stems.size(); ++i) {
    for (int number = 2; outputs[i].empty(); ++number) {
      const std::string name = numbered(stems[i], number);
      if (names.take(name)) outputs[i] = folder / name;
    }
  }
  return outputs;
}

std::string batch_pattern(const RenderOptions& o, const fs::path& output) {
  return (output.parent_path() / default_pattern(o.shot, output.stem().string())).string();
}

fs::path free_name(const fs::path& folder, const std::string& stem, const Inputs& inputs) {
  int number = 1;
  while (inputs.contains(folder / numbered(stem, number))) ++number;
  return folder / numbered(stem, number);
}

}  // namespace candela::cli
