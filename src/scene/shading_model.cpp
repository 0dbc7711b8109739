#include "scene/shading_model.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "base/error.h"

namespace candela {

namespace {

using shade::ShadingModel;

struct Preset {
  std::string_view name;
  ShadingModel (*make)();
};

const std::vector<Preset>& presets() {
  static const std::vector<Preset> all = {
      {"candela", shade::shading_model_candela}, {"gltf", shade::shading_model_gltf},
      {"ue4", shade::shading_model_ue4},         {"learnopengl", shade::shading_model_learnopengl},
      {"thesis", shade::shading_model_thesis},   {"blinn-phong", shade::shading_model_blinn_phong}};
  return all;
}

/// One term of the model: its key, its choices, and where a choice goes.
struct Term {
  std::string_view key;
  std::vector<std::pair<std::string_view, int>> choices;
  std::function<void(ShadingModel&, int)> set;
};

const std::vector<Term>& terms() {
  using namespace shade;
  static const std::vector<Term> all = {
      {"d",
       {{"ggx", kDistributionGgx},
        {"beckmann", kDistributionBeckmann},
        {"blinn-phong", kDistributionBlinnPhong},
        {"charlie", kDistributionCharlie}},
       [](ShadingModel& m, int v) { m.distribution = v; }},
      {"g",
       {{"smith", kMaskingSmithCorrelated},
        {"smith-separable", kMaskingSmithSeparable},
        {"schlick-direct", kMaskingSchlickDirect},
        {"schlick-ibl", kMaskingSchlickIbl},
        {"beckmann-rational", kMaskingBeckmannRational},
        {"charlie", kMaskingCharlie}},
       [](ShadingModel& m, int v) { m.masking = v; }},
      {"f",
       {{"schlick", kFresnelSchlick},
        {"spherical-gaussian", kFresnelSphericalGaussian},
        {"exact", kFresnelExact},
        {"f82", kFresnelF82}},
       [](ShadingModel& m, int v) { m.fresnel = v; }},
      {"diffuse",
       {{"lambert", kDiffuseLambert},
        {"burley", kDiffuseBurley},
        {"oren-nayar", kDiffuseOrenNayar},
        {"eon", kDiffuseEon}},
       [](ShadingModel& m, int v) { m.diffuse = v; }},
      {"blend",
       {{"albedo", kBlendAlbedo},
        {"half-vector", kBlendHalfVector},
        {"view", kBlendView},
        {"sum", kBlendSum},
        {"phong", kBlendPhong}},
       [](ShadingModel& m, int v) { m.blend = v; }},
      {"multiscatter", {{"on", 1}, {"off", 0}}, [](ShadingModel& m, int v) { m.multiscatter = v != 0; }},
      {"layers", {{"albedo", 0}, {"literal", 1}}, [](ShadingModel& m, int v) { m.literal_layers = v != 0; }}};
  return all;
}

std::string choices_of(const Term& term) {
  std::string text(term.key);
  for (std::size_t i = 0; i < term.choices.size(); ++i) {
    text += i == 0 ? '=' : '|';
    text += term.choices[i].first;
  }
  return text;
}

std::string known_names() {
  std::string text;
  for (const std::string& name : shading_model_names()) text += (text.empty() ? "" : ", ") + name;
  return text;
}

void set_term(std::string_view word, std::size_t equals, ShadingModel& model) {
  const std::string_view key = word.substr(0, equals);
  const std::string_view value = word.substr(equals + 1);
  for (const Term& term : terms()) {
    if (term.key != key) continue;
    for (const auto& [name, choice] : term.choices) {
      if (name == value) return term.set(model, choice);
    }
    throw Error("'" + std::string(word) + "' is none of " + choices_of(term));
  }
  throw Error("'" + std::string(key) + "' is no term of a shading model; there are " + known_names());
}

}  // namespace

std::vector<std::string> shading_model_names() {
  std::vector<std::string> names;
  for (const Preset& preset : presets()) names.emplace_back(preset.name);
  for (const Term& term : terms()) names.push_back(choices_of(term));
  return names;
}

ShadingModel parse_shading_model(std::string_view text) {
  ShadingModel model = shade::shading_model_candela();
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string_view word = text.substr(begin, end - begin);
    if (const std::size_t equals = word.find('='); equals != std::string_view::npos) {
      set_term(word, equals, model);
    } else {
      const auto found =
          std::find_if(presets().begin(), presets().end(), [&](const Preset& p) { return p.name == word; });
      if (found == presets().end()) {
        throw Error("'" + std::string(word) + "' is no shading model; there are " + known_names());
      }
      if (begin != 0) throw Error("the preset '" + std::string(word) + "' must stand first");
      model = found->make();
    }
    begin = end + 1;
  }
  return model;
}

}  // namespace candela
