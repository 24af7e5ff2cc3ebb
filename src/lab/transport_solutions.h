#pragma once

// Radiosity in the light transport laboratory: solutions of growing detail, and a picture of each.

#include <cstddef>
#include <cstdint>

#include "device/queue.h"
#include "image/image.h"
#include "lab/transport_report.h"
#include "radiosity/solve_radiosity.h"
#include "settings/render_settings.h"

namespace pertev {

/// Samples per pixel in a solution's picture. They smooth its edges; the solution has no noise for samples to reduce.
inline constexpr uint32_t kSolutionSamples = 16;

/// Returns the settings of solution `number`: patches of a 4th, 8th, 16th, ... of the scene's longest side, subdivided
/// once where light changes.
RadiositySettings solution_settings(const PreparedScene& prepared, uint32_t number, uint32_t seed);

/// Returns whether solution `number` is possible: its patches and its memory stay within the laboratory's limits for
/// one solution.
bool may_be_solved(const PreparedScene& prepared, uint32_t number);

struct SolvedPicture {
    TransportFigures figures; // without errors
    Image picture;
    std::size_t device_bytes = 0, host_bytes = 0; // peak memory of rendering and of solving
    uint64_t invalid_samples = 0;
};

/// Solves a scene's light and renders `samples` samples per pixel of the solution. Both are timed, except for one
/// warm-up sample, which all integrators render first. `sink` may throw. Throws what solve_radiosity and Session throw.
SolvedPicture solve_picture(Queue& queue, const PreparedScene& prepared, const Camera& camera, RenderSettings settings,
                            uint32_t number, uint32_t samples, Sink& sink);

} // namespace pertev
