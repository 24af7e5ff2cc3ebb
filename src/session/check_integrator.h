#pragma once

// Checks for things that an integrator cannot do, each reported in one line before rendering starts.

#include <optional>

#include "base/sink.h"
#include "scene/scene.h"
#include "settings/render_settings.h"

namespace pertev {

/// Checks that the settings are compatible, by the rules of the table of settings, which a caller of the library has
/// not asked. Throws Error(BadInput), Error(OverLimit) for a ray tree that is too deep.
void check_integrator(const RenderSettings& settings);

/// Checks that motion can be blurred if the shutter is open. Throws Error(BadInput).
void check_shutter(const RenderSettings& settings);

/// Checks that the integrator supports this camera. Throws Error(BadInput).
void check_camera(const RenderSettings& settings, const Camera& camera);
/// Throws Error(BadInput) if frames cannot be reconstructed because the lens is not straight.
void check_reconstruction(const Camera& camera);
/// Throws Error(BadInput) if a picture of this size cannot hold the faces of the camera's panorama.
void check_panorama(const RenderSettings& settings, const Camera& camera);

/// Throws Error(BadInput) if irradiance is requested of a scene with media.
void check_media(const RenderSettings& settings);

/// Returns why nothing would be lit, because the integrator supports none of the lights (though mirrors may show
/// emitters), or because no photon leaves a light. Nothing if something may be lit.
std::optional<Remark> why_dark(const RenderSettings& settings, const Scene& scene);

/// Throws Error(BadInput) with the reason of why_dark. A note says what whitted leaves out, and a warning says if
/// nothing in the scene, not even its environment, emits light. Media that the integrator does not support are left out.
void check_light(const RenderSettings& settings, const Scene& scene, Sink& sink);

} // namespace pertev
