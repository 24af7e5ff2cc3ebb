#pragma once

// The medium between surfaces, by default a vacuum. Media are a feature of the scene; Medium is specialised for the
// masks that contain it, with this interface:
//
//   explicit Medium(const SceneView&)
//   static bool is_in(const SceneView&)         whether the scene has any; code for media also serves other scenes
//   Vertex                                      a scattering in the medium, with the functions of SurfaceVertex
//                                               (path_listener.h) for a phase function in place of a BSDF
//   bool scatters(job, path, hit, vertex)       Traces the path's ray through the medium up to `hit`, which is none if
//                                               it hits no surface, and weights path.throughput. Returns whether it
//                                               scatters before that, and then sets `vertex`.
//   Rgb transmittance(interior, ray)            transmittance along a shadow ray of a vertex, from which the solids of
//                                               `interior` hold it; the ray ends at origin + t_max * direction
//
// Source: Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th ed., section 14.2 (volumetric path tracing).

#include "integrators/path/homogeneous_medium.h"

namespace pertev {

struct Vacuum {
    static constexpr bool kIsVacuum = true;
    struct Vertex {};
    HD explicit Vacuum(const SceneView&) {}
};

template <Features kFeatures>
struct Medium : std::conditional_t<(kFeatures & kMedia) != 0, HomogeneousMedium<kFeatures>, Vacuum> {
    using Base = std::conditional_t<(kFeatures & kMedia) != 0, HomogeneousMedium<kFeatures>, Vacuum>;
    using Base::Base;
};

} // namespace pertev
