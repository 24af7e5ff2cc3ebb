#pragma once

// The pictures of chapter 3 of the thesis (lab/thesis.h) anew, each by the algorithm that it shows: figure 3.3 hard
// shadows, 3.4 soft shadows, 3.6 indirect light alone, 3.8 the Cornell box with a mirror sphere. All in the built-in
// Cornell box.

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "device/queue.h"
#include "image/image.h"
#include "session/render_picture.h"

namespace pertev {

struct ThesisPicture {
    const char* number; // "3.3"
    std::string title;
    std::string integrator; // its name on the command line
    Rgba8Image image;
    RenderStats stats;
    bool interrupted = false; // it has fewer samples than were asked for
};

inline constexpr const char* kThesisPictures[] = {"3.3", "3.4", "3.6", "3.8"};

/// The figure of this number, one of kThesisPictures: `settings` says size, samples and depth. It is shown at one
/// exposure, whatever the size. Throws what Session does.
ThesisPicture render_thesis_picture(Queue& queue, const char* number, const RenderSettings& settings,
                                    const std::function<bool(const RenderProgress&)>& keep_going);

/// The Cornell box of a figure, for tests.
Scene thesis_scene(std::string_view number);

} // namespace pertev
