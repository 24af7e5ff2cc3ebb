#pragma once

// Host versions of shade_vertex for the CPU's loop, compiled per set of features and using random numbers that are
// already drawn.

#include "integrators/path/drawn_numbers.h"
#include "integrators/path/frame_listeners.h"
#include "integrators/path/layer_listeners.h"
#include "integrators/path/path_vertex.h"

namespace pertev {

/// Storage for a vertex's shadow ray, if it has one, and for the listener's data of it.
template <class Listener>
struct VertexShadow {
    ShadowRay& ray;
    typename Listener::ShadowData& data;
};

/// Shades a vertex of a path and updates the listener's data of it. Sets whether the path continues and returns
/// whether it needs a shadow ray.
template <class Listener>
using ShadeOnHost = bool (*)(const PathJob&, PathState&, typename Listener::PathData&, const Hit&, const DrawnNumbers&,
                             VertexShadow<Listener>, bool& goes_on);

/// Returns the version with the least code that the job needs.
template <class Listener>
ShadeOnHost<Listener> shading_for(const PathJob& job);
template <>
ShadeOnHost<FilmListeners> shading_for<FilmListeners>(const PathJob& job);
template <>
ShadeOnHost<ReuseListeners> shading_for<ReuseListeners>(const PathJob& job);
template <>
ShadeOnHost<LayerListeners> shading_for<LayerListeners>(const PathJob& job);

} // namespace pertev
