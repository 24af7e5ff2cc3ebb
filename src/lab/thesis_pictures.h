#pragma once

// The pictures of chapters 2 to 4 of the thesis (lab/thesis.h) anew, each by the algorithm that it shows. Figures have
// the thesis's numbers: 3.3 hard shadows, 3.4 soft shadows, 3.6 indirect light alone, 3.7 radiosity in four panels, 3.8
// the Cornell box with a mirror sphere, 3.9 the photon map, 3.10 the caustic under glass, 4.1 points found in a tree.
// What else belongs to these chapters stands under its section.

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "device/queue.h"
#include "image/image.h"
#include "session/render_picture.h"

namespace pertev {

struct ThesisPicture {
    std::string name;       // of its file, without what follows the last point: "figure-3.7a"
    std::string place;      // in the thesis: "Figure 3.7"; pictures of one place and title stand side by side
    std::string title;      // "radiosity"
    std::string shows;      // what is seen, and by which algorithm
    std::string integrator; // its name; empty: it is not rendered
    std::string
        command; // that makes its very bytes on this device, with settings to phrase; empty: the laboratory alone does
    Rgba8Image image; // of a picture without `svg`
    std::string svg;  // a file by itself
    RenderStats stats;
    double solve_seconds = 0; // that came before stats.render_seconds
    bool interrupted = false; // it has fewer samples than were asked for

    std::string file() const { return name + (svg.empty() ? ".png" : ".svg"); }
};

/// Names of all pictures, in the thesis's order, and of all files that they may be in.
std::vector<std::string> thesis_picture_names();
std::vector<std::string> thesis_picture_files();

/// Makes pictures one by one. Each is shown at one exposure, whatever its size.
class ThesisPictures {
public:
    /// What is being done, and the share of the picture that is done; false ends it.
    using Progress = std::function<bool(const char* doing, double share)>;

    /// `settings` says size, samples, depth and body. Where several pictures stand side by side each has half the width
    /// and half the height. `queue` outlives it.
    ThesisPictures(Queue& queue, const RenderSettings& settings) : queue_(queue), settings_(settings) {}

    /// The picture of this name. Throws Error(Interrupted) where it is ended before there is anything to show, what
    /// Session and solve_radiosity throw.
    ThesisPicture make(std::string_view name, const Progress& progress);

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
