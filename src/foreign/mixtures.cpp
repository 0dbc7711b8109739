#include "foreign/mixtures.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/parallel.h"
#include "image/image_file.h"

namespace candela::foreign {

using Json = nlohmann::json;

namespace {

/// A picture of 8 bits per channel, looked up by share of its width and height.
struct Picture {
  TextureImage image;

  float at(int x, int y, int channel) const {
    const auto wrap = [](int i, int n) { return static_cast<std::size_t>((i % n + n) % n); };
    const std::size_t texel = wrap(y, image.height) * static_cast<std::size_t>(image.width) + wrap(x, image.width);
    const std::size_t at = texel * 4 + static_cast<std::size_t>(channel);
    if (image.bits == 8) return static_cast<float>(image.pixels[at]) / 255.0f;
    std::uint16_t value = 0;
    std::copy_n(image.pixels.begin() + static_cast<std::ptrdiff_t>(at * 2), 2, reinterpret_cast<std::uint8_t*>(&value));
    return static_cast<float>(value) / 65535.0f;
  }
  /// The nearest texel of a picture of another size.
  float scaled(int x, int y, int width, int height, int channel) const {
    const auto to = [](int i, int n, int m) {
      return static_cast<int>((static_cast<std::int64_t>(i) * 2 + 1) * m / (2 * static_cast<std::int64_t>(n)));
    };
    return at(to(x, width, image.width), to(y, height, image.height), channel);
  }
  float grey(int x, int y) const { return (at(x, y, 0) + at(x, y, 1) + at(x, y, 2)) / 3.0f; }
};

std::uint8_t code(float v) { return static_cast<std::uint8_t>(std::lround(std::clamp(v, 0.0f, 1.0f) * 255.0f)); }

template <class F>
TextureImage make(int width, int height, F&& texel) {
  TextureImage image;
  image.width = width;
  image.height = height;
  image.has_alpha = true;
  image.pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4);
  parallel_for(0, static_cast<std::size_t>(height), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) {
      for (int x = 0; x < width; ++x) {
        const vec4 value = texel(x, static_cast<int>(y));
        for (int c = 0; c < 4; ++c) {
          image.pixels[(y * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) * 4 +
                       static_cast<std::size_t>(c)] = code(value[c]);
        }
      }
    }
  });
  return image;
}

ivec2 size_of(const std::optional<Picture>& a, const std::optional<Picture>& b) {
  return {std::max(a ? a->image.width : 1, b ? b->image.width : 1),
          std::max(a ? a->image.height : 1, b ? b->image.height : 1)};
}

/// Roughness and metalness of two grey pictures, as glTF packs them.
TextureImage pack(const std::optional<Picture>& roughness, const std::optional<Picture>& metallic) {
  const ivec2 size = size_of(roughness, metallic);
  const auto of = [&](const std::optional<Picture>& p, int x, int y) {
    return p ? p->scaled(x, y, size.x, size.y, 0) : 1.0f;
  };
  return make(size.x, size.y, [&](int x, int y) { return vec4(1, of(roughness, x, y), of(metallic, x, y), 1); });
}

/// Colour of one picture, coverage of another: its alpha where it has one, else its grey.
TextureImage cover(const std::optional<Picture>& color, const Picture& opacity) {
  const ivec2 size = size_of(color, opacity);
  const int channel = opacity.image.has_alpha ? 3 : 0;
  return make(size.x, size.y, [&](int x, int y) {
    vec4 value(1.0f);
    for (int c = 0; c < 3 && color; ++c) value[c] = color->scaled(x, y, size.x, size.y, c);
    value.w = opacity.scaled(x, y, size.x, size.y, channel);
    return value;
  });
}

/// Whether it holds normals: bluish on the whole, as no relief in grey is.
bool holds_normals(const Picture& picture) {
  double blue = 0.0, other = 0.0;
  const int step_x = std::max(picture.image.width / 64, 1), step_y = std::max(picture.image.height / 64, 1);
  for (int y = 0; y < picture.image.height; y += step_y) {
    for (int x = 0; x < picture.image.width; x += step_x) {
      blue += picture.at(x, y, 2);
      other += std::max(picture.at(x, y, 0), picture.at(x, y, 1));
    }
  }
  return blue > 1.15 * other;
}

/// Normals of a relief. None of these formats says how high a bump is: from black to white it is `strength` times a
/// hundredth of the picture's width.
TextureImage relief(const Picture& picture, float strength) {
  if (holds_normals(picture)) {
    return make(picture.image.width, picture.image.height,
                [&](int x, int y) { return vec4(picture.at(x, y, 0), picture.at(x, y, 1), picture.at(x, y, 2), 1); });
  }
  const float height = 0.01f * strength * static_cast<float>(picture.image.width);  // texels
  return make(picture.image.width, picture.image.height, [&](int x, int y) {
    const float du = (picture.grey(x + 1, y) - picture.grey(x - 1, y)) * 0.5f * height;
    const float dv = (picture.grey(x, y + 1) - picture.grey(x, y - 1)) * 0.5f * height;  // downwards
    const vec3 n = glm::normalize(vec3(-du, dv, 1.0f));
    return vec4(n * 0.5f + 0.5f, 1.0f);
  });
}

class Mixer {
 public:
  Mixer(Draft& draft, const Surroundings& around) : draft_(draft), around_(around) {}

  void mix(const Json& recipe);
  /// The picture that cannot be read stands in for the mixture: the reader of the glTF then says that it is lost.
  void lose(const Json& recipe);

 private:
  std::optional<Picture> picture(const Json& index) const;

  Draft& draft_;
  const Surroundings& around_;
};

std::optional<Picture> Mixer::picture(const Json& index) const {
  if (index.get<int>() < 0) return std::nullopt;
  const Json& source = draft_.sources[index.get<std::size_t>()];
  if (source.contains("bufferView")) {
    const Json& view = draft_.gltf["bufferViews"][source["bufferView"].get<std::size_t>()];
    const auto bytes = std::span<const std::byte>(draft_.buffer)
                           .subspan(view["byteOffset"].get<std::size_t>(), view["byteLength"].get<std::size_t>());
    return Picture{decode_texture(bytes, "a texture in the file")};
  }
  const std::string name = source["name"];
  return Picture{decode_texture(around_.read(name), name)};
}

void Mixer::mix(const Json& recipe) {
  const std::string kind = recipe["kind"];
  TextureImage mixed;
  if (kind == "pack") {
    mixed = pack(picture(recipe["roughness"]), picture(recipe["metallic"]));
  } else if (kind == "cover") {
    mixed = cover(picture(recipe["color"]), *picture(recipe["opacity"]));
  } else {
    mixed = relief(*picture(recipe["source"]), recipe["strength"].get<float>());
  }
  const std::size_t view = draft_.add_view(encode_png(mixed));
  draft_.gltf["images"][recipe["image"].get<std::size_t>()] = {{"bufferView", view}, {"mimeType", "image/png"}};
}

void Mixer::lose(const Json& recipe) {
  for (const char* key : {"source", "opacity", "color", "roughness", "metallic"}) {
    if (!recipe.contains(key) || recipe[key].get<int>() < 0) continue;
    try {
      picture(recipe[key]);
    } catch (const Error&) {
      draft_.gltf["images"][recipe["image"].get<std::size_t>()] = draft_.sources[recipe[key].get<std::size_t>()];
      return;
    }
  }
}

}  // namespace

void mix(Draft& draft, const Surroundings& around) {
  Mixer mixer(draft, around);
  for (const Json& recipe : draft.mixtures) {
    try {
      mixer.mix(recipe);
    } catch (const Error&) {
      mixer.lose(recipe);
    }
  }
}

}  // namespace candela::foreign
