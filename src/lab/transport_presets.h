#pragma once

// Scenes that show what each integrator is good at: built in, with a camera.

#include <span>
#include <string_view>

#include "session/opening/choose_camera.h"

namespace pertev {

struct TransportPreset {
    const char* name;
    const char* scene; // a built-in scene
    const char* shows;
    const char* reference_integrator; // which of path and bidirectional has the less noise at equal time
    bool has_camera;                  // else the scene's own is taken
    Vec3 eye, target;                 // metres
    float fov_deg;                    // full vertical angle of view
};

/// cornell, caustic, blind, door, cove, many-lights.
std::span<const TransportPreset> transport_presets();
/// Null where there is none of this name.
const TransportPreset* find_transport_preset(std::string_view name);

CameraChoice camera_choice(const TransportPreset& preset);

} // namespace pertev
