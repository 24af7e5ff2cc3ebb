#pragma once

// Renders the frames of a sequence and writes their files, with a record of their hashes beside them by which an
// interrupted sequence continues (session/writing/sequence_record.h).

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/sink.h"
#include "session/pictures/render_sequence.h"
#include "session/writing/write_picture.h"

namespace pertev {

/// A frame that has just been written, or that an earlier run has written.
struct FrameReport {
    uint32_t frame = 0;
    std::optional<double> time_s; // time of the frame; none: the scene is at rest
    bool is_kept = false;
    std::string camera;     // name of the frame's camera in a list; empty: there is none
    std::string hash;       // the picture's hash; empty if it is kept and was not rendered again
    WrittenPicture written; // the frame's files, also those that could not be written; none if it is kept
    uint32_t samples = 0;
    double update_s = 0, render_s = 0; // seconds to move the scene, and to render
};

struct SequenceTally {
    uint32_t frames = 0;            // requested of this part
    bool has_begun = false;         // a frame was rendered, written or not
    uint32_t written = 0, kept = 0; // frames whose files are all there
    uint32_t again = 0;             // kept frames that were rendered for the history of others
    uint64_t invalid_samples = 0;
    double update_s = 0;

    bool is_complete() const { return written + kept == frames; }
};

/// Renders and writes the frames in order, or with `continue` those that are not there yet, until the sink is
/// cancelled, and counts in `tally` as it goes on. `frames` are at the first frame and have the exposure of all; frames
/// with a history (PictureRecord::in_sequence) begin with a cut, and those from the last one before a part are
/// rendered, too. `outputs` are names with #. Calls `report` for each frame, also for one whose files could not all be
/// written. Throws Error if a frame cannot be rendered or written, or if the frames that are there have other settings:
/// those before it are whole.
void write_sequence(const SequenceOfFrames& frames, const PictureOptions& options,
                    const std::vector<std::string>& outputs, Sink& sink,
                    const std::function<void(const FrameReport&)>& report, SequenceTally& tally);

} // namespace pertev
