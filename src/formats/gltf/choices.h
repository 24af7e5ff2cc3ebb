#pragma once

// What a glTF file has several of, and the reader takes one of: animations, and scenes.

#include "formats/files/read_options.h"
#include "formats/gltf/buffers.h"

namespace pertev::gltf {

/// Fills scene.clips, but for when they end, scene.file_scenes and scene.file_scene, by the options' words or, without
/// any, by the file: its first animation plays, and its `scene` or else its first scene is shown. Throws
/// Error(BadInput) with the list of what there is.
void choose(const Document& document, Buffers& buffers, const ReadOptions& options, Scene& scene, Messages& messages);

} // namespace pertev::gltf
