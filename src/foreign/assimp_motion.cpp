// What moves: skins, and animations of nodes and of morph targets.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "foreign/assimp_scene.h"

namespace candela::foreign {

using Json = nlohmann::json;

namespace {

constexpr double kDefaultTicks = 25.0;  // per second, where a file does not say

/// Seconds of keys, strictly rising as glTF wants them; of equal times the first counts.
template <class Key>
std::vector<const Key*> rising(const Key* keys, unsigned count) {
  std::vector<const Key*> kept;
  for (unsigned i = 0; i < count; ++i) {
    if (!std::isfinite(keys[i].mTime)) continue;
    if (kept.empty() || static_cast<float>(keys[i].mTime) > static_cast<float>(kept.back()->mTime)) {
      kept.push_back(&keys[i]);
    }
  }
  return kept;
}

template <class Key>
std::vector<float> seconds(const std::vector<const Key*>& keys, double ticks_per_second, double start) {
  std::vector<float> result;
  result.reserve(keys.size());
  for (const Key* key : keys) result.push_back(static_cast<float>((key->mTime - start) / ticks_per_second));
  return result;
}

/// Before 0 there is nothing in glTF.
double first_time(const aiAnimation& animation) {
  double first = 0.0;
  for (unsigned c = 0; c < animation.mNumChannels; ++c) {
    const aiNodeAnim& channel = *animation.mChannels[c];
    if (channel.mNumPositionKeys > 0) first = std::min(first, channel.mPositionKeys[0].mTime);
    if (channel.mNumRotationKeys > 0) first = std::min(first, channel.mRotationKeys[0].mTime);
    if (channel.mNumScalingKeys > 0) first = std::min(first, channel.mScalingKeys[0].mTime);
  }
  for (unsigned c = 0; c < animation.mNumMorphMeshChannels; ++c) {
    const aiMeshMorphAnim& channel = *animation.mMorphMeshChannels[c];
    if (channel.mNumKeys > 0) first = std::min(first, channel.mKeys[0].mTime);
  }
  return std::isfinite(first) ? first : 0.0;
}

void add_channel(Json& animation, std::size_t node, const char* path, std::size_t input, std::size_t output) {
  animation["samplers"].push_back({{"input", input}, {"output", output}});
  animation["channels"].push_back(
      {{"sampler", animation["samplers"].size() - 1}, {"target", {{"node", node}, {"path", path}}}});
}

}  // namespace

void SceneWriter::write_influences(const aiMesh& mesh, Json& attributes) {
  constexpr std::size_t kMostSets = 2, kPerSet = 4;
  std::vector<std::vector<std::pair<float, std::uint16_t>>> influences(mesh.mNumVertices);
  for (unsigned b = 0; b < mesh.mNumBones && b <= std::numeric_limits<std::uint16_t>::max(); ++b) {
    const aiBone& bone = *mesh.mBones[b];
    if (find_node(bone.mName.C_Str()) < 0 && scene_.mRootNode->FindNode(bone.mName) == nullptr) continue;
    for (unsigned w = 0; w < bone.mNumWeights; ++w) {
      const aiVertexWeight& weight = bone.mWeights[w];
      if (weight.mVertexId < mesh.mNumVertices && weight.mWeight > 0.0f) {
        influences[weight.mVertexId].emplace_back(weight.mWeight, static_cast<std::uint16_t>(b));
      }
    }
  }
  std::size_t most = 1;
  for (auto& one : influences) {
    std::stable_sort(one.begin(), one.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    one.resize(std::min(one.size(), kMostSets * kPerSet));
    most = std::max(most, one.size());
  }
  for (std::size_t set = 0; set * kPerSet < most; ++set) {
    std::vector<std::uint16_t> joints(influences.size() * kPerSet);
    std::vector<vec4> weights(influences.size(), vec4(0.0f));
    for (std::size_t v = 0; v < influences.size(); ++v) {
      float sum = 0.0f;
      for (const auto& [weight, joint] : influences[v]) sum += weight;
      for (std::size_t i = 0; i < kPerSet && set * kPerSet + i < influences[v].size(); ++i) {
        const auto& [weight, joint] = influences[v][set * kPerSet + i];
        joints[v * kPerSet + i] = joint;
        weights[v][static_cast<int>(i)] = weight / sum;
      }
      // What no bone holds follows the first.
      if (influences[v].empty() && set == 0) weights[v].x = 1.0f;
    }
    const std::size_t view = draft_.add_view(std::as_bytes(std::span(joints)));
    attributes[fmt::format("JOINTS_{}", set)] = draft_.add("accessors", {{"bufferView", view},
                                                                         {"componentType", Draft::kUnsignedShort},
                                                                         {"count", influences.size()},
                                                                         {"type", "VEC4"}});
    attributes[fmt::format("WEIGHTS_{}", set)] = draft_.add_vectors(std::span<const vec4>(weights));
  }
}

/// Joints are nodes, so that skins come after them. A bone whose node is not there stays where the root is.
void SceneWriter::write_skins() {
  for (const auto& [node, index] : skinned_) {
    const aiMesh& mesh = *scene_.mMeshes[index];
    Json joints = Json::array();
    std::vector<vec4> columns;
    for (unsigned b = 0; b < mesh.mNumBones; ++b) {
      const aiBone& bone = *mesh.mBones[b];
      joints.push_back(std::max(find_node(bone.mName.C_Str()), 0));
      const mat4 joint_from_mesh = matrix_of(bone.mOffsetMatrix);
      for (int c = 0; c < 4; ++c) columns.push_back(joint_from_mesh[c]);
    }
    const std::size_t view = draft_.add_view(std::as_bytes(std::span(columns)));
    const std::size_t accessor = draft_.add(
        "accessors",
        {{"bufferView", view}, {"componentType", Draft::kFloat}, {"count", mesh.mNumBones}, {"type", "MAT4"}});
    draft_.gltf["nodes"][node]["skin"] =
        draft_.add("skins", {{"joints", std::move(joints)}, {"inverseBindMatrices", accessor}});
  }
}

void SceneWriter::write_channels(const aiNodeAnim& channel, double ticks_per_second, double start, Json& animation) {
  const int node = find_node(channel.mNodeName.C_Str());
  if (node < 0) return;
  const auto moved = static_cast<std::size_t>(node);
  const auto add_vectors = [&](const aiVectorKey* keys, unsigned count, const char* path) {
    const auto kept = rising(keys, count);
    if (kept.empty()) return;
    std::vector<vec3> values;
    values.reserve(kept.size());
    for (const aiVectorKey* key : kept) values.emplace_back(key->mValue.x, key->mValue.y, key->mValue.z);
    const std::size_t input = draft_.add_times(seconds(kept, ticks_per_second, start));
    add_channel(animation, moved, path, input, draft_.add_vectors(std::span<const vec3>(values)));
  };
  add_vectors(channel.mPositionKeys, channel.mNumPositionKeys, "translation");
  add_vectors(channel.mScalingKeys, channel.mNumScalingKeys, "scale");
  const auto kept = rising(channel.mRotationKeys, channel.mNumRotationKeys);
  if (kept.empty()) return;
  std::vector<vec4> values;
  for (const aiQuatKey* key : kept) {
    aiQuaternion q = key->mValue;
    q.Normalize();
    values.emplace_back(q.x, q.y, q.z, q.w);
  }
  const std::size_t input = draft_.add_times(seconds(kept, ticks_per_second, start));
  add_channel(animation, moved, "rotation", input, draft_.add_vectors(std::span<const vec4>(values)));
}

void SceneWriter::write_weights(const aiMeshMorphAnim& channel, double ticks_per_second, double start,
                                Json& animation) {
  // Importers put a number behind the name of one of several meshes.
  std::string name = channel.mName.C_Str();
  if (!morphed_.contains(name)) name = name.substr(0, name.find('*'));
  const auto kept = rising(channel.mKeys, channel.mNumKeys);
  if (kept.empty()) return;
  const auto [first, last] = morphed_.equal_range(name);
  for (auto at = first; at != last; ++at) {
    const auto& [node, mesh] = at->second;
    const std::size_t targets = scene_.mMeshes[mesh]->mNumAnimMeshes;
    std::vector<float> weights(kept.size() * targets);
    for (std::size_t k = 0; k < kept.size(); ++k) {
      for (unsigned i = 0; i < kept[k]->mNumValuesAndWeights; ++i) {
        const unsigned target = kept[k]->mValues[i];
        if (target < targets) weights[k * targets + target] = static_cast<float>(kept[k]->mWeights[i]);
      }
    }
    const std::size_t input = draft_.add_times(seconds(kept, ticks_per_second, start));
    add_channel(animation, node, "weights", input, draft_.add_floats(weights));
  }
}

void SceneWriter::write_animations() {
  for (unsigned i = 0; i < scene_.mNumAnimations; ++i) {
    const aiAnimation& source = *scene_.mAnimations[i];
    const double ticks = source.mTicksPerSecond > 0.0 ? source.mTicksPerSecond : kDefaultTicks;
    const double start = first_time(source);
    Json animation{{"name", source.mName.C_Str()}};
    for (unsigned c = 0; c < source.mNumChannels; ++c) write_channels(*source.mChannels[c], ticks, start, animation);
    for (unsigned c = 0; c < source.mNumMorphMeshChannels; ++c) {
      write_weights(*source.mMorphMeshChannels[c], ticks, start, animation);
    }
    if (source.mNumMeshChannels > 0) {
      draft_.diagnostics.warn(
          fmt::format("animation '{}': exchanged meshes are not carried over", source.mName.C_Str()));
    }
    if (animation.contains("channels")) draft_.add("animations", std::move(animation));
  }
}

}  // namespace candela::foreign
