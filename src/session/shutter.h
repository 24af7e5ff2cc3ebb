#pragma once

// The time that a shutter is open, during which motion is blurred: each sample sees the scene at its own time, drawn
// uniformly. Instances and the camera move rigidly (math/motion_keys.h); everything else keeps its state at the
// picture's time: scales, skins, morph targets, lights that are not meshes, angles of view.
//
// Source: Cook, Porter, Carpenter, "Distributed Ray Tracing", SIGGRAPH 1984.

namespace pertev {

/// Seconds at which the shutter opens and closes, relative to the picture's time. open_s <= close_s.
struct Shutter {
    double open_s = 0, close_s = 0;
    bool operator==(const Shutter&) const = default;

    /// Time after `share` in [0, 1] of the time that the shutter is open.
    double time_at(double time_s, double share) const { return time_s + open_s + share * (close_s - open_s); }
};

} // namespace pertev
