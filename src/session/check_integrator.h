#pragma once

// What an integrator cannot do, told in one line before anything is rendered.

#include "base/messages.h"
#include "scene/scene.h"
#include "session/render_settings.h"

namespace pertev {

/// Whether the settings go together. Throws Error(BadInput), Error(OverLimit) for a tree of rays that is too deep.
void check_integrator(const RenderSettings& settings);

/// Throws Error(BadInput) where the integrator would show surfaces as black for want of lights that it knows; a note
/// tells what it leaves out.
void check_light(const RenderSettings& settings, const Scene& scene, Messages& messages);

} // namespace pertev
