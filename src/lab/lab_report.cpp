#include "lab/lab_report.h"

#include <algorithm>

namespace pertev {

double frame_seconds(const LabReport& report, const CombinationFigures& combination, int depth) {
    double seconds = 0;
    int found = 0;
    for (const RunFigures& run : combination.runs) {
        const int at = report.sets[run.set].depth;
        if (at < 1 || at > depth) continue;
        seconds += run.median_s;
        ++found;
    }
    return found == depth ? seconds : 0;
}

uint64_t frame_rays(const LabReport& report, int depth) {
    uint64_t rays = 0;
    for (const SetFigures& set : report.sets) rays += set.depth >= 1 && set.depth <= depth ? set.rays : 0;
    return rays;
}

int largest_depth(const LabReport& report) {
    int depth = 0;
    for (const SetFigures& set : report.sets) depth = std::max(depth, set.depth);
    return depth;
}

} // namespace pertev
