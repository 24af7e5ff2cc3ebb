#pragma once

// Reads glTF 2.0, .gltf and .glb, by the files in formats/gltf, one for each part of the format.
//
// Supported extensions: KHR_texture_transform, KHR_lights_punctual, KHR_materials_unlit, _ior and _emissive_strength,
// KHR_mesh_quantization, EXT_ and KHR_meshopt_compression, EXT_mesh_gpu_instancing; in part (formats/gltf/materials.h)
// KHR_materials_specular, _transmission, _volume, _anisotropy, _iridescence and _diffuse_transmission. Others are an
// error if the file requires them and give a warning if it only uses them.

#include <cstddef>
#include <filesystem>
#include <vector>

#include "base/sink.h"
#include "formats/files/file_access.h"
#include "formats/files/read_options.h"
#include "scene/scene.h"

namespace pertev {

/// Reads the chosen scene without validating it. Throws Error(BadInput) that names the file and the JSON pointer. If
/// the file has no tangents, Mesh::tangents is empty; validate() makes those that are needed.
Scene read_gltf(const std::filesystem::path& path, const FileAccess& access, const ReadOptions& options, Sink& sink);
/// Reads a file from memory; `path` names it, and references are relative to it.
Scene read_gltf(const std::filesystem::path& path, std::vector<std::byte> bytes, const FileAccess& access,
                const ReadOptions& options, Sink& sink);

} // namespace pertev
