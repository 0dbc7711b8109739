#include "candela/part.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "base/error.h"
#include "base/file.h"
#include "base/large_pages.h"
#include "base/memory.h"
#include "image/zstandard.h"
#include "path/accumulator.h"
#include "scene/surface_layers.h"

namespace candela {

namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kMagic = "candela picture part 1\n";
constexpr int kMostSide = 65536;

/// What an accumulator has to know of the picture.
path::Accumulator accumulator_of(const PicturePart& part) {
  path::Settings settings;
  settings.width = part.size.x;
  settings.height = part.size.y;
  settings.layers = part.layers;
  settings.mattes = part.mattes;
  settings.has_features = part.has_features;
  return path::Accumulator(settings, part.has_through);
}

/// Into sums of the part's shape; where there are none yet, they are made.
void read_sums(const PicturePart& part, std::unique_ptr<path::Accumulator>& sums) {
  const std::uint64_t pixels = static_cast<std::uint64_t>(part.size.x) * static_cast<std::uint64_t>(part.size.y);
  std::span<const std::byte> bytes(part.sums);
  // Before so much memory is taken.
  if (bytes.size() / path::Accumulator::least_bytes_per_pixel() < pixels) {
    throw Error("damaged part of a picture: the sums end before their pixels do");
  }
  if (sums == nullptr) sums = std::make_unique<path::Accumulator>(accumulator_of(part));
  try {
    sums->read(bytes);
  } catch (const Error& error) {
    throw Error("damaged part of a picture: " + error.message());
  }
  if (!bytes.empty()) throw Error("damaged part of a picture: it holds more than its pixels");
}

bool are_alike(const PicturePart& a, const PicturePart& b) {
  return a.key == b.key && a.size == b.size && a.layers == b.layers && a.mattes == b.mattes &&
         a.has_features == b.has_features && a.has_through == b.has_through;
}

template <class T>
void append(const std::vector<T>& values, std::vector<std::byte>& bytes) {
  const auto raw = std::as_bytes(std::span(values));
  bytes.insert(bytes.end(), raw.begin(), raw.end());
}

Json header_json(const PicturePart& p) {
  Json json{{"key", p.key},
            {"first_sample", p.first_sample},
            {"end_sample", p.end_sample},
            {"samples", p.samples},
            {"width", p.size.x},
            {"height", p.size.y},
            {"layers", Json::array()},
            {"mattes", Json::object()},
            {"has_features", p.has_features},
            {"has_through", p.has_through},
            {"camera_from_world", Json::array()},
            {"metadata", p.metadata},
            {"tone_curve", tone_curve_name(p.develop.tone_curve)},
            {"exposure", p.develop.exposure ? Json(*p.develop.exposure) : Json(nullptr)},
            {"bloom", p.develop.bloom},
            {"background_opacity", p.develop.background_opacity},
            {"background", nullptr},
            {"denoiser", p.denoiser ? Json(denoise::method_name(*p.denoiser)) : Json(nullptr)}};
  for (const Layer layer : p.layers) json["layers"].push_back(layer_name(layer));
  for (const MatteKind kind : p.mattes) {
    Json names = Json::array();
    if (const auto found = p.names.find(kind); found != p.names.end()) {
      for (const auto& [number, name] : found->second) names.push_back({number, name});
    }
    json["mattes"][std::string(kMatteKinds[static_cast<std::size_t>(kind)].name)] = names;
  }
  for (int i = 0; i < 9; ++i) json["camera_from_world"].push_back(p.camera_from_world[i / 3][i % 3]);
  if (const auto& b = p.develop.background) json["background"] = {b->x, b->y, b->z};
  return json;
}

PicturePart part_of_header(const Json& json) {
  PicturePart p;
  p.key = json.at("key").get<std::string>();
  p.first_sample = json.at("first_sample").get<int>();
  p.end_sample = json.at("end_sample").get<int>();
  p.samples = json.at("samples").get<int>();
  p.size = {json.at("width").get<int>(), json.at("height").get<int>()};
  for (const Json& name : json.at("layers")) p.layers.insert(parse_layer(name.get<std::string>()));
  for (const auto& [name, list] : json.at("mattes").items()) {
    const MatteKind kind = parse_matte_kind(name);
    p.mattes.insert(kind);
    p.names[kind] = {};
    for (const Json& entry : list) p.names[kind][entry.at(0).get<std::uint32_t>()] = entry.at(1).get<std::string>();
  }
  p.has_features = json.at("has_features").get<bool>();
  p.has_through = json.at("has_through").get<bool>();
  for (int i = 0; i < 9; ++i) {
    p.camera_from_world[i / 3][i % 3] = json.at("camera_from_world").at(static_cast<std::size_t>(i)).get<float>();
  }
  p.metadata = json.at("metadata").get<std::map<std::string, std::string>>();
  p.develop.tone_curve = parse_tone_curve(json.at("tone_curve").get<std::string>());
  if (!json.at("exposure").is_null()) p.develop.exposure = json.at("exposure").get<float>();
  p.develop.bloom = json.at("bloom").get<float>();
  p.develop.background_opacity = json.at("background_opacity").get<float>();
  if (const Json& b = json.at("background"); !b.is_null()) {
    p.develop.background = vec3(b.at(0).get<float>(), b.at(1).get<float>(), b.at(2).get<float>());
  }
  if (!json.at("denoiser").is_null()) p.denoiser = denoise::parse_method(json.at("denoiser").get<std::string>());
  const auto is_finite = [](float v) { return std::isfinite(v); };
  const float* matrix = &p.camera_from_world[0][0];
  const bool has_numbers = std::all_of(matrix, matrix + 9, is_finite) && is_finite(p.develop.exposure.value_or(1.0f)) &&
                           is_finite(p.develop.bloom) && is_finite(p.develop.background_opacity) &&
                           candela::is_finite(p.develop.background.value_or(vec3(0.0f)));
  const bool is_possible = has_numbers && p.size.x > 0 && p.size.y > 0 && p.size.x <= kMostSide &&
                           p.size.y <= kMostSide && p.first_sample >= 0 && p.first_sample < p.end_sample &&
                           p.end_sample <= p.samples;
  if (!is_possible) throw Error("its numbers are impossible");
  return p;
}

std::size_t centre_bytes(const PicturePart& p) {
  std::size_t channels = 0;
  for (const Layer layer : p.layers)
    channels += layer_info(layer).has_mean ? 0 : static_cast<std::size_t>(layer_channels(layer));
  return channels * sizeof(float) * static_cast<std::size_t>(p.size.x) * static_cast<std::size_t>(p.size.y);
}

/// What follows the header: the layers of pixels' centres, then the sums. Fills a part with it, piece by piece.
class Body {
 public:
  Body(PicturePart& part, std::size_t size) : part_(part) {
    if (size < centre_bytes(part)) throw Error("is cut short");
    for (const Layer layer : part.layers) {
      if (layer_info(layer).has_mean) continue;
      Image& image = part.centres[layer] = Image(part.size.x, part.size.y, layer_channels(layer));
      centres_.push_back(std::as_writable_bytes(std::span(image.pixels)));
    }
    part.sums.reserve(size - centre_bytes(part));
    advise_large_pages(part.sums.data(), part.sums.capacity());
  }

  void take(std::span<const std::byte> bytes) {
    fingerprint_ = candela::fingerprint(bytes, fingerprint_);
    while (!bytes.empty() && next_ < centres_.size()) {
      std::span<std::byte>& into = centres_[next_];
      const std::size_t count = std::min(into.size(), bytes.size());
      std::copy_n(bytes.begin(), count, into.begin());
      into = into.subspan(count), bytes = bytes.subspan(count);
      if (into.empty()) ++next_;
    }
    part_.sums.insert(part_.sums.end(), bytes.begin(), bytes.end());
  }

  std::uint64_t fingerprint() const { return fingerprint_; }

 private:
  PicturePart& part_;
  std::vector<std::span<std::byte>> centres_;
  std::size_t next_ = 0;
  std::uint64_t fingerprint_ = candela::fingerprint({});
};

}  // namespace

PartRange parse_part(const std::string& text) {
  constexpr int kMost = 1'000'000;
  PartRange range;
  const char *at = text.data(), *const end = at + text.size();
  const auto index = std::from_chars(at, end, range.index);
  const bool has_slash = index.ec == std::errc() && index.ptr != end && *index.ptr == '/';
  const auto count = has_slash ? std::from_chars(index.ptr + 1, end, range.count) : index;
  const bool is_whole = has_slash && count.ec == std::errc() && count.ptr == end;
  if (!is_whole || range.index < 1 || range.index > range.count || range.count > kMost) {
    throw Error("'" + text + "' is no part: the second of eight is 2/8");
  }
  return range;
}

void write_part(const fs::path& path, const PicturePart& part) { write_file(path, bytes_of_part(part)); }

std::vector<std::byte> bytes_of_part(const PicturePart& part) {
  std::vector<std::byte> body;
  body.reserve(centre_bytes(part) + part.sums.size());
  for (const auto& [layer, image] : part.centres) append(image.pixels, body);
  append(part.sums, body);
  Json header = header_json(part);
  header["bytes"] = body.size();
  header["fingerprint"] = fmt::format("{:016x}", fingerprint(body));
  const std::string text = header.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  const std::string begin = std::string(kMagic) + text;
  const std::vector<std::byte> packed = zstandard_packed(body);
  std::vector<std::byte> bytes(begin.size() + packed.size());
  std::memcpy(bytes.data(), begin.data(), begin.size());
  std::copy(packed.begin(), packed.end(), bytes.begin() + static_cast<std::ptrdiff_t>(begin.size()));
  return bytes;
}

PicturePart read_part(const fs::path& path) {
  return part_of_bytes(read_file(path, std::uint64_t{1} << 38), path.string());
}

PicturePart part_of_bytes(std::span<const std::byte> bytes, const std::string& where) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (!text.starts_with(kMagic)) throw Error("is no part of a picture, or one of another version", where);
  const std::size_t end = text.find('\n', kMagic.size());
  if (end == std::string_view::npos) throw Error("damaged part of a picture: cut short", where);
  try {
    const Json header = Json::parse(text.substr(kMagic.size(), end - kMagic.size()));
    PicturePart part = part_of_header(header);
    const auto size = header.at("bytes").get<std::uint64_t>();
    const std::span<const std::byte> packed = bytes.subspan(end + 1);
    constexpr std::uint64_t kMostPacked = 32768;  // a block of 128 KiB takes 4 bytes
    if (zstandard_size(packed) != size || size / kMostPacked > packed.size())
      throw Error("its sizes contradict each other");
    require_memory(size, available_memory(), "a part of a picture", where);
    Body body(part, size);
    unpack_zstandard(packed, size, [&](std::span<const std::byte> piece) { body.take(piece); });
    if (header.at("fingerprint") != fmt::format("{:016x}", body.fingerprint())) throw Error("its checksum is wrong");
    return part;
  } catch (const Error& error) {
    throw Error("damaged part of a picture: " + error.message(), where);
  } catch (const nlohmann::json::exception&) {
    throw Error("damaged part of a picture: its header", where);
  }
}

MergedPicture::MergedPicture() = default;
MergedPicture::~MergedPicture() = default;

void MergedPicture::add(PicturePart part, const std::string& name) {
  try {
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      if (!are_alike(part, parts_[i])) throw Error("is part of another picture than " + names_[i]);
      const bool is_apart = part.end_sample <= parts_[i].first_sample || part.first_sample >= parts_[i].end_sample;
      if (!is_apart) throw Error("has samples that " + names_[i] + " has");
    }
    read_sums(part, parts_.empty() ? sums_ : read_);
    if (!parts_.empty()) sums_->add(*read_);
  } catch (const Error& error) {
    if (parts_.empty()) sums_.reset();
    throw Error(error.message(), name);
  }
  part.sums = std::vector<std::byte>();  // {} would keep the room
  if (!parts_.empty()) part.centres.clear();
  names_.push_back(name);
  parts_.push_back(std::move(part));
}

Film MergedPicture::film(Diagnostics* diagnostics) const {
  const PicturePart& part = parts_.front();
  Film film;
  sums_->resolve(film, true);
  for (auto& [kind, mattes] : film.mattes) mattes.names = part.names.at(kind);
  if (const auto found = film.layers.find(Layer::camera_normal); found != film.layers.end()) {
    turn(part.camera_from_world, found->second);
  }
  for (const auto& [layer, image] : part.centres) film.layers[layer] = image;
  film.metadata = part.metadata;
  int there = 0;
  for (const PicturePart& p : parts_) there += p.end_sample - p.first_sample;
  film.metadata["samples"] = fmt::format("{}", there);
  if (there < part.samples && diagnostics != nullptr) {
    diagnostics->warn(
        fmt::format("{} of {} samples are missing: the picture has the more noise", part.samples - there, part.samples),
        names_.front());
  }
  return film;
}

}  // namespace candela
