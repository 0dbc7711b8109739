#include "foreign/mtl.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <map>
#include <string>

#include "base/text.h"

namespace candela::foreign {

namespace {

constexpr std::string_view kSpace = " \t\r\v\f";

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kSpace);
  if (begin == text.npos) return {};
  return text.substr(begin, text.find_last_not_of(kSpace) - begin + 1);
}

/// Takes the first word off.
std::string_view take_word(std::string_view& text) {
  text = trimmed(text);
  const std::size_t end = std::min(text.find_first_of(kSpace), text.size());
  const std::string_view word = text.substr(0, end);
  text = trimmed(text.substr(end));
  return word;
}

std::optional<float> number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  float value = 0.0f;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<float> take_number(std::string_view& text) {
  std::string_view rest = text;
  const auto value = number(take_word(rest));
  if (value) text = rest;
  return value;
}

/// One to three numbers; a single one is a grey.
std::optional<vec3> color(std::string_view text) {
  const auto r = take_number(text);
  if (!r) return std::nullopt;
  const auto g = take_number(text);
  const auto b = take_number(text);
  return glm::max(vec3(*r, g.value_or(*r), b.value_or(g.value_or(*r))), vec3(0.0f));
}

/// Options, then a name that may hold spaces.
Map map_of(std::string_view text) {
  Map map;
  const auto pair = [&](vec2& value) {
    // Up to three numbers, the third along w.
    if (const auto u = take_number(text)) value.x = *u;
    if (const auto v = take_number(text)) {
      value.y = *v;
      take_number(text);
    }
  };
  while (text.starts_with('-')) {
    std::string_view rest = text;
    const std::string_view option = take_word(rest);
    constexpr auto kOthers = std::to_array<std::string_view>(
        {"-blendu", "-blendv", "-cc", "-imfchan", "-texres", "-type", "-boost", "-colorspace"});
    if (option == "-s" || option == "-o") {
      text = rest;
      pair(option == "-s" ? map.scale : map.offset);
    } else if (option == "-clamp") {
      text = rest;
      map.is_clamped = take_word(text) == "on";
    } else if (option == "-bm") {
      text = rest;
      if (const auto strength = take_number(text)) map.strength = *strength;
    } else if (option == "-mm" || option == "-t") {
      text = rest;
      for (int i = 0; i < (option == "-mm" ? 2 : 3) && take_number(text); ++i) {
      }
    } else if (std::find(kOthers.begin(), kOthers.end(), option) != kOthers.end()) {
      text = rest;
      take_word(text);
    } else {
      break;  // a name that begins with a dash
    }
  }
  map.file = text;
  return map;
}

using Reader = std::function<void(Look&, std::string_view)>;

Reader scalar(float Look::*member) {
  return [member](Look& look, std::string_view text) {
    if (const auto value = take_number(text)) look.*member = std::max(*value, 0.0f);
  };
}
Reader scalar(std::optional<float> Look::*member) {
  return [member](Look& look, std::string_view text) {
    if (const auto value = take_number(text)) look.*member = std::max(*value, 0.0f);
  };
}
Reader texture(Map Look::*member) {
  return [member](Look& look, std::string_view text) { look.*member = map_of(text); };
}

/// Statement, in lower case, and what it does.
const std::map<std::string, Reader, std::less<>>& readers() {
  static const std::map<std::string, Reader, std::less<>> all = {
      {"kd", [](Look& l, std::string_view t) { l.color = color(t).value_or(l.color); }},
      {"ks", [](Look& l, std::string_view t) { l.specular = color(t); }},
      {"ke", [](Look& l, std::string_view t) { l.emission = color(t).value_or(l.emission); }},
      {"ns", scalar(&Look::shininess)},
      {"ni", scalar(&Look::ior)},
      {"d",
       [](Look& l, std::string_view t) {
         if (t.starts_with("-halo")) take_word(t);
         if (const auto value = take_number(t)) l.opacity = *value;
       }},
      {"tr",
       [](Look& l, std::string_view t) {
         if (const auto value = take_number(t)) l.opacity = 1.0f - *value;
       }},
      {"pr", scalar(&Look::roughness)},
      {"pm", scalar(&Look::metallic)},
      {"ps", scalar(&Look::sheen)},
      {"pc", scalar(&Look::clearcoat)},
      {"pcr", scalar(&Look::clearcoat_roughness)},
      {"aniso", scalar(&Look::anisotropy)},
      {"anisor", scalar(&Look::anisotropy_turns)},
      {"map_kd", texture(&Look::color_map)},
      {"map_ks", texture(&Look::specular_map)},
      {"map_ke", texture(&Look::emission_map)},
      {"map_d", texture(&Look::opacity_map)},
      {"map_pr", texture(&Look::roughness_map)},
      {"map_pm", texture(&Look::metallic_map)},
      {"map_ps", texture(&Look::sheen_map)},
      {"map_pc", texture(&Look::clearcoat_map)},
      {"norm", texture(&Look::normal_map)},
      {"map_kn", texture(&Look::normal_map)},
      {"map_bump", texture(&Look::bump_map)},
      {"bump", texture(&Look::bump_map)},
      {"map_rma", texture(&Look::packed_map)},
      {"map_orm", texture(&Look::packed_map)},
  };
  return all;
}

/// Calls `read(statement in lower case, rest)` for each line; a backslash at its end joins the next.
void for_each_statement(std::string_view text, const std::function<void(const std::string&, std::string_view)>& read) {
  std::string joined;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find_first_of("\n\r", at), text.size());
    std::string_view line = trimmed(text.substr(at, end - at));
    at = end + (text.substr(end).starts_with("\r\n") ? 2 : 1);
    if (line.ends_with('\\')) {
      joined.append(line.substr(0, line.size() - 1)).push_back(' ');
      continue;
    }
    joined.append(line);
    std::string_view rest = trimmed(joined);
    constexpr std::string_view kMark = "\xEF\xBB\xBF";
    if (rest.starts_with(kMark)) rest = trimmed(rest.substr(kMark.size()));
    if (!rest.empty() && rest.front() != '#') {
      const std::string word = lower_case(std::string(take_word(rest)));
      read(word, rest);
    }
    joined.clear();
  }
}

}  // namespace

std::vector<Look> read_mtl(std::string_view text) {
  std::vector<Look> looks;
  for_each_statement(text, [&](const std::string& word, std::string_view rest) {
    if (word == "newmtl") {
      looks.emplace_back().name = rest;
    } else if (!looks.empty()) {
      Look& look = looks.back();
      if (const auto found = readers().find(word); found != readers().end()) {
        found->second(look, rest);
      } else if (word == "map_ns" || word == "disp" || word == "decal" || word == "refl" || word == "map_pcr" ||
                 word == "map_aniso") {
        look.unused.push_back(word);
      }
    }
  });
  return looks;
}

std::vector<std::string> material_libraries(std::string_view obj) {
  std::vector<std::string> names;
  constexpr std::string_view kStatement = "mtllib";
  for (std::size_t at = obj.find(kStatement); at != obj.npos; at = obj.find(kStatement, at + kStatement.size())) {
    if (at > 0 && obj.substr(0, at).find_last_not_of(" \t") != obj.npos) {
      const char before = obj[obj.substr(0, at).find_last_not_of(" \t")];
      if (before != '\n' && before != '\r') continue;  // in a comment or a name
    }
    const std::string_view rest = obj.substr(at + kStatement.size());
    std::string name(trimmed(rest.substr(0, rest.find_first_of("\n\r"))));
    if (!name.empty() && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(std::move(name));
  }
  return names;
}

}  // namespace candela::foreign
