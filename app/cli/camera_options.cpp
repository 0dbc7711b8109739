#include "cli/camera_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <string_view>

#include "base/error.h"
#include "cli/option.h"
#include "cli/values.h"
#include "io/camera_file.h"

namespace candela::cli {

std::string names_of_views() {
  std::string names;
  for (const NamedView& view : kNamedViews) names += (names.empty() ? "" : ", ") + std::string(view.name);
  return names;
}

std::vector<std::string> parse_views(const std::string& text) {
  std::vector<std::string> names = parse_names(text);
  for (std::size_t i = 0; i < names.size(); ++i) {
    named_orbit(names[i]);
    if (std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(i), names[i]) !=
        names.begin() + static_cast<std::ptrdiff_t>(i)) {
      throw UsageError(names[i] + " is there twice");
    }
  }
  return names;
}

std::optional<CameraSphere> parse_camera_sphere(const std::string& text) {
  constexpr int kMostCameras = 100000;
  for (const std::string_view kind : {"sphere:", "hemisphere:"}) {
    if (!text.starts_with(kind)) continue;
    const std::string numbers = text.substr(kind.size());
    const std::size_t comma = numbers.find(',');
    CameraSphere sphere;
    sphere.count = parse_count(numbers.substr(0, comma), 1, kMostCameras);
    sphere.is_upper_half = kind == "hemisphere:";
    if (comma != std::string::npos) sphere.seed = parse_seed(numbers.substr(comma + 1));
    return sphere;
  }
  return std::nullopt;
}

float parse_margin(const std::string& text) {
  constexpr float kMost = 0.45f;
  if (text.ends_with('%')) return 0.01f * parse_number(text.substr(0, text.size() - 1), 0.0f, 100.0f * kMost);
  return parse_number(text, 0.0f, kMost);
}

namespace {

constexpr Words<bool, 2> kProjections{{{"perspective", false}, {"orthographic", true}}};  // whether it is orthographic

/// What names of files say of a set of pictures.
std::string into(CameraPictures pictures, const std::string& name) {
  return pictures == CameraPictures::files ? ", into -o " + name : "";
}

void add_viewpoints(Command& command, RenderOptions& o, CameraPictures pictures, const std::string& group) {
  const auto text = [](const std::string& value) { return value; };
  Option camera = add_value(command, "--camera", "INDEX|NAME", o.shot.camera, text,
                            "One of the file's cameras [the first, else the whole subject]");
  Option views = add_value(command, "--views", "LIST", o.shot.views, parse_views,
                           "A picture of the whole subject from each" + into(pictures, "NAME-{view}.png") +
                               "; some of " + names_of_views())
                     .choices_of_list(names_of_rows(kNamedViews));
  Option orbit = add_value(command, "--orbit", "AZ,EL[,DIST]", o.shot.orbit, parse_orbit,
                           "Degrees around and above the subject; DIST 1 fits it, 0.5 is twice as close");
  Option eye = add_value(command, "--eye", "X,Y,Z", o.shot.eye, parse_vec3, "Where the camera is, metres");
  Option target =
      add_value(command, "--target", "X,Y,Z", o.shot.target, parse_vec3, "What --eye looks at [the subject's centre]");
  const auto cameras = [&o](const std::string& value) {
    if (value.empty()) throw UsageError("the name is empty");
    o.shot.camera_sphere = parse_camera_sphere(value);
    return o.shot.camera_sphere ? std::nullopt : std::optional<std::filesystem::path>(value);
  };
  Option list = add_value(command, "--cameras", "FILE|sphere:N[,SEED]", o.camera_file, cameras,
                          "A picture through each camera of a .gltf, .glb, transforms.json or list of K and pose, or "
                          "from N places around the subject (hemisphere: above it)" +
                              into(pictures, "NAME-{camera}.png"));
  Option no_clip = command.flag("--no-clip", o.shot.ignores_planes,
                                "The file's camera sees what is before its near plane and beyond its far one, too");
  for (const Option& other : {camera, orbit, eye, list}) views.excludes(other);
  for (const Option& other : {camera, orbit, eye}) list.excludes(other);
  camera.excludes(orbit).excludes(eye);
  no_clip.excludes(orbit).excludes(eye).excludes(views).excludes(list);
  orbit.excludes(eye);
  target.needs(eye);
  for (Option option : {camera, views, orbit, eye, target, list, no_clip}) option.group(group);
  if (pictures != CameraPictures::files) return;
  const auto written = [](const std::string& value) {
    io::check_camera_file_name(value);
    return std::filesystem::path(value);
  };
  add_value(command, "--write-cameras", "FILE", o.written_cameras, written,
            "The cameras of all pictures as .gltf, transforms.json or another .json")
      .group(group);
}

}  // namespace

void add_camera_options(Command& command, RenderOptions& o, CameraPictures pictures) {
  const std::string group = "Camera";
  add_viewpoints(command, o, pictures, group);
  Option projection = add_choice(command, "--projection", "NAME", o.shot.is_orthographic, kProjections,
                                 "perspective or orthographic; the subject is framed then, as with --margin, unless "
                                 "--eye says otherwise [perspective]");
  Option margin = add_value(command, "--margin", "8%", o.shot.margin, parse_margin,
                            "What stays free at either side of a subject that is shown whole [8%]");
  Option fov = add_value(
      command, "--fov", "45deg", o.shot.yfov, [](const std::string& value) { return parse_field_of_view(value); },
      "Vertical field of view, also as 0.8rad [the camera's own, else 45deg]");
  Option f_number = add_value(command, "--f-number", "F", o.shot.f_number, number_within(0.01f, 1000.0f),
                              "Aperture of a lens on a 24 mm high sensor [everything is sharp]");
  Option focus = add_value(command, "--focus-distance", "M|auto", o.shot.focus_distance, parse_focus,
                           "What is sharp, metres [auto: --target or the subject's centre]");
  Option blades = add_value(command, "--blades", "N", o.shot.blades, count_within(0, 64),
                            "Corners of the aperture, below 3 it is round [0]");
  Option vignetting = add_value(command, "--vignetting", "X", o.shot.vignetting, number_within(0.0f, 1.0f),
                                "Fall-off to the corners: 0 none, 1 natural [0]");
  for (Option option : {projection, margin, fov, f_number, focus, blades, vignetting}) option.group(group);
  if (pictures == CameraPictures::window) return;
  add_value(command, "--turntable", "N", o.shot.turntable, count_within(1, 100000),
            "N pictures from all around the subject" + into(pictures, "NAME%03d.png"))
      .group(group);
}

void finish_camera_options(const Command& command, RenderOptions& o) {
  const auto refuse = [&](std::initializer_list<const char*> options, const std::string& why) {
    for (const char* option : options) {
      if (command.has(option)) throw UsageError(std::string(option) + ": " + why);
    }
  };
  if (command.has("--camera")) refuse({"--margin", "--projection"}, "not for a camera of the file");
  if (command.has("--eye")) refuse({"--margin"}, "not with --eye, which shows what it sees");
  if (o.shot.is_orthographic && !command.has("--eye")) {
    refuse({"--fov"}, "an orthographic camera has no field of view");
  }
  const auto is_given = [&](const char* option) { return command.has(option); };
  constexpr std::array kChoices = {"--camera", "--views", "--orbit", "--eye", "--cameras"};
  o.shot.ignores_own_camera =
      (is_given("--margin") || is_given("--projection")) && std::none_of(kChoices.begin(), kChoices.end(), is_given);
  if (!o.camera_file) return;
  refuse({"--margin", "--projection", "--fov"}, "not for the cameras of a file");
  read_cameras_of_shot(*o.camera_file, command.has("--size"), o.shot);
}

void read_cameras_of_shot(const std::filesystem::path& file, bool keeps_size, Shot& shot) {
  shot.cameras = io::read_cameras(file, shot.size);
  const ivec2 size = shot.cameras[0].size.value_or(shot.size);
  if (!keeps_size) shot.size = size;
  for (const PosedCamera& camera : shot.cameras) {
    if (!camera.size) continue;
    const ivec2 own = *camera.size;
    // Of another size in the same shape the camera is the same.
    const auto across = [](ivec2 a, ivec2 b) { return static_cast<std::int64_t>(a.x) * b.y; };
    if (across(own, shot.size) == across(shot.size, own)) continue;
    throw Error(fmt::format("camera {} is for {}x{}, which is not the shape of {}x{}", camera.name, own.x, own.y,
                            shot.size.x, shot.size.y),
                file.string());
  }
}

}  // namespace candela::cli
