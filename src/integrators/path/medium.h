#pragma once

// The medium between surfaces, by default a vacuum. A medium is a feature of the scene; Medium is specialised for the
// masks that contain it, with this interface:
//
//   explicit Medium(const SceneView&)
//   Vertex                                      a scattering in the medium, with the functions of SurfaceVertex
//                                               (path_listener.h) for a phase function in place of a BSDF
//   bool scatters(settings, path, distance, vertex)
//                                               Traces the path's ray through the medium for at most `distance` metres
//                                               (kInfinity: it hits no surface) and weights path.throughput. Returns
//                                               whether it scatters before that, and then sets `vertex`.
//   Rgb transmittance(settings, path, ray)      transmittance along a shadow ray of the path's vertex; the ray ends at
//                                               origin + t_max * direction
//
// Source: Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th ed., section 14.2 (volumetric path tracing).

#include "integrators/path/path_job.h"

namespace pertev {

struct Vacuum {
    static constexpr bool kIsVacuum = true;
    HD explicit Vacuum(const SceneView&) {}
};

template <Features kFeatures>
struct Medium : Vacuum {
    using Vacuum::Vacuum;
};

} // namespace pertev
