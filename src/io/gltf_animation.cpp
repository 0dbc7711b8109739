#include "io/gltf_animation.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
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

/// Every value as floats, one after the other.
std::vector<float> read_values(const JsonView& reference, const char* type, AccessorReader& reader) {
  const Accessor accessor = reader.open(reference, {type});
  const auto flat = [](const auto& vectors) {
    std::vector<float> result;
    for (const auto& v : vectors) {
      for (int i = 0; i < v.length(); ++i) result.push_back(v[i]);
    }
    return result;
  };
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
  Sampler(const JsonView& json, const char* type, AccessorReader& reader)
      : interpolation_(read_interpolation(json)),
        times_(read_times(json.at("input"), reader)),
        values_(read_values(json.at("output"), type, reader)) {
    const std::size_t keys = times_.size() * per_key();
    width_ = values_.size() / keys;
    if (width_ == 0 || width_ * keys != values_.size()) {
      throw json.at("output").error(fmt::format("{} numbers do not fit {} keys", values_.size(), times_.size()));
    }
  }

  std::size_t width() const { return width_; }

  std::vector<float> at(double time, bool is_rotation) const {
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
    if (interpolation_ == Interpolation::linear && is_rotation) {
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

  Interpolation interpolation_;
  std::vector<float> times_;
  std::vector<float> values_;
  std::size_t width_ = 0;
};

void move(FileNode& node, const std::string& path, const std::vector<float>& v) {
  if (path == "translation") {
    node.translation = vec3(v[0], v[1], v[2]);
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

const char* type_of(const std::string& path) {
  if (path == "rotation") return "VEC4";
  return path == "weights" ? "SCALAR" : "VEC3";
}

}  // namespace

std::vector<AnimationInfo> read_animation_list(const JsonView& root) {
  std::vector<AnimationInfo> list;
  for (std::size_t i = 0; i < count_of(root, "animations"); ++i) {
    const JsonView json = root.at("animations")[i];
    AnimationInfo& info = list.emplace_back();
    info.name = json.string_or("name");
    if (const auto channels = json.find("channels")) info.channels = static_cast<int>(channels->size());
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

void check_channels(const JsonView& root, Warnings& warnings) {
  const std::size_t nodes = count_of(root, "nodes");
  for (std::size_t i = 0; i < count_of(root, "animations"); ++i) {
    const auto channels = root.at("animations")[i].find("channels");
    std::set<std::pair<std::size_t, std::string>> moved;
    for (std::size_t k = 0; channels && k < channels->size(); ++k) {
      const auto target = (*channels)[k].find("target");
      const auto node = target ? target->index_of("node", nodes, "node") : std::nullopt;
      const std::string path = target ? target->string_or("path") : std::string();
      if (!node || moved.emplace(*node, path).second) continue;
      warnings.warn(
          fmt::format("two channels move the {} of node {}; the last one counts", path.substr(0, kLongestPath), *node),
          (*channels)[k]);
    }
  }
}

void pose_nodes(const JsonView& animation, double time, AccessorReader& reader, Warnings& warnings,
                std::vector<FileNode>& nodes) {
  const JsonView channels = animation.at("channels"), samplers = animation.at("samplers");
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const JsonView target = channels[i].at("target");
    const std::string path = target.at("path").string();
    if (path != "translation" && path != "rotation" && path != "scale" && path != "weights") {
      warnings.warn(
          fmt::format("an animation of '{}' is not supported and will be ignored", path.substr(0, kLongestPath)),
          target);
      continue;
    }
    const auto index = target.index_of("node", nodes.size(), "node");
    if (!index) continue;  // as the specification asks
    FileNode& node = nodes[*index];
    if (node.has_matrix) {
      warnings.warn("a node that has a matrix cannot be animated and rests", target);
      continue;
    }
    const JsonView sampler = samplers[channels[i].at("sampler").index(samplers.size(), "sampler")];
    const Sampler values(sampler, type_of(path), reader);
    const std::size_t expected = path == "rotation" ? 4 : path == "weights" ? values.width() : 3;
    if (values.width() != expected) {
      throw sampler.at("output").error(fmt::format("{} numbers for each key of a {}", values.width(), path));
    }
    move(node, path, values.at(time, path == "rotation"));
  }
}

}  // namespace candela::io
