#pragma once

// EXT_lights_image_based: the environment of a scene, as a panorama of the first level of its specular cubemap. The
// coarser levels and the irradiance are what a path tracer computes from it.

#include "base/sink.h"
#include "formats/files/file_access.h"
#include "formats/gltf/buffers.h"
#include "formats/gltf/document.h"
#include "scene/scene.h"

namespace pertev::gltf {

/// Sets scene.environment if the file's scene `scene.file_scene` has an image-based light. A light that cannot be read
/// is left out.
void read_image_based_light(const Document& document, Buffers& buffers, const FileAccess& access, Scene& scene,
                            Sink& sink);

} // namespace pertev::gltf
