#pragma once

// The gate between readers and the renderer: after it, every index is in range, every number finite and within
// base/limits.h, every transform invertible, nodes without circles, key times rising. Readers may leave any of that
// wrong.

#include <string>

#include "base/messages.h"
#include "scene/scene.h"

namespace pertev {

/// Repairs what can be repaired (triangles with vertices that are not finite or without area are dropped, each kind
/// with one warning that counts them; so are instances that a scale of 0 hides at all times) and throws Error(BadInput
/// or OverLimit) for the rest. `file` names the source in messages. A scene without any triangle left is an error.
/// Meshes with a normal map and without tangents get them (scene/tangents/make_tangents.h).
void validate(Scene& scene, const std::string& file, Messages& messages);

} // namespace pertev
