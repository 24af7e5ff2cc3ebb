#pragma once

// Repeats chapter 6 of Bellek, "Realtime photo-realistic rendering using modern GPU systems", M.Sc. thesis, ITU 2014:
// frames per second, seconds per frame and rays per second by path depth at 1024x768. Table 6.3 is the Cornell box
// with and without persistent threads, table 6.4 the same for Sibenik cathedral. Table 6.5 is Sibenik with persistent
// threads, with and without redundant traversal avoidance, and table 6.6 compares both with Aila and Laine's kernel.
// Figures 6.7 to 6.11 follow. P = persistent threads, R = without redundant traversal avoidance, A = Aila and Laine's
// kernel: dynamic fetch, Woop's unit-triangle test, boxes without padding. Pictures of chapters 2 to 4 are added
// (thesis_pictures.h).

#include <span>
#include <string>
#include <vector>

#include "lab/lab_report.h"
#include "lab/measurement.h"
#include "lab/thesis_pictures.h"

namespace pertev {

/// A column of the tables.
struct ThesisVariant {
    const char* name; // such as "PSWW" or "PSWW-R"
    const char* meaning;
    Combination combination;
};

/// Returns the variants on this kind of device; a CPU has none with persistent threads.
std::vector<ThesisVariant> thesis_variants(bool is_cuda);

/// Reports of the Cornell box and Sibenik, in this order, with exactly the variants' combinations. The caller
/// provides the pictures' captions, including notes on interrupted pictures. The device is a GPU if a report's device
/// is not "CPU".
struct ThesisReport {
    std::vector<LabReport> scenes;
    std::vector<ResultPicture> local_and_global; // figures 6.7 and 6.8
    std::vector<ThesisPicture> pictures;         // pictures of chapters 2 to 4, in the thesis's order
    std::vector<std::string> lacking;            // parts that could not be made, with the reason, one line each
};

/// Makes the tables "frames" (a row for each scene, variant and depth, of which the page draws tables 6.3 to 6.6 and
/// figures 6.9 to 6.11), "pictures" of chapters 2 to 4, "variants" and "scenes". Notes say what has no figures and why,
/// and how many rays A loses.
Measurement measurement_of(const ThesisReport& thesis, Measurement head = {});
std::string text_of(const ThesisReport& thesis);

/// Makes a table of the pictures, one per row: how each was made and how long that took. Values that a picture does not
/// have are empty.
ResultTable table_of(std::span<const ThesisPicture> pictures);

} // namespace pertev
