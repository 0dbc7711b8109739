#include "cli/verdict_json.h"

namespace candela::cli {

using Json = nlohmann::ordered_json;

namespace {

Json name_or_null(const std::string& label) { return label.empty() ? Json(nullptr) : Json(label); }

}  // namespace

Json verdict_json(const Verdict& v) {
  Json findings = Json::array();
  for (const auto& [f, material, texture] : v.findings) {
    Json measured = Json::object();
    for (const auto& [name, value] : f.measured) measured[name] = value;
    findings.push_back({{"severity", severity_name(f.severity)},
                        {"code", f.code},
                        {"material", name_or_null(material)},
                        {"material_index", f.material < 0 ? Json(nullptr) : Json(f.material)},
                        {"texture", name_or_null(texture)},
                        {"texture_index", f.texture < 0 ? Json(nullptr) : Json(f.texture)},
                        {"subject", name_or_null(f.subject)},
                        {"share", f.share ? Json(*f.share) : Json(nullptr)},
                        {"share_of", f.share ? Json(f.share_of) : Json(nullptr)},
                        {"message", f.message},
                        {"fix", name_or_null(f.fix)},
                        {"measured", measured}});
  }
  return {{"file", v.file},
          {"readable", !v.unreadable},
          {"reason", v.unreadable ? Json(*v.unreadable) : Json(nullptr)},
          {"materials", v.material_count},
          {"triangles", v.triangle_count},
          {"findings", findings}};
}

}  // namespace candela::cli
