#pragma once

// shade_vertex as the CPU's loop calls it: compiled for what a picture's materials are known to be, by numbers that
// have been drawn.

#include "integrators/path/drawn_numbers.h"
#include "integrators/path/frame_listeners.h"
#include "integrators/path/layer_listeners.h"
#include "integrators/path/path_vertex.h"

namespace pertev {

/// What a vertex gives beside its path.
template <class Listener>
struct AskedByVertex {
    ShadowRay ray; // where one is wanted
    [[no_unique_address]] typename Listener::Asked asked;
};

/// Takes a path over a vertex, with what the listener keeps of it. Sets whether the path goes on and returns whether it
/// asks for a shadow ray.
template <class Listener>
using ShadeOnHost = bool (*)(const PathJob&, PathState&, typename Listener::Kept&, const Hit&, const DrawnNumbers&,
                             AskedByVertex<Listener>&, bool& goes_on);

/// Returns the one with no more code than the job needs.
template <class Listener>
ShadeOnHost<Listener> shading_for(const PathJob& job);
template <>
ShadeOnHost<FilmListeners> shading_for<FilmListeners>(const PathJob& job);
template <>
ShadeOnHost<ReuseListeners> shading_for<ReuseListeners>(const PathJob& job);
template <>
ShadeOnHost<LayerListeners> shading_for<LayerListeners>(const PathJob& job);

} // namespace pertev
