#include "foreign/assimp_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "foreign/assimp_look.h"

namespace candela::foreign {

using Json = nlohmann::json;

namespace {

vec3 vector_of(const aiVector3D& v) { return {v.x, v.y, v.z}; }

Json list(const mat4& m) {
  Json result = Json::array();
  for (int c = 0; c < 4; ++c) {
    for (int r = 0; r < 4; ++r) result.push_back(m[c][r]);
  }
  return result;
}

/// Vertex colours are what a display shows, as Blender and three.js read and write them; glTF's are linear.
float linear(float v) {
  v = std::isfinite(v) ? std::clamp(v, 0.0f, 1.0f) : 0.0f;
  return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}

/// A frame that looks along `forward`.
mat4 frame(vec3 position, vec3 forward, vec3 up) {
  forward = glm::dot(forward, forward) > 0.0f ? glm::normalize(forward) : vec3(0, 0, -1);
  vec3 x = glm::cross(forward, up);
  if (!(glm::dot(x, x) > 1e-12f)) {
    x = glm::cross(forward, std::fabs(forward.y) < 0.9f ? vec3(0, 1, 0) : vec3(1, 0, 0));
  }
  x = glm::normalize(x);
  return {vec4(x, 0), vec4(glm::cross(x, forward), 0), vec4(-forward, 0), vec4(position, 1)};
}

}  // namespace

void SceneWriter::add_child(std::size_t parent, std::size_t child) {
  draft_.gltf["nodes"][parent]["children"].push_back(child);
}

int SceneWriter::find_node(const std::string& name) const {
  const auto found = node_of_name_.find(name);
  return found == node_of_name_.end() ? -1 : static_cast<int>(found->second);
}

/// What an animation moves needs translation, rotation and scale.
void SceneWriter::write_transform(const aiNode& source, Json& node) const {
  if (!animated_.contains(source.mName.C_Str())) {
    const mat4 matrix = matrix_of(source.mTransformation);
    if (matrix != mat4(1.0f)) node["matrix"] = list(matrix);
    return;
  }
  aiVector3D scale, position;
  aiQuaternion rotation;
  source.mTransformation.Decompose(scale, rotation, position);
  node["translation"] = {position.x, position.y, position.z};
  node["rotation"] = {rotation.x, rotation.y, rotation.z, rotation.w};
  node["scale"] = {scale.x, scale.y, scale.z};
}

int SceneWriter::write_node(const aiNode& source) {
  Json json{{"name", source.mName.C_Str()}};
  if (&source != scene_.mRootNode || !units_.replaces_root) write_transform(source, json);
  const std::size_t node = draft_.add("nodes", std::move(json));
  node_of_name_.try_emplace(source.mName.C_Str(), node);
  write_meshes(source, node);
  for (unsigned i = 0; i < source.mNumChildren; ++i) {
    add_child(node, static_cast<std::size_t>(write_node(*source.mChildren[i])));
  }
  return static_cast<int>(node);
}

/// A skin and targets belong to a whole mesh of glTF: what has them becomes a mesh in a node of its own.
void SceneWriter::write_meshes(const aiNode& source, std::size_t node) {
  std::vector<unsigned> plain;
  for (unsigned i = 0; i < source.mNumMeshes; ++i) {
    const unsigned index = source.mMeshes[i];
    const aiMesh& mesh_source = *scene_.mMeshes[index];
    if (mesh_source.mNumBones == 0 && mesh_source.mNumAnimMeshes == 0) {
      plain.push_back(index);
      continue;
    }
    const int own = mesh({index});
    if (own < 0) continue;
    const std::size_t child = draft_.add("nodes", {{"name", mesh_source.mName.C_Str()}, {"mesh", own}});
    add_child(node, child);
    if (mesh_source.mNumBones > 0) skinned_.emplace_back(child, index);
    if (mesh_source.mNumAnimMeshes > 0) {
      morphed_.emplace(source.mName.C_Str(), std::pair(child, index));
      if (std::string_view(source.mName.C_Str()) != mesh_source.mName.C_Str()) {
        morphed_.emplace(mesh_source.mName.C_Str(), std::pair(child, index));
      }
    }
  }
  if (const int shared = plain.empty() ? -1 : mesh(plain); shared >= 0) draft_.gltf["nodes"][node]["mesh"] = shared;
}

/// The mesh of these parts; -1 where none has a triangle.
int SceneWriter::mesh(const std::vector<unsigned>& parts) {
  const auto [found, is_new] = meshes_.try_emplace(parts, -1);
  if (!is_new) return found->second;
  Json primitives = Json::array();
  Json weights = Json::array();
  for (const unsigned part : parts) {
    Json one = primitive(part);
    if (one.is_null()) continue;
    primitives.push_back(std::move(one));
    const aiMesh& source = *scene_.mMeshes[part];
    for (unsigned t = 0; t < source.mNumAnimMeshes; ++t) weights.push_back(source.mAnimMeshes[t]->mWeight);
  }
  if (primitives.empty()) return -1;
  Json json{{"name", scene_.mMeshes[parts.front()]->mName.C_Str()}, {"primitives", std::move(primitives)}};
  if (!weights.empty()) json["weights"] = std::move(weights);
  found->second = static_cast<int>(draft_.add("meshes", std::move(json)));
  return found->second;
}

Json SceneWriter::primitive(unsigned index) {
  if (const auto found = primitives_.find(index); found != primitives_.end()) return found->second;
  const aiMesh& mesh = *scene_.mMeshes[index];
  std::vector<std::uint32_t> indices;
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    undrawn_ += face.mNumIndices < 3 ? 1 : 0;
    if (face.mNumIndices != 3) continue;
    for (unsigned i = 0; i < 3; ++i) {
      if (face.mIndices[i] >= mesh.mNumVertices) throw Error("a triangle names a vertex that is not there");
      indices.push_back(face.mIndices[i]);
    }
  }
  Json& json = primitives_[index];
  if (indices.empty() || mesh.mVertices == nullptr) return json;
  const std::size_t count = mesh.mNumVertices;
  std::vector<vec3> vectors(count);
  Json attributes;
  std::transform(mesh.mVertices, mesh.mVertices + count, vectors.begin(), vector_of);
  attributes["POSITION"] = draft_.add_vectors(std::span<const vec3>(vectors));
  if (has_normals_ && mesh.mNormals != nullptr) {
    std::transform(mesh.mNormals, mesh.mNormals + count, vectors.begin(), vector_of);
    attributes["NORMAL"] = draft_.add_vectors(std::span<const vec3>(vectors));
  }
  for (unsigned set = 0; set < mesh.GetNumUVChannels(); ++set) {
    std::vector<vec2> uvs(count);
    std::transform(mesh.mTextureCoords[set], mesh.mTextureCoords[set] + count, uvs.begin(),
                   [](const aiVector3D& v) { return vec2(v.x, 1.0f - v.y); });
    attributes[fmt::format("TEXCOORD_{}", set)] = draft_.add_vectors(std::span<const vec2>(uvs));
  }
  if (mesh.mColors[0] != nullptr) {
    std::vector<vec4> colors(count);
    std::transform(mesh.mColors[0], mesh.mColors[0] + count, colors.begin(),
                   [](const aiColor4D& c) { return vec4(linear(c.r), linear(c.g), linear(c.b), c.a); });
    attributes["COLOR_0"] = draft_.add_vectors(std::span<const vec4>(colors));
  }
  if (mesh.mNumBones > 0) write_influences(mesh, attributes);
  json = {{"attributes", std::move(attributes)},
          {"indices", draft_.add_accessor(std::span<const std::uint32_t>(indices), "SCALAR", Draft::kUnsignedInt)}};
  if (mesh.mNumAnimMeshes > 0) write_targets(mesh, json);
  if (const int material = material_of_mesh_[index]; material >= 0) json["material"] = material;
  return json;
}

/// Assimp's targets are places, glTF's the ways there.
void SceneWriter::write_targets(const aiMesh& mesh, Json& primitive) {
  for (unsigned t = 0; t < mesh.mNumAnimMeshes; ++t) {
    const aiAnimMesh& target = *mesh.mAnimMeshes[t];
    if (target.mNumVertices != mesh.mNumVertices) throw Error("a morph target has another number of vertices");
    Json attributes = Json::object();
    const auto add = [&](const char* name, const aiVector3D* to, const aiVector3D* from) {
      if (to == nullptr || from == nullptr) return;
      std::vector<vec3> ways(mesh.mNumVertices);
      std::transform(to, to + mesh.mNumVertices, from, ways.begin(),
                     [](const aiVector3D& a, const aiVector3D& b) { return vector_of(a) - vector_of(b); });
      attributes[name] = draft_.add_vectors(std::span<const vec3>(ways));
    };
    add("POSITION", target.mVertices, mesh.mVertices);
    add("NORMAL", target.mNormals, mesh.mNormals);
    primitive["targets"].push_back(std::move(attributes));
  }
}

void SceneWriter::write_cameras() {
  for (unsigned i = 0; i < scene_.mNumCameras; ++i) {
    const aiCamera& source = *scene_.mCameras[i];
    Json json{{"name", source.mName.C_Str()}};
    const float aspect = source.mAspect > 0.0f ? source.mAspect : 16.0f / 9.0f;
    if (source.mOrthographicWidth > 0.0f) {
      const float half_width = source.mOrthographicWidth;
      json["type"] = "orthographic";
      json["orthographic"] = {{"xmag", half_width}, {"ymag", half_width / aspect}, {"znear", 0.0f}, {"zfar", 1e6f}};
    } else {
      const float yfov = 2.0f * std::atan(std::tan(source.mHorizontalFOV * units_.angle_per_fov / 2.0f) / aspect);
      if (!(yfov > 0.0f && yfov < kPi)) {
        draft_.diagnostics.warn(fmt::format("camera '{}' has no angle of view and is left out", source.mName.C_Str()));
        continue;
      }
      json["type"] = "perspective";
      json["perspective"] = {{"yfov", yfov}, {"znear", 1e-3f}};
      if (source.mAspect > 0.0f) json["perspective"]["aspectRatio"] = aspect;
    }
    const mat4 placed = frame(vector_of(source.mPosition), vector_of(source.mLookAt), vector_of(source.mUp));
    const std::size_t camera = draft_.add("cameras", std::move(json));
    draft_.gltf["nodes"][holder_of(source.mName.C_Str(), placed, "camera")]["camera"] = camera;
  }
}

/// A node that holds a camera or a light: the one of that name where it may, else a child of it.
std::size_t SceneWriter::holder_of(const std::string& name, const mat4& node_from_held, const std::string& label) {
  const int named = find_node(name);
  const std::size_t parent = named >= 0 ? static_cast<std::size_t>(named) : 0;
  if (named >= 0 && node_from_held == mat4(1.0f)) return parent;
  Json json{{"name", name.empty() ? label : name}};
  if (node_from_held != mat4(1.0f)) json["matrix"] = list(node_from_held);
  const std::size_t child = draft_.add("nodes", std::move(json));
  add_child(parent, child);
  return child;
}

/// A lamp of these formats shows a white surface that faces it as its colour: an illuminance of π times that colour.
/// How it fades is the file's polynomial of distance.
void SceneWriter::write_lights() {
  constexpr const char* kExtension = "KHR_lights_punctual";
  for (unsigned i = 0; i < scene_.mNumLights; ++i) {
    const aiLight& source = *scene_.mLights[i];
    const vec3 color = glm::max(vec3(source.mColorDiffuse.r, source.mColorDiffuse.g, source.mColorDiffuse.b), vec3(0));
    const float most = max_component(color);
    const bool is_known = source.mType == aiLightSource_DIRECTIONAL || source.mType == aiLightSource_POINT ||
                          source.mType == aiLightSource_SPOT;
    if (!is_known || !(most > 0.0f) || !std::isfinite(most)) {
      draft_.diagnostics.warn(fmt::format("light '{}' is {} and is left out", source.mName.C_Str(),
                                          is_known                                ? "black"
                                          : source.mType == aiLightSource_AREA    ? "an area light"
                                          : source.mType == aiLightSource_AMBIENT ? "ambient light"
                                                                                  : "of no known kind"));
      continue;
    }
    const vec3 hue = color / most;
    Json json{{"name", source.mName.C_Str()},
              {"color", {hue.x, hue.y, hue.z}},
              {"intensity", kPi * most},
              {"type", source.mType == aiLightSource_POINT  ? "point"
                       : source.mType == aiLightSource_SPOT ? "spot"
                                                            : "directional"}};
    if (source.mType == aiLightSource_SPOT) {
      const float outer = std::clamp(source.mAngleOuterCone / 2.0f, 1e-3f, kPi / 2.0f);
      json["spot"] = {{"outerConeAngle", outer},
                      {"innerConeAngle", std::clamp(source.mAngleInnerCone / 2.0f, 0.0f, outer * 0.999f)}};
    }
    const float s = units_.metres_per_unit;
    const vec3 fading(source.mAttenuationQuadratic / (s * s), source.mAttenuationLinear / s,
                      source.mAttenuationConstant);
    if (source.mType != aiLightSource_DIRECTIONAL && fading != vec3(1, 0, 0) && max_component(fading) > 0.0f) {
      json["extras"]["candela"] = {
          {"falloff", "polynomial"},
          {"polynomial", {std::max(fading.x, 0.0f), std::max(fading.y, 0.0f), std::max(fading.z, 0.0f)}}};
    }
    Json& lights = draft_.gltf["extensions"][kExtension]["lights"];
    lights.push_back(std::move(json));
    draft_.use_extension(kExtension);
    const mat4 placed = source.mType == aiLightSource_POINT
                            ? frame(vector_of(source.mPosition), vec3(0, 0, -1), vec3(0, 1, 0))
                            : frame(vector_of(source.mPosition), vector_of(source.mDirection), vec3(0, 1, 0));
    draft_.gltf["nodes"][holder_of(source.mName.C_Str(), placed, "light")]["extensions"][kExtension] = {
        {"light", lights.size() - 1}};
  }
}

void SceneWriter::write(const std::string& root_name) {
  if (scene_.mRootNode == nullptr) throw Error("there is no scene in it");
  for (unsigned i = 0; i < scene_.mNumAnimations; ++i) {
    const aiAnimation& animation = *scene_.mAnimations[i];
    for (unsigned c = 0; c < animation.mNumChannels; ++c) animated_.insert(animation.mChannels[c]->mNodeName.C_Str());
  }
  std::size_t top = 0;
  if (units_.metres_from_root != mat4(1.0f)) {
    draft_.add("nodes", {{"name", root_name}, {"matrix", list(units_.metres_from_root)}});
    add_child(0, static_cast<std::size_t>(write_node(*scene_.mRootNode)));
  } else {
    top = static_cast<std::size_t>(write_node(*scene_.mRootNode));
    draft_.gltf["nodes"][top]["name"] = root_name;
  }
  write_skins();
  write_cameras();
  write_lights();
  write_animations();
  draft_.gltf["scenes"] = {{{"nodes", {top}}}};
  draft_.gltf["scene"] = 0;
  if (undrawn_ > 0) {
    draft_.diagnostics.note(fmt::format("{} points and lines are not drawn", undrawn_));
  }
}

}  // namespace candela::foreign
