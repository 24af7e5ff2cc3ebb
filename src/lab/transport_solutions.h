#pragma once

// Radiosity in the laboratory of light transport: solutions of growing detail, and a picture of each.

#include <cstddef>
#include <cstdint>

#include "device/queue.h"
#include "image/image.h"
#include "lab/transport_report.h"
#include "radiosity/solve_radiosity.h"
#include "settings/render_settings.h"

namespace pertev {

/// Of each pixel, of a picture of a solution: for its edges, as the solution has no noise that samples would lessen.
inline constexpr uint32_t kSolutionSamples = 16;

/// Solution `number`: patches of a 4th, 8th, 16th, ... of the scene's longest side, which are divided once where light
/// changes.
RadiositySettings solution_settings(const PreparedScene& prepared, uint32_t number, uint32_t seed);

/// Whether there may be a solution of that number: it takes no more patches, and no more of this machine's memory, than
/// the laboratory gives to one.
bool may_be_solved(const PreparedScene& prepared, uint32_t number);

struct SolvedPicture {
    TransportFigures figures; // without errors
    Image picture;
    std::size_t device_bytes = 0, host_bytes = 0; // the most that rendering and that solving took
    uint64_t invalid_samples = 0;
};

/// Solves, and renders `samples` samples of each pixel. Timed are both, but for one sample that comes first, as of all
/// integrators. `progress` may throw. Throws as solve_radiosity and Session.
SolvedPicture solve_picture(Queue& queue, const PreparedScene& prepared, const Camera& camera, RenderSettings settings,
                            uint32_t number, uint32_t samples, const SolveProgress& progress);

} // namespace pertev
