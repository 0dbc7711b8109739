#include "image/astc.h"

#include <astcenc.h>

#include <atomic>
#include <type_traits>

#include "base/check.h"
#include "base/error.h"
#include "base/parallel.h"

namespace candela::codec {

struct AstcDecoder::Context {
  astcenc_context* handle = nullptr;
  unsigned threads = 1;
  std::string where;

  ~Context() {
    if (handle != nullptr) astcenc_context_free(handle);
  }
  void check(astcenc_error error) const {
    if (error != ASTCENC_SUCCESS)
      throw Error(std::string("ASTC blocks cannot be decoded: ") + astcenc_get_error_string(error), where);
  }
  void decode(std::span<const std::byte> blocks, int width, int height, astcenc_type type, void* texels);
};

namespace {

astcenc_profile profile_of(AstcProfile profile) {
  return profile == AstcProfile::hdr ? ASTCENC_PRF_HDR
                                     : (profile == AstcProfile::srgb ? ASTCENC_PRF_LDR_SRGB : ASTCENC_PRF_LDR);
}

/// Releases of the library's fifth line take the context whose tables are shared as one argument more.
template <class Allocate>
astcenc_error allocate(Allocate* function, const astcenc_config& config, unsigned threads, astcenc_context** context) {
  if constexpr (std::is_invocable_v<Allocate*, const astcenc_config*, unsigned, astcenc_context**>)
    return function(&config, threads, context);
  else
    return function(&config, threads, context, nullptr);
}

}  // namespace

AstcDecoder::AstcDecoder(int block_width, int block_height, AstcProfile profile, const std::string& where)
    : context_(std::make_unique<Context>()) {
  context_->where = where;
  context_->threads = static_cast<unsigned>(thread_count());
  astcenc_config config{};
  context_->check(astcenc_config_init(profile_of(profile), static_cast<unsigned>(block_width),
                                      static_cast<unsigned>(block_height), 1, ASTCENC_PRE_FASTEST,
                                      ASTCENC_FLG_DECOMPRESS_ONLY, &config));
  context_->check(allocate(&astcenc_context_alloc, config, context_->threads, &context_->handle));
}

AstcDecoder::~AstcDecoder() = default;

/// The threads share the work among themselves; it is done when all of them are.
void AstcDecoder::Context::decode(std::span<const std::byte> blocks, int width, int height, astcenc_type type,
                                  void* texels) {
  astcenc_image image{};
  image.dim_x = static_cast<unsigned>(width);
  image.dim_y = static_cast<unsigned>(height);
  image.dim_z = 1;
  image.data_type = type;
  image.data = &texels;
  const astcenc_swizzle swizzle{ASTCENC_SWZ_R, ASTCENC_SWZ_G, ASTCENC_SWZ_B, ASTCENC_SWZ_A};
  std::atomic<int> first_error = ASTCENC_SUCCESS;
  parallel_for(0, threads, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const astcenc_error error = astcenc_decompress_image(handle, reinterpret_cast<const std::uint8_t*>(blocks.data()),
                                                           blocks.size(), &image, &swizzle, static_cast<unsigned>(i));
      if (error != ASTCENC_SUCCESS) first_error = error;
    }
  });
  check(astcenc_decompress_reset(handle));
  check(static_cast<astcenc_error>(first_error.load()));
}

void AstcDecoder::decode(std::span<const std::byte> blocks, int width, int height, std::span<std::uint8_t> rgba) {
  CANDELA_CHECK(rgba.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4);
  context_->decode(blocks, width, height, ASTCENC_TYPE_U8, rgba.data());
}

void AstcDecoder::decode(std::span<const std::byte> blocks, int width, int height, std::span<float> rgba) {
  CANDELA_CHECK(rgba.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4);
  context_->decode(blocks, width, height, ASTCENC_TYPE_F32, rgba.data());
}

}  // namespace candela::codec
