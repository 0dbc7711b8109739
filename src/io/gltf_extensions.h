#pragma once

#include <string_view>

#include "io/gltf.h"
#include "io/gltf_document.h"
#include "io/gltf_warnings.h"

namespace candela::io {

/// Whether what an extension says is read.
bool is_supported_extension(std::string_view name);
/// Whether no pixel of a picture depends on one that is not read.
bool is_unseen_extension(std::string_view name);

/// Sorts the extensions that a file uses and requires into what is ignored, what no picture shows and what is missing.
/// One whose data describe the asset as a whole changes no pixel whatever it is.
void sort_extensions(const GltfDocument& document, FileInfo& info);

/// Tells of them: a warning for what is ignored, a note for what no picture shows; an Error for what is missing, or
/// with `refuse_unknown` false a warning.
void check_extensions(const JsonView& root, const FileInfo& info, bool refuse_unknown, Warnings& warnings);

}  // namespace candela::io
