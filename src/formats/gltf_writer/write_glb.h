#pragma once

// Writes a scene as a glTF 2.0 binary file, at rest: meshes that instances share, materials, textures, cameras, point,
// spot and directional lights. Reading it gives the same picture, to the bit, unless something was lost; each loss is a
// warning of the sink (leave_out). Nodes are flat: one for each instance, camera and light.

#include <cstddef>
#include <filesystem>
#include <vector>

#include "base/sink.h"
#include "scene/scene.h"

namespace pertev {

/// Returns the file of a scene that has passed validate(). Throws Error(OverLimit) if it exceeds the format's 4 GiB.
std::vector<std::byte> encode_glb(const Scene& scene, Sink& sink);

/// Replaces `path` atomically. Throws as encode_glb, and Error(FileWrite).
void write_glb(const std::filesystem::path& path, const Scene& scene, Sink& sink);

} // namespace pertev
