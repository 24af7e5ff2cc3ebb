#pragma once

// How long a shutter is open. What moves meanwhile is blurred: each sample sees the scene at a time of its own, drawn
// evenly from then. Instances and the camera move rigidly (math/motion_keys.h); all else stands as at the picture's
// time: scales, skins, morph targets, lights that are no meshes, angles of view.
//
// Source: Cook, Porter, Carpenter, "Distributed Ray Tracing", SIGGRAPH 1984.

namespace pertev {

/// Seconds from the picture's own time: it opens and closes. open_s <= close_s.
struct Shutter {
    double open_s = 0, close_s = 0;
    bool operator==(const Shutter&) const = default;

    /// `share` in [0, 1] of the time that it is open, after a picture's time.
    double time_at(double time_s, double share) const { return time_s + open_s + share * (close_s - open_s); }
};

} // namespace pertev
