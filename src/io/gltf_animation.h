#pragma once

#include <string>
#include <vector>

#include "io/gltf.h"
#include "io/gltf_accessor.h"
#include "io/gltf_nodes.h"

namespace candela::io {

/// What the file's animations are called and how long they last, from the bounds that it states of their times.
std::vector<AnimationInfo> read_animation_list(const JsonView& root);

/// The animations that `name` means: one by name or index, the first for an empty name, every one for "all". Throws
/// Error that lists those there are; empty where the file has none and no name is given.
std::vector<std::size_t> find_animations(const JsonView& root, const std::string& name);

/// Warns of animations that move one property of a node by two channels: the last counts.
void check_channels(const JsonView& root, Warnings& warnings);

/// Moves nodes to where an animation has them `time` seconds after its start (before the first and after the last key:
/// there), and sets the weights of their morph targets. glTF 2.0 §3.11, interpolation as in its appendix C.
void pose_nodes(const JsonView& animation, double time, AccessorReader& reader, Warnings& warnings,
                std::vector<FileNode>& nodes);

}  // namespace candela::io
