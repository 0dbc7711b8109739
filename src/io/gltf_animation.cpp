#include "io/gltf_animation.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <utility>

namespace candela::io {

namespace {

constexpr std::size_t kLongestPath = 40;  // characters of a target's path that are worth repeating

enum class Interpolation { step, linear, cubic_spline };

Interpolation read_interpolation(const JsonView& sampler) {
  const std::string name = sampler.string_or("interpolation", "LINEAR");
  if (name == "STEP") return Interpolation::step;
  if (name == "LINEAR") return Interpolation::linear;
  if (name == "CUBICSPLINE") return Interpolation::cubic_spline;
  throw sampler.at("interpolation").error("must be STEP, LINEAR or CUBICSPLINE");
}

std::vector<float> read_times(const JsonView& reference, AccessorReader& reader) {
  std::vector<float> times = reader.read_as<float>(reader.open(reference, {"SCALAR"}));
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (times[i] < 0 || (i > 0 && times[i] <= times[i - 1])) {
      throw reference.error(fmt::format("the times of an animation must ascend from 0; key {} is {}", i, times[i]));
    }
  }
  return times;
}

/// How values of a type stand in an accessor; KHR_animation_pointer, "Output Accessor Type".
struct Shape {
  const char* accessor;
  std::size_t width;  ///< numbers of a value; 0 for as many as there are
};

Shape shape_of(PropertyType type) {
  switch (type) {
    case PropertyType::boolean:
    case PropertyType::number:
      return {"SCALAR", 1};
    case PropertyType::numbers:
      return {"SCALAR", 0};
    case PropertyType::vec2:
      return {"VEC2", 2};
    case PropertyType::vec3:
      return {"VEC3", 3};
    case PropertyType::vec4:
    case PropertyType::rotation:
      return {"VEC4", 4};
  }
  return {"SCALAR", 1};
}

/// Every value as floats, one after the other.
std::vector<float> read_values(const JsonView& reference, PropertyType type, AccessorReader& reader) {
  const Accessor accessor = reader.open(reference, {shape_of(type).accessor});
  if (type == PropertyType::boolean && accessor.component_type != kU8) {
    throw reference.error("true and false must be stored as unsigned bytes");
  }
  const auto flat = [](const auto& vectors) {
    std::vector<float> result;
    for (const auto& v : vectors) {
      for (int i = 0; i < v.length(); ++i) result.push_back(v[i]);
    }
    return result;
  };
  if (accessor.components == 2) return flat(reader.read_as<vec2>(accessor));
  if (accessor.components == 3) return flat(reader.read_as<vec3>(accessor));
  if (accessor.components == 4) return flat(reader.read_as<vec4>(accessor));
  return reader.read_as<float>(accessor);
}

/// The spherical way between two rotations, the shorter one.
void slerp(const float* a, const float* b, float t, float* out) {
  const quat q = glm::slerp(quat(a[3], a[0], a[1], a[2]), quat(b[3], b[0], b[1], b[2]), t);
  out[0] = q.x, out[1] = q.y, out[2] = q.z, out[3] = q.w;
}

/// One sampler at one time.
class Sampler {
 public:
  Sampler(const JsonView& json, PropertyType type, AccessorReader& reader)
      : type_(type),
        interpolation_(read_interpolation(json)),
        times_(read_times(json.at("input"), reader)),
        values_(read_values(json.at("output"), type, reader)) {
    if (type == PropertyType::boolean && interpolation_ != Interpolation::step) {
      throw json.error("between true and false nothing can be interpolated: the interpolation must be STEP");
    }
    const std::size_t keys = times_.size() * per_key();
    width_ = values_.size() / keys;
    if (width_ == 0 || width_ * keys != values_.size()) {
      throw json.at("output").error(fmt::format("{} numbers do not fit {} keys", values_.size(), times_.size()));
    }
  }

  std::size_t width() const { return width_; }

  std::vector<float> at(double time) const {
    const auto t = static_cast<float>(time);
    std::vector<float> result(width_);
    const auto after = std::upper_bound(times_.begin(), times_.end(), t);
    if (after == times_.begin() || after == times_.end() || interpolation_ == Interpolation::step) {
      const auto key = after == times_.begin() ? 0 : static_cast<std::size_t>(after - times_.begin()) - 1;
      std::copy_n(value(key), width_, result.begin());
      return result;
    }
    const auto next = static_cast<std::size_t>(after - times_.begin()), last = next - 1;
    const float span = times_[next] - times_[last];
    const float u = (t - times_[last]) / span;
    if (interpolation_ == Interpolation::linear && type_ == PropertyType::rotation) {
      slerp(value(last), value(next), u, result.data());
    } else if (interpolation_ == Interpolation::linear) {
      for (std::size_t i = 0; i < width_; ++i) result[i] = glm::mix(value(last)[i], value(next)[i], u);
    } else {
      const float u2 = u * u, u3 = u2 * u;
      const float* out_tangent = value(last) + width_;
      const float* in_tangent = value(next) - width_;
      for (std::size_t i = 0; i < width_; ++i) {
        result[i] = (2 * u3 - 3 * u2 + 1) * value(last)[i] + span * (u3 - 2 * u2 + u) * out_tangent[i] +
                    (3 * u2 - 2 * u3) * value(next)[i] + span * (u3 - u2) * in_tangent[i];
      }
    }
    return result;
  }

 private:
  bool is_spline() const { return interpolation_ == Interpolation::cubic_spline; }
  /// A key of a spline is in-tangent, value, out-tangent.
  std::size_t per_key() const { return is_spline() ? 3 : 1; }
  const float* value(std::size_t key) const {
    return values_.data() + (key * per_key() + (is_spline() ? 1 : 0)) * width_;
  }

  PropertyType type_;
  Interpolation interpolation_;
  std::vector<float> times_;
  std::vector<float> values_;
  std::size_t width_ = 0;
};

void move(FileNode& node, const std::string& path, const std::vector<float>& v) {
  if (path == "translation") {
    node.translation = vec3(v[0], v[1], v[2]);
    if (node.has_matrix) node.parent_from_node[3] = vec4(node.translation, 1.0f);
  } else if (path == "scale") {
    node.scale = vec3(v[0], v[1], v[2]);
  } else if (path == "rotation") {
    const quat q(v[3], v[0], v[1], v[2]);
    const float length = glm::length(q);
    // Splines pass near 0 at worst; there is then no direction to keep.
    node.rotation = length > 1e-6f ? q / length : quat(1, 0, 0, 0);
  } else {
    node.weights = v;
  }
}

std::optional<PropertyType> type_of(const std::string& path) {
  if (path == "translation" || path == "scale") return PropertyType::vec3;
  if (path == "rotation") return PropertyType::rotation;
  return path == "weights" ? std::optional(PropertyType::numbers) : std::nullopt;
}

/// What the target of a channel means; none, with a warning, where it cannot be moved.
std::optional<Target> find_target(const JsonView& json, const nlohmann::json& document, std::size_t node_count,
                                  Warnings& warnings) {
  const std::string path = json.at("path").string();
  const auto node = json.index_of("node", node_count, "node");
  const auto extension = path == "pointer" ? json.extension("KHR_animation_pointer") : std::nullopt;
  if (extension) {
    if (node) warnings.warn("a channel with a pointer must have no node; the pointer counts", json);
    return find_property(document, extension->at("pointer"), warnings);
  }
  const auto type = type_of(path);
  if (!type) {
    warnings.warn(
        fmt::format("an animation of '{}' is not supported and will be ignored", path.substr(0, kLongestPath)), json);
    return std::nullopt;
  }
  if (!node) return std::nullopt;  // as the specification asks
  return Target{{"nodes", std::to_string(*node), path}, *type, false};
}

/// In words, as what two channels move.
std::string name_of(const Target& target) {
  if (!target.is_of_node()) return target.pointer();
  const std::string what = target.tokens.size() == 4 ? "weight " + target.tokens[3] : target.tokens[2];
  return fmt::format("the {} of node {}", what, target.tokens[1]);
}

}  // namespace

std::vector<AnimationInfo> read_animation_list(const JsonView& root) {
  std::vector<AnimationInfo> list;
  for (std::size_t i = 0; i < count_of(root, "animations"); ++i) {
    const JsonView json = root.at("animations")[i];
    AnimationInfo& info = list.emplace_back();
    info.name = json.string_or("name");
    const auto channels = json.find("channels");
    if (channels) info.channels = static_cast<int>(channels->size());
    for (std::size_t k = 0; channels && k < channels->size(); ++k) {
      if (const auto moved = pointer_extension((*channels)[k])) info.pointers.push_back(moved->at("pointer").string());
    }
    const auto samplers = json.find("samplers");
    for (std::size_t k = 0; samplers && k < samplers->size(); ++k) {
      const std::size_t accessor = (*samplers)[k].at("input").index(count_of(root, "accessors"), "accessor");
      const auto most = root.at("accessors")[accessor].find("max");
      if (most && most->size() == 1) info.duration_s = std::max(info.duration_s, (*most)[0].real());
    }
  }
  return list;
}

std::vector<std::size_t> find_animations(const JsonView& root, const std::string& name) {
  const std::size_t count = count_of(root, "animations");
  std::vector<std::size_t> all(count);
  for (std::size_t i = 0; i < count; ++i) all[i] = i;
  if (name.empty()) all.resize(std::min<std::size_t>(count, 1));
  if (name.empty() || (name == "all" && count > 0)) return all;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < count; ++i) {
    names.push_back(root.at("animations")[i].string_or("name"));
    if (names.back() == name) return {i};
  }
  std::size_t index = count;
  const auto [end, code] = std::from_chars(name.data(), name.data() + name.size(), index);
  if (code == std::errc() && end == name.data() + name.size() && index < count) return {index};
  throw root.error(fmt::format("there is no animation '{}'; the file has: {}", name,
                               count == 0 ? "none" : fmt::format("{}", fmt::join(names, ", "))));
}

void check_channels(const JsonView& root, const nlohmann::json& document, Warnings& warnings) {
  const std::size_t nodes = count_of(root, "nodes");
  // What is ignored is said when it should move.
  Diagnostics unsaid;
  Warnings later(unsaid);
  for (std::size_t i = 0; i < count_of(root, "animations"); ++i) {
    const auto channels = root.at("animations")[i].find("channels");
    std::set<std::string> moved, moved_in_part;
    for (std::size_t k = 0; channels && k < channels->size(); ++k) {
      const auto json = (*channels)[k].find("target");
      const auto target =
          json && json->find("path") ? find_target(*json, document, nodes, later) : std::optional<Target>();
      if (!target) continue;
      // All weights and a single one of them are one property, too.
      const std::string pointer = target->pointer();
      const bool is_part = target->tokens.size() == 4 && target->tokens[2] == "weights";
      const std::string whole = is_part ? pointer.substr(0, pointer.rfind('/')) : std::string();
      const bool is_twice = !moved.insert(pointer).second || moved_in_part.contains(pointer) || moved.contains(whole);
      if (is_part) moved_in_part.insert(whole);
      if (!is_twice) continue;
      warnings.warn(fmt::format("two channels move {}; the last one counts", name_of(*target)), (*channels)[k]);
    }
  }
}

AnimatedMoment::AnimatedMoment(const JsonView& root, const nlohmann::json& document, std::size_t animation, double time,
                               AccessorReader& reader, Warnings& warnings)
    : root_(root), warnings_(warnings) {
  const JsonView json = root.at("animations")[animation];
  const JsonView channels = json.at("channels"), samplers = json.at("samplers");
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const JsonView place = channels[i].at("target");
    auto target = find_target(place, document, count_of(root, "nodes"), warnings);
    if (!target) continue;
    const JsonView sampler = samplers[channels[i].at("sampler").index(samplers.size(), "sampler")];
    const Sampler values(sampler, target->type, reader);
    const std::size_t expected = shape_of(target->type).width;
    if (expected > 0 && values.width() != expected) {
      throw sampler.at("output").error(
          fmt::format("{} numbers for each key of a {}", values.width(), target->tokens.back()));
    }
    values_.push_back({*std::move(target), values.at(time), place});
  }
}

void AnimatedMoment::move_properties(MovedDocument& document) const {
  for (const Value& value : values_) {
    if (!value.target.is_of_node()) document.set(value.target, value.numbers, value.place, warnings_);
  }
}

/// One for each morph target, of the node, else of its mesh, else 0.
std::vector<float> AnimatedMoment::rest_weights(const FileNode& node, std::size_t index) const {
  std::vector<float> weights = read_weights(root_.at("nodes")[index]);
  if (weights.empty() && node.mesh) weights = read_weights(root_.at("meshes")[*node.mesh]);
  return weights;
}

void AnimatedMoment::pose_nodes(std::vector<FileNode>& nodes) const {
  for (const auto& [target, numbers, place] : values_) {
    if (!target.is_of_node()) continue;
    const std::size_t index = target.index(1);
    FileNode& node = nodes[index];
    const std::string& path = target.tokens[2];
    if (target.tokens.size() == 4) {
      if (!node.weights) node.weights = rest_weights(node, index);
      const std::size_t element = target.index(3);
      if (node.weights->size() <= element) node.weights->resize(element + 1, 0.0f);
      (*node.weights)[element] = numbers[0];
    } else if (node.has_matrix && path != "weights" && !(target.is_pointer && path == "translation")) {
      // A pointer may move its last column: there is no other way to take a matrix apart without ambiguity.
      warnings_.warn("a node that has a matrix cannot be animated and rests", place);
    } else {
      move(node, path, numbers);
    }
  }
}

}  // namespace candela::io
