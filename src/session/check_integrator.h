#pragma once

// What an integrator cannot do, told in one line before anything is rendered.

#include <optional>

#include "base/messages.h"
#include "scene/scene.h"
#include "settings/render_settings.h"

namespace pertev {

/// Whether the settings go together. Throws Error(BadInput), Error(OverLimit) for a tree of rays that is too deep.
void check_integrator(const RenderSettings& settings);

/// Whether what moves while a shutter is open can be blurred. Throws Error(BadInput).
void check_shutter(const RenderSettings& settings);

/// Whether the integrator can see by this camera. Throws Error(BadInput).
void check_camera(const RenderSettings& settings, const Camera& camera);

/// Why nothing would be lit, for want of lights that the integrator knows, though mirrors may show lamps; or why no
/// photon leaves a light. None where something may be lit.
std::optional<Remark> why_dark(const RenderSettings& settings, const Scene& scene);

/// Throws Error(BadInput) that says why_dark; a note tells what whitted leaves out, a warning that nothing in the scene
/// gives light, its environment neither.
void check_light(const RenderSettings& settings, const Scene& scene, Messages& messages);

} // namespace pertev
