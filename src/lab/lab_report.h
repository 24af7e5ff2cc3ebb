#pragma once

// What the laboratory measured: plain data that the command prints and that becomes CSV, JSON, HTML.

#include <cstdint>
#include <string>
#include <vector>

#include "image/image.h"
#include "lab/combination.h"

namespace pertev {

/// A set of rays of one kind, traced as a whole.
struct SetFigures {
    std::string name; // "primary", "shadow", "diffuse 1", ...
    bool any_hit = false;
    int depth = 0; // which ray of a path these are: 1 = camera rays; 0: not part of a frame
    uint64_t rays = 0;
    double hit_share = 0;
    uint64_t brute_force_rays = 0; // of them, how many the proven walk was held against brute force on
};

struct StructureFigures {
    std::string name;                  // "sbvh", "sbvh wide4": the tree and what it was turned into
    std::string failed;                // why it is not there; empty: it is
    double build_s = 0;                // from triangles to what the walk reads, conversion included
    uint64_t nodes = 0, triangles = 0; // triangles: in leaves, so duplicates count
    std::size_t bytes = 0;             // nodes and triangles
    double sah_cost = 0;               // a node 1, a triangle 1
    int depth = 0;
};

/// One combination on one set.
struct RunFigures {
    uint32_t set = 0;                                // index into LabReport::sets
    double median_s = 0, least_s = 0, largest_s = 0; // of the runs; the whole set
    double nodes = 0, triangles = 0;                 // tests a ray
    double node_lanes = 0, triangle_lanes = 0;       // live lanes of 32 at a test; 0: not measured (CPU)
    double sectors = 0;                              // of 32 bytes, a load of 16 bytes a lane; 0: not measured
    uint64_t different = 0;                          // rays whose result differs: fast tests alone may have any
};

struct CombinationFigures {
    Combination combination;
    uint32_t structure = 0; // index into LabReport::structures
    std::string name;
    std::string refused;  // why there are no figures; empty: there are
    int registers = 0;    // of the closest-hit kernel; 0: not a kernel
    double occupancy = 0; // share of the GPU's warps that it can hold
    std::vector<RunFigures> runs;
};

struct HeatMap {
    std::string name; // of the combination
    uint32_t width = 0, height = 0;
    std::vector<uint32_t> nodes, triangles; // [height * width] tests of the primary ray of a pixel
};

struct Picture {
    std::string caption;
    Rgba8Image image;
};

struct LabReport {
    std::string scene, device, commit;
    uint64_t triangles = 0, instances = 0;
    uint32_t width = 0, height = 0;
    int first_depth = 1; // of the frames to show
    int runs = 0, warm_ups = 0;
    bool interrupted = false;
    std::vector<SetFigures> sets;
    std::vector<StructureFigures> structures;
    std::vector<CombinationFigures> combinations;
    std::vector<HeatMap> heat_maps;
    std::vector<Picture> pictures;
};

/// Million rays a second of a run.
inline double mrays(const LabReport& report, const RunFigures& run) {
    return run.median_s > 0 ? static_cast<double>(report.sets[run.set].rays) / run.median_s * 1e-6 : 0;
}

/// Seconds of a frame of paths `depth` rays long: the sets of depths 1 to that, one after the other. 0 when one of them
/// was not measured.
double frame_seconds(const LabReport& report, const CombinationFigures& combination, int depth);
/// Rays of such a frame.
uint64_t frame_rays(const LabReport& report, int depth);
/// The largest depth that there are sets for.
int largest_depth(const LabReport& report);

} // namespace pertev
