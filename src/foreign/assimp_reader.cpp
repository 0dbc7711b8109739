#include "foreign/assimp_reader.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <charconv>
#include <optional>
#include <string_view>

#include "base/error.h"
#include "foreign/assimp_files.h"
#include "foreign/assimp_look.h"
#include "foreign/assimp_scene.h"
#include "foreign/collada.h"
#include "foreign/guard.h"
#include "foreign/material_writer.h"
#include "foreign/mtl.h"
#include "foreign/old_pictures.h"
#include "foreign/units.h"
#include "image/image_file.h"

namespace candela::foreign {

using Json = nlohmann::json;

namespace {

std::string_view extension_of(Format format) {
  switch (format) {
    case Format::obj:
      return ".obj";
    case Format::fbx:
      return ".fbx";
    case Format::stl:
      return ".stl";
    case Format::ply:
      return ".ply";
    case Format::collada:
      return ".dae";
    case Format::max_3ds:
      return ".3ds";
    case Format::three_mf:
      return ".3mf";
    default:
      throw Error("no format that Assimp reads");
  }
}

/// One line of what Assimp says.
std::string one_line(std::string text) {
  constexpr std::size_t kMost = 200;
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  return text.size() > kMost ? text.substr(0, kMost) + "…" : text;
}

std::string mime_type(std::span<const std::byte> bytes) {
  const std::string_view head(reinterpret_cast<const char*>(bytes.data()), std::min<std::size_t>(bytes.size(), 12));
  if (head.starts_with("\xFF\xD8")) return "image/jpeg";
  if (head.starts_with("RIFF")) return "image/webp";
  if (head.starts_with("\xABKTX")) return "image/ktx2";
  return "image/png";
}

/// The number of a texture that stands in the file itself; empty of other names.
std::optional<unsigned> embedded_index(const aiScene& scene, std::string_view name) {
  unsigned index = 0;
  if (!name.starts_with('*')) return std::nullopt;
  const auto [end, error] = std::from_chars(name.data() + 1, name.data() + name.size(), index);
  if (error != std::errc() || end != name.data() + name.size() || index >= scene.mNumTextures) return std::nullopt;
  return index;
}

/// A picture that no glTF holds, as one that it may.
Json as_png(const TextureImage& image, Draft& draft) {
  return {{"bufferView", draft.add_view(encode_png(image))}, {"mimeType", "image/png"}};
}

/// A texture that stands in the file: the bytes of a picture, or plain texels.
Json embedded_picture(const aiTexture& texture, Draft& draft) {
  if (texture.mHeight == 0) {
    const auto bytes = std::as_bytes(std::span(reinterpret_cast<const char*>(texture.pcData), texture.mWidth));
    if (const auto old = decode_old_picture(bytes, "a texture in the file")) return as_png(*old, draft);
    return {{"bufferView", draft.add_view(bytes)}, {"mimeType", mime_type(bytes)}};
  }
  TextureImage image{static_cast<int>(texture.mWidth), static_cast<int>(texture.mHeight), 8, true, {}};
  const std::size_t count = std::size_t{texture.mWidth} * texture.mHeight;
  image.pixels.reserve(count * 4);
  for (const aiTexel& texel : std::span(texture.pcData, count)) {
    image.pixels.insert(image.pixels.end(), {texel.r, texel.g, texel.b, texel.a});
  }
  return as_png(image, draft);
}

/// Makes the materials, and knows which one a mesh has.
class Materials {
 public:
  Materials(const aiScene& scene, Draft& draft, const Surroundings& around, Format format)
      : scene_(scene), draft_(draft), around_(around), format_(format), writer_(draft, [this](const std::string& file) {
          return pictures_.at(file);
        }) {}

  std::vector<int> of_meshes(const std::vector<Look>& library);

 private:
  int add(const aiMesh& mesh, const std::vector<Look>& library);
  Json picture(const std::string& file);
  /// Reads or finds the pictures of its maps; a map whose picture is broken is left out, with a warning.
  void find_pictures(Look& look);

  const aiScene& scene_;
  Draft& draft_;
  const Surroundings& around_;
  Format format_;
  MaterialWriter writer_;
  std::map<std::string, Json> pictures_;            ///< by what maps name; null = broken
  std::map<std::pair<unsigned, bool>, int> known_;  ///< by number, and whether it stands for no material on colours
};

Json Materials::picture(const std::string& file) {
  if (const auto index = embedded_index(scene_, file)) return embedded_picture(*scene_.mTextures[*index], draft_);
  const std::string name = find_reference(around_, file);
  if (around_.has(name)) {
    const std::vector<std::byte> bytes = around_.read(name);
    if (const auto old = decode_old_picture(bytes, name)) {
      draft_.read.push_back(name);
      Json image = as_png(*old, draft_);
      image["name"] = name;
      return image;
    }
  }
  return {{"uri", uri_of(name)}, {"name", name}};
}

void Materials::find_pictures(Look& look) {
  for (Map* map : look.maps()) {
    if (!*map) continue;
    const auto [found, is_new] = pictures_.try_emplace(map->file);
    if (is_new) {
      try {
        found->second = picture(map->file);
      } catch (const Error& error) {
        draft_.diagnostics.warn(error.message() + "; shown without it", error.where());
      }
    }
    if (found->second.is_null()) *map = {};
  }
}

int Materials::add(const aiMesh& mesh, const std::vector<Look>& library) {
  const bool has_colors = mesh.mColors[0] != nullptr;
  const aiMaterial& material = *scene_.mMaterials[mesh.mMaterialIndex];
  const std::string name = material.GetName().C_Str();
  const auto defined =
      std::find_if(library.begin(), library.end(), [&](const Look& look) { return look.name == name; });
  const bool is_plain =
      defined == library.end() &&
      (name.empty() || name == AI_DEFAULT_MATERIAL_NAME || name == "%%%DEFAULT" || format_ == Format::obj ||
       format_ == Format::stl || (format_ == Format::ply && material.GetTextureCount(aiTextureType_DIFFUSE) == 0));
  const auto [found, is_new] = known_.try_emplace({mesh.mMaterialIndex, is_plain && has_colors}, -1);
  if (!is_new) return found->second;
  Look look = is_plain                   ? plain_look(has_colors)
              : defined != library.end() ? *defined
                                         : look_of(scene_, material, format_);
  if (look.name.empty() && name != AI_DEFAULT_MATERIAL_NAME) look.name = name;
  find_pictures(look);
  found->second = static_cast<int>(writer_.add(look));
  return found->second;
}

std::vector<int> Materials::of_meshes(const std::vector<Look>& library) {
  std::vector<int> result;
  for (unsigned i = 0; i < scene_.mNumMeshes; ++i) {
    const aiMesh& mesh = *scene_.mMeshes[i];
    result.push_back(mesh.mMaterialIndex < scene_.mNumMaterials ? add(mesh, library) : -1);
  }
  return result;
}

/// The materials of an OBJ, of all libraries that it names.
std::vector<Look> read_libraries(std::string_view obj, const Surroundings& around, Draft& draft) {
  std::vector<Look> looks;
  for (const std::string& name : material_libraries(obj)) {
    const std::string found = find_reference(around, name);
    try {
      const std::vector<std::byte> bytes = around.read(found);
      draft.read.push_back(found);
      std::vector<Look> own = read_mtl({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
      // Maps are named from where the library lies.
      const std::string folder = found.substr(0, found.find_last_of('/') + 1);
      if (!folder.empty()) {
        for (Look& look : own) {
          for (Map* map : look.maps()) {
            if (*map && around.has(find_reference(around, folder + map->file))) map->file = folder + map->file;
          }
        }
      }
      looks.insert(looks.end(), std::make_move_iterator(own.begin()), std::make_move_iterator(own.end()));
    } catch (const Error& error) {
      draft.diagnostics.warn("the materials of " + name + " are missing: " + error.message());
    }
  }
  return looks;
}

/// What is taken for granted where neither the format nor the user says it.
void note_assumptions(Format format, const Measures& measures, Draft& draft) {
  if (!is_silent(format) || (measures.metres_per_unit && measures.is_z_up)) return;
  const char* lacks = measures.is_z_up           ? "no unit: metres are taken"
                      : measures.metres_per_unit ? "no upward axis: +y is taken"
                                                 : "neither unit nor upward axis: metres and +y are taken";
  draft.diagnostics.note(fmt::format("{} says {}", format_name(format), lacks));
}

}  // namespace

Draft read_with_assimp(std::span<const std::byte> bytes, Format format, const Measures& measures,
                       const Surroundings& around, const std::string& stem) {
  Draft draft;
  draft.gltf["asset"]["generator"] = fmt::format("read from {}", format_name(format));
  const std::string main_name = "candela-scene" + std::string(extension_of(format));
  std::vector<std::byte> named;
  if (format == Format::collada) named = with_names(bytes);
  Assimp::Importer importer;
  auto* const files =
      new AssimpFiles(main_name, named.empty() ? bytes : named, around);  // the importer owns it from here on
  importer.SetIOHandler(files);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
  const aiScene* scene = importer.ReadFile(main_name, aiProcess_Triangulate | aiProcess_JoinIdenticalVertices);
  if (scene == nullptr) throw Error(one_line(importer.GetErrorString()));
  const Units units = units_of(*scene, format, bytes, measures);
  std::vector<Look> library;
  if (format == Format::obj) {
    library = read_libraries({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, around, draft);
  }
  Materials materials(*scene, draft, around, format);
  SceneWriter writer(*scene, draft, materials.of_meshes(library), units, has_trusted_normals(bytes, format));
  writer.write(stem);
  note_assumptions(format, measures, draft);
  draft.read.insert(draft.read.end(), files->opened().begin(), files->opened().end());
  return draft;
}

}  // namespace candela::foreign
