#pragma once

// What the viewer says to its pages, as JSON: what there is to set (once), what is shown now (often), and answers. The
// rows of numbers come from one table here; the page shows whatever rows it is given.

#include <string>

#include "apps/viewer/viewer.h"

namespace pertev {

/// Once for each client: the scene, its cameras, all settings with their choices.
std::string welcome_text(const ViewerStart& start);

/// What the panel's numbers are made of.
struct ViewNumbers {
    const ShownFrame* frame = nullptr; // its image may be gone
    double frames_per_second = 0;
    double made_share = 1; // of what is made before the next picture's samples
    double pack_ms = 0;
    std::size_t packed_bytes = 0;
    const char* encoder = "";         // that packed them
    std::string phase;                // "moving", "gathering", "done"
    std::string flags;                // of the camera and the time
    uint32_t input = 0, steerer = 0;  // the last input that all this knows of, and the client that it came from
    SceneClock clock;                 // end_s is 0 where time changes nothing
    const CameraPath* path = nullptr; // that is recorded; null: none
    std::string why_still;            // ViewerStart's
};

std::string state_text(const ViewState& view, const ViewNumbers& numbers);
/// "error" or "note".
std::string notice_text(const char* kind, const std::string& text);
/// What a client pointed at; null: the background.
std::string picked_text(const Scene& scene, const PickedPoint* point, float x, float y);

} // namespace pertev
