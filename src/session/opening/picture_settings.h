#pragma once

// Converts options from text to the settings of a render.

#include "scene/scene.h"
#include "settings/picture_options.h"

namespace pertev {

/// Returns all settings but the size, before a scene is read. Throws Error if they do not go together.
RenderSettings light_settings(const PictureOptions& options);
/// Sets the picture's size: the requested one, else that of the intrinsics, else that of the scene's camera.
void set_size(const PictureOptions& options, const Scene& scene, RenderSettings& settings);
/// Returns the settings for a scene. Throws Error.
RenderSettings render_settings(const PictureOptions& options, const Scene& scene);

} // namespace pertev
