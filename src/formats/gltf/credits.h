#pragma once

// Author and licence of a file and of those that it shows, as suggested settings that pictures record: from
// KHR_xmp_json_ld (dc:creator, dc:rights), else from asset.extras, where Sketchfab writes them.

#include "base/sink.h"
#include "formats/gltf/document.h"
#include "scene/scene.h"

namespace pertev::gltf {

/// Adds `author` and `license` to scene.suggested, as far as the file has them. An unreadable one is left out with a
/// warning.
void read_credits(const Document& document, Scene& scene, Sink& sink);

/// Adds the credits of a file that this one shows, after its own.
void add_credits(const Scene& part, Scene& scene);

} // namespace pertev::gltf
