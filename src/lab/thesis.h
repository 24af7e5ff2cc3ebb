#pragma once

// Chapter 6 of Bellek, "Realtime photo-realistic rendering using modern GPU systems", M.Sc. thesis, ITU 2014, measured
// anew: frames a second, seconds a frame and rays a second over the depth of paths at 1024x768. Table 6.3: the Cornell
// box with and without persistent threads; 6.4: Sibenik cathedral likewise; 6.5: Sibenik with persistent threads and
// without redundant traversal avoidance; 6.6: both against Aila and Laine's kernel. And figures 6.7 to 6.11.
// P = persistent threads, R = without redundant traversal avoidance, A = Aila and Laine's kernel: dynamic fetch, Woop's
// unit-triangle test, boxes that are not grown. Pictures of chapters 2 to 4 stand beside these
// (thesis_pictures.h).

#include <string>
#include <vector>

#include "lab/lab_report.h"
#include "lab/thesis_pictures.h"

namespace pertev {

/// One column of the tables.
struct ThesisVariant {
    const char* name; // "PSWW", "PSWW-R", ...
    const char* meaning;
    Combination combination;
};

/// What there is on this kind of device: on a CPU nothing is persistent.
std::vector<ThesisVariant> thesis_variants(bool is_cuda);

/// Reports of Cornell box and Sibenik, in this order, of exactly the variants' combinations; `local` and `global` are
/// pictures of the two scenes, empty where one could not be made. Captions are the caller's, notes on pictures that
/// were cut short included. The device is a GPU where a report's is not "CPU".
struct ThesisReport {
    std::vector<LabReport> scenes;
    std::vector<Picture> local, global;
    std::vector<ThesisPicture> pictures; // of chapters 2 to 4, in their order
    std::vector<std::string> lacking;    // what could not be made, and why: a line each
};

struct ThesisFigure {
    const char* number; // "6.9"
    std::string title;
    std::string svg;     // a file by itself; empty: there is nothing to draw,
    std::string missing; // and why
};

/// Figures 6.9 to 6.11: frames a second over the depth of paths.
std::vector<ThesisFigure> figures_of(const ThesisReport& thesis);

/// Tables, and below them what has no figures and why, and how many rays A loses.
std::string text_of(const ThesisReport& thesis);
std::string html_of(const ThesisReport& thesis);

} // namespace pertev
