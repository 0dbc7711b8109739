#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "check/check_parts.h"
#include "scene/material_table.h"
#include "scene/visibility.h"

// What the file itself says: its extensions, images, vertices; and what the loader had to put right.
namespace candela::check {

namespace {

/// Extensions that Candela reads and others need not: drafts, vendors' own, and what Khronos has archived. The table of
/// materials has more.
constexpr auto kDoubtful = std::to_array<UnratifiedExtension>({
    {"EXT_camera_physical", "a proposal"},
    {"EXT_lights_area", "a draft"},
    {"EXT_lights_ies", "a multi-vendor extension that few viewers read"},
    {"EXT_lights_image_based", "a multi-vendor extension that few viewers read"},
    {"EXT_texture_astc", "a draft"},
    {"KHR_materials_pbrSpecularGlossiness", "archived; viewers drop it, and show metallic-roughness instead"},
    {"KHR_materials_scatter", "a draft"},
    {"KHR_materials_volume_scatter", "a draft, which KHR_materials_scatter is to replace"},
});

Finding plain(Severity severity, const char* code, std::string subject, std::string message) {
  Finding f;
  f.severity = severity;
  f.code = code;
  f.subject = std::move(subject);
  f.message = std::move(message);
  return f;
}

bool contains(const std::vector<std::string>& list, std::string_view name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

void judge_extensions(const CheckInput& input, std::vector<Finding>& findings) {
  for (const std::string& name : input.extensions_missing) {
    findings.push_back(
        plain(Severity::error, "extension-missing", name, "the file requires it and Candela does not support it"));
  }
  for (const std::string& name : input.extensions_ignored) {
    if (contains(input.extensions_missing, name)) continue;
    findings.push_back(
        plain(Severity::warning, "extension-ignored", name, "Candela does not support it and shows the asset without"));
  }
  const auto judge = [&](const UnratifiedExtension& entry) {
    if (!contains(input.extensions_used, entry.name)) return;
    findings.push_back(plain(Severity::note, "extension-uncommon", std::string(entry.name),
                             fmt::format("Candela reads it, other viewers may not: {}", entry.why)));
  };
  for (const UnratifiedExtension& entry : kDoubtful) judge(entry);
  for (const UnratifiedExtension& entry : kUnratifiedExtensions) judge(entry);
}

bool wants_tangents(const Material& m) {
  const TextureSlot* slot = tangent_slot(m);
  return !m.unlit && slot != nullptr && *slot;
}

/// What the primitives of one material have in common, counted.
struct OfMaterial {
  std::size_t primitives = 0, without_tangents = 0;
  std::size_t triangles = 0, degenerate = 0;
  std::size_t normals = 0, off_unit = 0;
  float worst_length = 1.0f;
  std::set<int> missing_uv_sets;
  std::string first_without_uv;
};

std::map<int, OfMaterial> count_primitives(const Scene& scene, const FileSurvey& survey) {
  std::map<int, OfMaterial> result;
  for (const FileSurvey::Primitive& p : survey.primitives) {
    OfMaterial& m = result[p.material];
    ++m.primitives;
    const Material& material = scene.materials[static_cast<std::size_t>(p.material)];
    if (wants_tangents(material) && !p.has_tangents && p.missing_uv_sets.empty()) ++m.without_tangents;
    m.triangles += p.triangles;
    m.degenerate += p.degenerate;
    m.normals += p.normals;
    m.off_unit += p.normals_off_unit;
    if (std::abs(p.worst_normal_length - 1.0f) > std::abs(m.worst_length - 1.0f)) {
      m.worst_length = p.worst_normal_length;
    }
    if (!p.missing_uv_sets.empty() && m.missing_uv_sets.empty()) m.first_without_uv = p.where;
    m.missing_uv_sets.insert(p.missing_uv_sets.begin(), p.missing_uv_sets.end());
  }
  return result;
}

double ratio(std::size_t part, std::size_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
}

void judge_primitives(const Scene& scene, const FileSurvey& survey, std::vector<Finding>& findings) {
  const auto add = [&findings](Severity severity, const char* code, int material, std::string message) -> Finding& {
    findings.push_back(plain(severity, code, {}, std::move(message)));
    findings.back().material = material;
    return findings.back();
  };
  for (const auto& [material, m] : count_primitives(scene, survey)) {
    if (!m.missing_uv_sets.empty()) {
      add(Severity::error, "uv-missing", material,
          fmt::format("its textures need TEXCOORD_{}, which {} has not: all of it shows one texel",
                      fmt::join(m.missing_uv_sets, " and TEXCOORD_"), m.first_without_uv));
    }
    if (m.off_unit > 0) {
      Finding& f =
          add(Severity::warning, "normals-not-unit", material,
              fmt::format("normals are not of unit length in the file; the worst is {:.3g} long", m.worst_length));
      f.share = ratio(m.off_unit, m.normals);
      f.share_of = "normals";
      f.fix = "normalize them";
      f.measured.emplace_back("worst_length", m.worst_length);
    }
    if (m.degenerate > 0) {
      Finding& f = add(Severity::note, "degenerate-triangles", material,
                       fmt::format("{} of {} triangles have no area", m.degenerate, m.triangles));
      f.share = ratio(m.degenerate, m.triangles);
      f.share_of = "triangles";
      f.fix = "remove them";
      f.measured.emplace_back("triangles", static_cast<double>(m.degenerate));
    }
    if (m.without_tangents > 0) {
      Finding& f =
          add(Severity::note, "tangents-missing", material,
              fmt::format("{} of {} primitives with a normal map have no tangents; they are made by MikkTSpace, "
                          "which is right if the map was baked for it",
                          m.without_tangents, m.primitives));
      f.measured.emplace_back("primitives", static_cast<double>(m.without_tangents));
    }
  }
}

/// What the loader put right and no other rule tells.
void pass_warnings(const CheckInput& input, std::vector<Finding>& findings) {
  std::set<std::string> without_uv;
  if (input.survey != nullptr) {
    for (const FileSurvey::Primitive& p : input.survey->primitives) {
      if (!p.missing_uv_sets.empty()) without_uv.insert(p.where);
    }
  }
  std::vector<std::string> lost;
  if (input.survey != nullptr) {
    for (const FileSurvey::Image& image : input.survey->images) {
      if (!image.error.empty()) lost.push_back(image.error);
    }
  }
  for (const Diagnostic& warning : input.warnings) {
    const bool is_image = std::any_of(lost.begin(), lost.end(),
                                      [&](const std::string& error) { return warning.text().starts_with(error); });
    if (is_image) continue;
    const std::string_view where = warning.where;
    // Extensions have findings of their own.
    if (where.ends_with("#/extensionsUsed") || where.ends_with("#/extensionsRequired")) continue;
    if (without_uv.contains(warning.where) && warning.message.find("TEXCOORD_") != std::string::npos) continue;
    findings.push_back(plain(Severity::warning, "file-oddity", warning.where, warning.message));
  }
  for (const Diagnostic& note : input.notes) {
    findings.push_back(plain(Severity::note, "no-effect", note.where, note.message));
  }
}

void judge_size(const Scene& scene, std::vector<Finding>& findings) {
  constexpr float kLargest = 1e4f;
  constexpr float kSmallest = 1e-3f;
  const Box3 box = world_bounds(scene);
  if (box.empty()) {
    findings.push_back(plain(Severity::note, "nothing-to-see", {}, find_emptiness(scene)->message));
    return;
  }
  if (const auto emptiness = find_emptiness(scene)) {
    findings.push_back(plain(Severity::warning, "vertex-far-out", {}, emptiness->message));
  }
  const float side = max_component(box.size());
  if (side <= kLargest && side >= kSmallest) return;
  Finding f =
      plain(Severity::note, "size-unlikely", {},
            fmt::format("its longest side is {:.3g} m; glTF is in metres, and volumes absorb by the metre", side));
  f.measured.emplace_back("longest_side_m", side);
  findings.push_back(std::move(f));
}

void judge_outside(const FileSurvey& survey, std::vector<Finding>& findings) {
  for (const FileSurvey::Outside& file : survey.outside) {
    findings.push_back(plain(Severity::warning, "file-outside", file.where,
                             fmt::format("'{}' lies outside of the scene's folder: the folder alone is not the whole "
                                         "asset, and whoever shows files of strangers refuses it",
                                         file.name)));
    findings.back().fix = "move it into the folder";
  }
}

void judge_hidden(const Scene& scene, std::vector<Finding>& findings) {
  const auto hidden = std::count_if(scene.nodes.begin(), scene.nodes.end(), [](const Node& n) { return n.is_hidden; });
  if (hidden == 0) return;
  findings.push_back(plain(Severity::note, "nodes-hidden", {},
                           fmt::format("{} node{} hidden (KHR_node_visibility): what {} is neither shown nor judged",
                                       hidden, hidden == 1 ? " is" : "s are", hidden == 1 ? "it holds" : "they hold")));
  findings.back().measured.emplace_back("nodes", static_cast<double>(hidden));
}

}  // namespace

std::vector<Finding> check_images(const FileSurvey& survey) {
  std::vector<Finding> findings;
  for (std::size_t i = 0; i < survey.images.size(); ++i) {
    const FileSurvey::Image& image = survey.images[i];
    if (image.error.empty()) continue;
    const int number = image.file_index >= 0 ? image.file_index : static_cast<int>(i);
    const std::string label =
        image.name.empty() ? fmt::format("image {}", number) : fmt::format("image '{}'", image.name);
    findings.push_back(plain(Severity::error, "texture-unreadable", label, image.error));
  }
  return findings;
}

void check_file(const CheckInput& input, std::vector<Finding>& findings) {
  judge_extensions(input, findings);
  if (input.survey != nullptr) {
    judge_primitives(input.scene, *input.survey, findings);
    judge_outside(*input.survey, findings);
  }
  if (input.survey != nullptr) {
    for (Finding& f : check_images(*input.survey)) findings.push_back(std::move(f));
  }
  pass_warnings(input, findings);
  judge_hidden(input.scene, findings);
  judge_size(input.scene, findings);
}

}  // namespace candela::check
