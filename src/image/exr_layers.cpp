#include "image/exr_layers.h"

#include <ImfChannelList.h>
#include <ImfHeader.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>

#include <algorithm>
#include <optional>
#include <set>

#include "base/error.h"

// OpenEXR, "Technical Introduction": a channel LAYER.NAME belongs to a layer, whose own name may have dots; of a file
// with several views (attribute `multiView`) the view's name is the last of them, and plain channels are the first
// view's.

namespace candela::codec {

namespace {

using Kind = ChannelKind;

std::optional<ChannelChoice> channels_of(const Imf::ChannelList& channels, const std::string& layer, Kind kind) {
  const std::string prefix = layer.empty() ? "" : layer + ".";
  const auto has = [&](const char* name) { return channels.findChannel(prefix + name) != nullptr; };
  const auto choice = [&](const char* a, const char* b, const char* c) {
    return ChannelChoice{kind, {prefix + a, prefix + b, prefix + c}, has("A") ? prefix + "A" : ""};
  };
  switch (kind) {
    case Kind::color:
      if (has("R") && has("G") && has("B")) return choice("R", "G", "B");
      break;
    case Kind::luma_chroma:
      if (has("Y") && has("RY") && has("BY")) return choice("Y", "RY", "BY");
      break;
    case Kind::grey:
      if (has("Y")) return choice("Y", "Y", "Y");
      break;
    case Kind::data:
      if (has("X") && has("Y") && has("Z")) return choice("X", "Y", "Z");
      if (has("X") && has("Y")) return ChannelChoice{kind, {prefix + "X", prefix + "Y", ""}, ""};
      if (has("U") && has("V")) return ChannelChoice{kind, {prefix + "U", prefix + "V", ""}, ""};
      for (const char* name : {"Z", "V"})
        if (has(name)) return choice(name, name, name);
      break;
  }
  return std::nullopt;
}

/// A position is X, Y and Z, and no grey Y.
std::optional<ChannelChoice> picture_of(const Imf::ChannelList& channels, const std::string& layer) {
  for (const Kind kind : {Kind::color, Kind::luma_chroma})
    if (auto found = channels_of(channels, layer, kind)) return found;
  const auto data = channels_of(channels, layer, Kind::data);
  if (data && !data->is_single()) return std::nullopt;
  return channels_of(channels, layer, Kind::grey);
}

std::optional<ChannelChoice> anything_of(const Imf::ChannelList& channels, const std::string& layer) {
  auto found = picture_of(channels, layer);
  return found ? found : channels_of(channels, layer, Kind::data);
}

bool is_flat(const Imf::Header& header) { return !header.hasType() || Imf::isImage(header.type()); }

std::set<std::string> layers_of(const Imf::Header& header) {
  std::set<std::string> layers;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
    const std::string name = c.name();
    const std::size_t dot = name.rfind('.');
    if (dot != std::string::npos && dot > 0) layers.insert(name.substr(0, dot));
  }
  return layers;
}

std::string last_name(const std::string& layer) {
  std::string last = layer.substr(layer.rfind('.') + 1);
  std::transform(last.begin(), last.end(), last.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return last;
}

/// Whether a layer is seen by another eye than the first.
bool is_other_view(const Imf::Header& header, const std::string& layer) {
  if (!Imf::hasMultiView(header)) return false;
  const Imf::StringVector& views = Imf::multiView(header);
  const std::string last = layer.substr(layer.rfind('.') + 1);
  return std::find(views.begin(), views.end(), last) != views.end() && last != views.front();
}

struct LayerPicture {
  int part;
  std::string layer;
  ChannelChoice channels;
};

std::vector<LayerPicture> layer_pictures(const Imf::MultiPartInputFile& file) {
  std::vector<LayerPicture> found;
  for (int part = 0; part < file.parts(); ++part) {
    const Imf::Header& header = file.header(part);
    if (!is_flat(header)) continue;
    for (const std::string& layer : layers_of(header))
      if (!is_other_view(header, layer))
        if (auto channels = picture_of(header.channels(), layer)) found.push_back({part, layer, *channels});
  }
  return found;
}

std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 200;  // characters of one line of a message
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.size() > kMost ? text.substr(0, kMost) + "..." : text;
}

/// The only layer with a picture. Of several, the one that renderers call the sum of the others.
std::optional<PartChoice> lone_layer(const Imf::MultiPartInputFile& file, const std::string& where) {
  std::vector<LayerPicture> found = layer_pictures(file);
  if (found.size() > 1) {
    const auto is_part_of_another = [](const LayerPicture& p) {
      const std::string last = last_name(p.layer);
      return last != "combined" && last != "beauty" && last != "rgba";
    };
    std::vector<LayerPicture> whole = found;
    std::erase_if(whole, is_part_of_another);
    if (whole.size() == 1) found = whole;
  }
  if (found.empty()) return std::nullopt;
  if (found.size() > 1) {
    std::vector<std::string> names;
    names.reserve(found.size());
    for (const LayerPicture& p : found) names.push_back(p.layer);
    throw Error("has several layers and none is the picture: name one as FILE:LAYER, of " + listed(names), where);
  }
  return PartChoice{found[0].part, found[0].layer, found[0].channels};
}

std::optional<PartChoice> unnamed(const Imf::MultiPartInputFile& file, const std::string& where) {
  const auto first_with = [&](auto choose) -> std::optional<PartChoice> {
    for (int part = 0; part < file.parts(); ++part)
      if (is_flat(file.header(part)))
        if (auto channels = choose(file.header(part).channels())) return PartChoice{part, "", *channels};
    return std::nullopt;
  };
  for (const Kind kind : {Kind::color, Kind::luma_chroma})
    if (auto found = first_with([&](const auto& channels) { return channels_of(channels, "", kind); })) return found;
  if (auto found = first_with([](const auto& channels) { return picture_of(channels, ""); })) return found;
  if (auto found = lone_layer(file, where)) return found;
  return first_with([](const auto& channels) { return channels_of(channels, "", Kind::data); });
}

std::optional<PartChoice> named(const Imf::MultiPartInputFile& file, const std::string& layer) {
  for (int part = 0; part < file.parts(); ++part) {
    const Imf::Header& header = file.header(part);
    if (!is_flat(header)) continue;
    const Imf::ChannelList& channels = header.channels();
    if (auto found = anything_of(channels, layer)) return PartChoice{part, "", *found};
    const bool is_part = (header.hasName() && header.name() == layer) || (header.hasView() && header.view() == layer);
    if (is_part)
      if (auto found = anything_of(channels, "")) return PartChoice{part, "", *found};
    if (header.hasName() && layer.starts_with(header.name() + "."))
      if (auto found = anything_of(channels, layer.substr(header.name().size() + 1)))
        return PartChoice{part, "", *found};
    if (channels.findChannel(layer) != nullptr) return PartChoice{part, "", {Kind::data, {layer, layer, layer}, ""}};
  }
  return std::nullopt;
}

}  // namespace

std::vector<std::string> channel_names(const Imf::MultiPartInputFile& file) {
  std::vector<std::string> names;
  for (int part = 0; part < file.parts(); ++part) {
    const Imf::ChannelList& channels = file.header(part).channels();
    for (auto c = channels.begin(); c != channels.end(); ++c) names.emplace_back(c.name());
  }
  return names;
}

std::vector<std::string> layer_names(const Imf::MultiPartInputFile& file) {
  std::set<std::string> names;
  for (int part = 0; part < file.parts(); ++part) {
    names.merge(layers_of(file.header(part)));
    if (file.parts() > 1 && file.header(part).hasName()) names.insert(file.header(part).name());
  }
  return {names.begin(), names.end()};
}

PartChoice choose_part(const Imf::MultiPartInputFile& file, const std::string& layer, const std::string& where) {
  if (auto found = layer.empty() ? unnamed(file, where) : named(file, layer)) return *found;
  for (int part = 0; part < file.parts(); ++part)
    if (!is_flat(file.header(part))) throw Error("deep pixels are not supported", where);
  const std::string wanted = layer.empty() ? "picture (R,G,B or Y)" : "layer \"" + layer + "\"";
  throw Error("no " + wanted + " among the channels " + listed(channel_names(file)), where);
}

}  // namespace candela::codec
