#pragma once

// The time of a moving scene, running or stopped. Its owner reports the seconds that have passed.

#include <algorithm>
#include <cmath>
#include <optional>

namespace pertev {

struct SceneClock {
    double end_s = 0;             // end of all motion; 0: nothing moves
    std::optional<double> time_s; // none: at rest, before any time
    bool plays = false, loops = true;
    double speed = 1; // seconds of the scene per second

    /// Advances by `seconds`. From rest it starts at 0. At the end it restarts or stops.
    void advance(double seconds) {
        if (!plays) return;
        time_s = time_s ? *time_s + seconds * speed : 0;
        if (*time_s < end_s || end_s <= 0) return;
        if (loops) {
            time_s = std::fmod(*time_s, end_s);
        } else {
            time_s = end_s;
            plays = false;
        }
    }

    /// Starts or stops. A clock at its end restarts.
    void play(bool on) {
        if (on && !plays && time_s && *time_s >= end_s) time_s = 0;
        plays = on;
    }

    void seek(double to_s) { time_s = std::clamp(to_s, 0.0, end_s); }
};

} // namespace pertev
