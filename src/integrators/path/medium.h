#pragma once

// A vacuum fills the space between surfaces. A medium is a feature of the scene, and for the masks that hold it Medium
// is specialised, with this interface:
//
//   explicit Medium(const SceneView&)
//   Vertex                                      where a path's ray has met the medium. It has the functions of
//                                               SurfaceVertex (path_listener.h), of a phase function in place of a BSDF
//   bool meets(settings, path, distance, vertex)
//                                               Takes the path's ray through the medium, at most `distance` metres far
//                                               (kInfinity: it meets no surface), and weighs path.throughput. Returns
//                                               whether it met the medium before; it sets `vertex` then.
//   Rgb transmittance(settings, path, ray)      what a shadow ray of the path's vertex keeps of its light; the ray ends
//                                               at origin + t_max * direction
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
