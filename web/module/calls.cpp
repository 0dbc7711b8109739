#include <cstring>
#include <exception>
#include <functional>
#include <map>
#include <new>
#include <nlohmann/json.hpp>
#include <string_view>

#include "candela/candela.h"
#include "cli/verdict_json.h"
#include "image/browser_pictures.h"
#include "io/gltf.h"
#include "page.h"

// The doors through which web/src/worker.ts comes. A call and its answer are JSON; whatever is wrong is an answer, too:
// nothing is thrown into the page.
namespace candela::web {

namespace {

using Json = nlohmann::ordered_json;

struct State {
  Page page;
  DisplayImage picture;  ///< the last one
  TextureImage given;    ///< that the browser decodes at the moment
  std::string answer;    ///< to the last call
};

template <class Number>
std::optional<Number> number(const Json& call, const char* name) {
  const auto found = call.find(name);
  if (found == call.end() || found->is_null()) return std::nullopt;
  return found->get<Number>();
}

std::string text(const Json& call, const char* name) { return call.value(name, std::string()); }

Look look_of(const Json& call) {
  Look look;
  look.size = {call.at("width").get<int>(), call.at("height").get<int>()};
  if (const auto sight = call.find("sight"); sight != call.end()) {
    look.sight = {number<float>(*sight, "azimuth"), number<float>(*sight, "elevation"), number<float>(*sight, "scale"),
                  number<float>(*sight, "distance")};
  }
  if (const auto exposure = call.find("exposure"); exposure != call.end()) {
    look.is_metered = exposure->is_string();
    if (exposure->is_number()) look.exposure = exposure->get<float>();
  }
  if (const std::string curve = text(call, "tonemap"); !curve.empty()) look.tone_curve = parse_tone_curve(curve);
  return look;
}

void require_scene(const Page& page) {
  if (!page.is_loaded()) throw Error("no scene was loaded");
}

Json info_json(const Page& page) {
  const io::FileInfo& info = page.info();
  const Scene& scene = page.scene();
  Json animations = Json::array();
  for (std::size_t i = 0; i < info.animations.size(); ++i) {
    const io::AnimationInfo& animation = info.animations[i];
    animations.push_back({{"name", animation.name}, {"duration", animation.duration_s}});
  }
  std::size_t triangles = 0;
  for (const Mesh& mesh : scene.meshes) {
    for (const Primitive& primitive : mesh.primitives) triangles += primitive.triangles.size();
  }
  const Box3 bounds = subject_bounds(scene);
  return {{"generator", info.generator},
          {"copyright", info.copyright},
          {"extensions", info.extensions_used},
          {"ignored", info.extensions_ignored},
          {"variants", info.variants},
          {"animations", animations},
          {"triangles", triangles},
          {"materials", scene.materials.size()},
          {"images", scene.images.size()},
          {"lights", scene.lights.size()},
          {"nodes", scene.nodes.size()},
          {"size", {bounds.size().x, bounds.size().y, bounds.size().z}}};
}

Json files(State&, const Json& call) {
  Json names = Json::array();
  for (const io::ReferencedFile& file : io::files_of_gltf(text(call, "path"))) {
    if (!file.place.empty()) names.push_back(file.path.string());
  }
  return names;
}

Json load(State& state, const Json& call) {
  state.page.load(text(call, "path"), text(call, "variant"));
  return info_json(state.page);
}

Json set_environment(State& state, const Json& call) {
  state.page.set_environment(text(call, "name"));
  return nullptr;
}

Json set_variant(State& state, const Json& call) {
  require_scene(state.page);
  state.page.set_variant(text(call, "name"));
  return nullptr;
}

Json set_pose(State& state, const Json& call) {
  require_scene(state.page);
  if (const auto time = number<double>(call, "time")) {
    state.page.set_pose(Pose{text(call, "animation"), *time});
  } else {
    state.page.set_pose(std::nullopt);
  }
  return nullptr;
}

Json draw(State& state, const Json& call) {
  require_scene(state.page);
  state.page.draw(look_of(call));
  const Orbit orbit = state.page.orbit();
  return {{"azimuth", orbit.azimuth}, {"elevation", orbit.elevation}, {"scale", orbit.distance_scale}};
}

Json picture(State& state, const Json& call) {
  require_scene(state.page);
  state.picture = state.page.picture(look_of(call), call.value("frames", 16));
  return {{"width", state.picture.width}, {"height", state.picture.height}};
}

Json check(State& state, const Json&) {
  require_scene(state.page);
  return cli::verdict_json(state.page.verdict());
}

Json bake(State& state, const Json& call) {
  require_scene(state.page);
  const std::string folder = text(call, "folder");
  BakeOrder order;
  order.format.kind = BakeFormat::Kind::texture;
  if (const auto size = number<int>(call, "size")) order.settings.size = *size;
  const BakeResult result = state.page.bake(folder, std::move(order));
  Json warnings = Json::array();
  for (const Diagnostic& warning : result.warnings) warnings.push_back(warning.text());
  return {{"warnings", warnings}, {"seconds", result.bake_s}};
}

Json forget_drawing(State& state, const Json&) {
  state.page.forget_drawing();
  return nullptr;
}

const std::map<std::string_view, Json (*)(State&, const Json&)>& calls() {
  static const std::map<std::string_view, Json (*)(State&, const Json&)> table = {
      {"bake", bake},     {"check", check},           {"draw", draw}, {"environment", set_environment},
      {"files", files},   {"forget", forget_drawing}, {"load", load}, {"picture", picture},
      {"pose", set_pose}, {"variant", set_variant}};
  return table;
}

Json answer(State& state, const char* call_text) {
  const auto failure = [](const std::string& message, const std::string& where) {
    return Json{{"error", {{"message", message}, {"where", where}}}};
  };
  try {
    const Json call = Json::parse(call_text);
    const auto found = calls().find(call.at("call").get_ref<const std::string&>());
    if (found == calls().end()) return failure("no such call", call.at("call"));
    Json result = found->second(state, call);
    return {{"result", std::move(result)}, {"warnings", state.page.take_warnings()}};
  } catch (const Error& error) {
    return failure(error.message(), error.where());
  } catch (const std::bad_alloc&) {
    return failure("the memory of a page does not suffice", "");
  } catch (const std::exception& error) {
    return failure(error.what(), "");
  }
}

}  // namespace

}  // namespace candela::web

using candela::web::State;

extern "C" {

State* candela_open() { return new State; }

const char* candela_call(State* state, const char* call) {
  using candela::web::Json;
  state->answer = candela::web::answer(*state, call).dump(-1, ' ', false, Json::error_handler_t::replace);
  return state->answer.c_str();
}

/// RGBA, 8 bits each, of the last "picture".
const std::uint8_t* candela_picture(const State* state) { return state->picture.rgba.data(); }

/// Where the page writes the RGBA pixels of a picture that the browser has decoded; null where memory ends.
std::uint8_t* candela_begin_picture(State* state, int width, int height) {
  try {
    candela::TextureImage& picture = state->given;
    picture = {};
    picture.width = width;
    picture.height = height;
    picture.pixels.resize(std::size_t{4} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    return picture.pixels.data();
  } catch (const std::exception&) {
    return nullptr;
  }
}

/// They are there; `file` is what they were decoded from.
void candela_end_picture(State* state, const std::byte* file, std::size_t file_bytes) {
  candela::TextureImage& picture = state->given;
  for (std::size_t i = 3; i < picture.pixels.size() && !picture.has_alpha; i += 4)
    picture.has_alpha = picture.pixels[i] != 255;
  candela::give_browser_picture({file, file_bytes}, std::move(picture));
}

/// All, or those alone that we could decode ourselves.
void candela_forget_pictures(int all) {
  if (all != 0) candela::forget_browser_pictures();
  candela::forget_other_browser_pictures();
}
}
