#include "base/error.h"
#include "image/astc.h"

// The door of Arm's decoder in a build without it: nobody passes.
namespace candela::codec {

struct AstcDecoder::Context {};

AstcDecoder::AstcDecoder(int, int, AstcProfile, const std::string& where) {
  throw Error("ASTC blocks are not decoded in a browser; ETC1S and UASTC are", where);
}
AstcDecoder::~AstcDecoder() = default;
void AstcDecoder::decode(std::span<const std::byte>, int, int, std::span<std::uint8_t>) {}
void AstcDecoder::decode(std::span<const std::byte>, int, int, std::span<float>) {}

}  // namespace candela::codec
