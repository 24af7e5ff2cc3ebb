#pragma once

// Remakes the pictures of chapters 2 to 4 of the thesis (lab/thesis.h), each by the algorithm that it shows. Figures
// have the thesis's numbers: 3.3 hard shadows, 3.4 soft shadows, 3.6 indirect light alone, 3.7 radiosity in four
// panels, 3.8 the Cornell box with a mirror sphere, 3.9 the photon map, 3.10 the caustic under glass, 4.1 points
// found in a tree. Other pictures that belong to these chapters are listed under their section.

#include <string>
#include <string_view>
#include <vector>

#include "device/queue.h"
#include "image/image.h"
#include "session/session.h"

namespace pertev {

struct ThesisPicture {
    std::string name;       // file name without its extension, for example "figure-3.7a"
    std::string place;      // "Figure 3.7", for example; pictures with one place and title stand side by side
    std::string title;      // such as "radiosity"
    std::string shows;      // content of the picture and its algorithm
    std::string integrator; // integrator's name; empty if the picture is not rendered
    std::string command;    // the scene and settings that make the same bytes on this device, to be phrased by a front
                            // end; empty if there are none
    Rgba8Image image;       // the pixels, unless the picture is an `svg`
    std::string svg;        // a complete SVG file
    RenderStats stats;
    double solve_seconds = 0; // solving time, which stats.render_seconds does not include
    bool interrupted = false; // it has fewer samples than requested

    std::string file() const { return name + (svg.empty() ? ".png" : ".svg"); }
};

/// Returns the names of all pictures in the thesis's order.
std::vector<std::string> thesis_picture_names();

/// Makes pictures one by one. A picture's exposure does not depend on its size.
class ThesisPictures {
public:
    /// Takes size, samples, depth and the path tracer's body from `settings`. Pictures that stand side by side have
    /// half the width and height. `queue` must outlive this.
    ThesisPictures(Queue& queue, const RenderSettings& settings) : queue_(queue), settings_(settings) {}

    /// Makes the picture with this name. Throws Error(Interrupted) if it is stopped before there is anything to show,
    /// and what Session and solve_radiosity throw.
    ThesisPicture make(std::string_view name, Sink& sink = nobody());

private:
    struct Job;

    void render(const Job& job, const RenderSettings& settings, ThesisPicture& picture);
    void show_photons(const Job& job, ThesisPicture& picture);
    void count_work(const Job& job, ThesisPicture& picture);
    void show_radiosity(const Job& job, ThesisPicture& picture);
    RenderResult render_once(const Job& job, const RenderSettings& settings, double from, double to);

    Queue& queue_;
    RenderSettings settings_;
};

} // namespace pertev
