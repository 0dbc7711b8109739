#include "cli/check_filter.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/file.h"
#include "base/text.h"
#include "cli/json_text.h"
#include "cli/output.h"
#include "cli/values.h"

namespace candela::cli {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::set<std::string> parse_codes(const std::string& text) {
  std::set<std::string> codes;
  const std::span<const std::string> known = check::finding_codes();
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string code = text.substr(begin, end - begin);
    if (std::find(known.begin(), known.end(), code) == known.end()) {
      throw UsageError(fmt::format("no finding has the code '{}'{}", code, did_you_mean(code, known)));
    }
    codes.insert(code);
    begin = end + 1;
  }
  return codes;
}

void parse_limit(const std::string& text, check::Limits& limits) {
  const std::size_t equals = text.find('=');
  const std::string code = text.substr(0, equals);
  if (equals == std::string::npos) throw UsageError(fmt::format("--limit: '{}' is not CODE=X", text));
  std::vector<std::string> names;
  for (const check::LimitRow& row : check::limit_rows()) {
    names.emplace_back(row.name);
    if (code != row.name) continue;
    const auto low = static_cast<float>(row.low), high = static_cast<float>(row.high);
    try {
      limits.*row.limit = decimal_of(parse_number(text.substr(equals + 1), low, high));
    } catch (const UsageError& error) {
      throw UsageError("--limit: " + code + ": " + error.what());
    }
    return;
  }
  throw UsageError(
      fmt::format("--limit: '{}' has none, only {}{}", code, fmt::join(names, ", "), did_you_mean(code, names, "; ")));
}

namespace {

/// Absolute, links resolved as far as it exists.
fs::path resolved(const fs::path& path) {
  std::error_code code;
  const fs::path whole = fs::absolute(path.empty() ? fs::path(".") : path, code);
  const fs::path real = fs::weakly_canonical(whole, code);
  return code ? whole : real;
}

/// A scene's file as seen from a folder; a built-in scene as it is called.
std::string from_folder(const std::string& file, const fs::path& folder) {
  if (file.starts_with("demo:")) return file;
  return resolved(file).lexically_proximate(folder).generic_string();
}

std::string text_of(const Json& entry, const char* key) {
  const auto found = entry.find(key);
  return found != entry.end() && found->is_string() ? found->get<std::string>() : std::string();
}

}  // namespace

Baseline::Baseline(const fs::path& path) : folder_(resolved(path.parent_path())) {
  const std::vector<std::byte> bytes = read_file(path);
  const auto* text = reinterpret_cast<const char*>(bytes.data());
  const Json json = Json::parse(text, text + bytes.size(), nullptr, false);
  const auto list = json.is_object() ? json.find("known_findings") : json.end();
  if (!json.is_object() || list == json.end() || !list->is_array()) {
    throw Error("is no file of --write-baseline", path.string());
  }
  for (const Json& entry : *list) {
    if (!entry.is_object()) throw Error("is no file of --write-baseline", path.string());
    findings_.insert({text_of(entry, "file"), text_of(entry, "code"), text_of(entry, "material"),
                      text_of(entry, "texture"), text_of(entry, "subject")});
  }
}

bool Baseline::knows(const std::string& file, const NamedFinding& finding) const {
  return findings_.contains(identity_of(from_folder(file, folder_), finding));
}

void Baseline::add(const Verdict& verdict, const fs::path& path) {
  const std::string file = from_folder(verdict.file, resolved(path.parent_path()));
  for (const NamedFinding& finding : verdict.findings) findings_.insert(identity_of(file, finding));
}

void Baseline::write(const fs::path& path) const {
  Json list = Json::array();
  for (const KnownFinding& known : findings_) {
    Json entry{{"file", known.file}, {"code", known.code}};
    if (!known.material.empty()) entry["material"] = known.material;
    if (!known.texture.empty()) entry["texture"] = known.texture;
    if (!known.subject.empty()) entry["subject"] = known.subject;
    list.push_back(std::move(entry));
  }
  const FolderFor folder(path);
  write_file(path, json_text({{"known_findings", list}}));
}

}  // namespace candela::cli
