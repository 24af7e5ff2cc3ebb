#pragma once

// Messages of the viewer to its pages as JSON: the settings (once), the current state (often), and answers. The rows
// of numbers come from one table here; the page shows whatever rows it gets.

#include <string>

#include "apps/viewer/viewer.h"

namespace pertev {

/// Sent once to each client: the scene, its cameras, all settings with their choices.
std::string welcome_text(const ViewerStart& start);

/// Inputs of the panel's numbers.
struct ViewNumbers {
    const ShownFrame* frame = nullptr; // the shown frame, whose image may have been moved out
    double frames_per_second = 0;
    double made_share = 1; // progress of the precomputation for the next picture
    double pack_ms = 0;
    std::size_t packed_bytes = 0;
    const char* encoder = "";         // the encoder that made them
    std::string phase;                // "moving", "gathering", "done"
    std::string flags;                // flags of the camera and the time
    std::string picture_flags;        // flags of the whole picture; empty before the first
    uint32_t input = 0, steerer = 0;  // the last input that is included, and its client
    SceneClock clock;                 // end_s is 0 if time changes nothing
    const CameraPath* path = nullptr; // the recorded path; null: none
    std::string why_still;            // see ViewerStart
};

std::string state_text(const ViewState& view, const ViewNumbers& numbers);
/// Returns the message of a notice; `kind` is "error" or "note".
std::string notice_text(const char* kind, const std::string& text);
/// Answer to a pick; null for the background.
std::string picked_text(const Scene& scene, const PickedPoint* point, float x, float y);

} // namespace pertev
