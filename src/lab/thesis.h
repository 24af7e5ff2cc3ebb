#pragma once

// Chapter 6 of Bellek, "Realtime photo-realistic rendering using modern GPU systems", M.Sc. thesis, ITU 2014, measured
// anew: frames a second, seconds a frame and rays a second over the depth of paths at 1024x768. Table 6.3: the Cornell
// box with and without persistent threads; 6.4: Sibenik cathedral likewise; 6.5: Sibenik with persistent threads and
// without redundant traversal avoidance; 6.6: both against Aila and Laine's kernel. And figures 6.7 to 6.11.
// P = persistent threads, R = without redundant traversal avoidance, A = Aila and Laine's kernel: dynamic fetch, Woop's
// unit-triangle test, boxes that are not grown. Pictures of chapters 2 to 4 stand beside these
// (thesis_pictures.h).

#include <span>
#include <string>
#include <vector>

#include "lab/lab_report.h"
#include "lab/measurement.h"
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

/// Reports of Cornell box and Sibenik, in this order, of exactly the variants' combinations. Captions of pictures are
/// the caller's, with notes on pictures that were cut short. The device is a GPU if a report's is not "CPU".
struct ThesisReport {
    std::vector<LabReport> scenes;
    std::vector<ResultPicture> local_and_global; // figures 6.7 and 6.8
    std::vector<ThesisPicture> pictures;         // of chapters 2 to 4, in their order
    std::vector<std::string> lacking;            // what could not be made, and why: a line each
};

/// Tables 6.3 to 6.6 and what figures 6.9 to 6.11 draw beside them, "frames" (a row for each scene, variant and depth,
/// of which the page draws these figures), "pictures" of chapters 2 to 4, "variants", "scenes"; as notes, what has no
/// figures and why, and how many rays A loses.
Measurement measurement_of(const ThesisReport& thesis, Measurement head = {});
std::string text_of(const ThesisReport& thesis);

/// How each picture was made, and in which time: a row a picture. What a picture has not got is empty.
ResultTable table_of(std::span<const ThesisPicture> pictures);

} // namespace pertev
