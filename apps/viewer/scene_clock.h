#pragma once

// The time of a scene that moves, as it runs and stands: pure arithmetic. Whoever owns it says how many seconds have
// passed.

#include <algorithm>
#include <cmath>
#include <optional>

namespace pertev {

struct SceneClock {
    double end_s = 0;             // all that moves has come to its end; 0: nothing moves
    std::optional<double> time_s; // none: at rest, before any time
    bool plays = false, loops = true;
    double speed = 1; // seconds of the scene a second

    /// So many seconds have passed. From rest it starts at 0. At the end it begins anew, or stops there.
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

    /// Runs or stands. One that has come to its end begins anew.
    void play(bool on) {
        if (on && !plays && time_s && *time_s >= end_s) time_s = 0;
        plays = on;
    }

    void go_to(double to_s) { time_s = std::clamp(to_s, 0.0, end_s); }
};

} // namespace pertev
