#pragma once

// The validation between readers and the renderer: after it, every index is in range, every number finite and within
// base/limits.h, every transform invertible, nodes are without cycles, key times ascend. Readers need not check any
// of that.

#include <string>

#include "base/sink.h"
#include "scene/scene.h"

namespace pertev {

/// Repairs what can be repaired: triangles with vertices that are not finite, or without area, are removed, with one
/// warning per kind that counts them, and so are instances that a scale of 0 always hides. Throws Error(BadInput or
/// OverLimit) for everything else. `file` names the source in messages. A scene without any triangle left is an
/// error. Meshes with a normal map and without tangents get them (scene/tangents/make_tangents.h).
void validate(Scene& scene, const std::string& file, Sink& sink);

} // namespace pertev
