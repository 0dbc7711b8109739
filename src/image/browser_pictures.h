#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "image/image.h"

/// Pictures that a browser has decoded, with its own decoders and on its own threads. It does so only while no code
/// runs, so that the page hands them over before a file is read, and whoever decodes the same bytes gets them.
namespace candela {

/// `bytes` are the picture's file. Replaces what was given of the same file.
void give_browser_picture(std::span<const std::byte> bytes, TextureImage picture);
/// Null where the page gave none.
const TextureImage* find_browser_picture(std::span<const std::byte> bytes);
/// Gives back the memory of those that we could decode ourselves.
void forget_other_browser_pictures();
/// Of all.
void forget_browser_pictures();

}  // namespace candela
