#pragma once

// Chooses among a glTF file's animations and scenes.

#include "formats/files/read_options.h"
#include "formats/gltf/buffers.h"

namespace pertev::gltf {

/// Fills scene.clips, except for their ends, scene.file_scenes and scene.file_scene, by the options or, without any,
/// by the file: its first animation plays, and its `scene` or else its first scene is shown. Throws Error(BadInput)
/// with a list of those that exist.
void choose(const Document& document, Buffers& buffers, const ReadOptions& options, Scene& scene, Messages& messages);

} // namespace pertev::gltf
