#pragma once

// Results of the traversal laboratory as plain data, which the command prints or writes as CSV, JSON or HTML.
// Figures that were not measured are absent, not 0.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tracer/built_structure.h"
#include "tracer/combination.h"

namespace pertev {

/// A set of rays of one kind, traced as a whole. The reference traversal is compared with brute force; all others are
/// compared with it (lab/run_lab.h).
struct SetFigures {
    std::string name; // such as "primary", "shadow" or "diffuse1"
    bool any_hit = false;
    int depth = 0; // ray's position in a path, 1 for camera rays; 0 if the set is not part of a frame
    uint64_t rays = 0;
    double hit_share = 0;
    uint64_t brute_force_rays = 0; // number of rays of the reference traversal that were compared with brute force
};

/// Figures of one combination on one set.
struct RunFigures {
    uint32_t set = 0;                                     // index into LabReport::sets
    double median_s = 0, min_s = 0, largest_s = 0;        // seconds that one run takes for the whole set
    std::optional<double> nodes, triangles;               // mean number of tests per ray; the meaning of a node
                                                          // differs between layouts
    std::optional<double> node_lanes, triangle_lanes;     // mean number of active lanes of 32 during a test
    std::optional<double> node_sectors, triangle_sectors; // 32-byte sectors per load of 16 bytes a lane, 1 to 32
    uint64_t different = 0; // number of rays with another result; only tests that may miss hits can have any
    /// True if the figures are copied from another combination that is the same traversal (any hit with RTA on, for
    /// example).
    bool is_copy = false;
};

struct CombinationFigures {
    Combination combination;
    std::optional<uint32_t> structure; // index into LabReport::structures; absent if it was never reached
    std::string name;
    std::string refused;                       // reason why there are no figures; empty if there are
    bool wrong = false;                        // it differs from the reference traversal; `refused` names the rays
    std::optional<int> registers, local_bytes; // registers and local bytes per thread of the closest-hit kernel
    std::optional<double> occupancy;           // resident warps as a share of the possible number, limited by
                                               // registers
    std::vector<RunFigures> runs;
};

struct HeatMap {
    std::string name; // the combination's name
    double rays_per_second = 0;
    uint32_t width = 0, height = 0;
    std::vector<uint32_t> nodes, triangles; // [height * width] tests of each pixel's primary ray
};

/// Largest number of heat maps that a report keeps: those of the fastest combinations.
inline constexpr std::size_t kHeatMapsKept = 10;

/// Name of the set with the camera rays.
inline constexpr const char* kCameraSet = "primary";

struct LabReport {
    std::string scene, device;
    std::string camera; // describe_camera's text in the front end's words
    uint64_t triangles = 0, instances = 0;
    uint32_t width = 0, height = 0;
    int first_depth = 1; // shortest path depth of the frames to show
    int runs = 0, warm_ups = 0;
    bool interrupted = false;
    std::vector<SetFigures> sets;
    std::vector<StructureFigures> structures;
    std::vector<CombinationFigures> combinations;
    std::vector<std::string> notes; // requested results that are missing, with the reason
    std::vector<HeatMap> heat_maps; // heat maps of the fastest combinations, the fastest first
};

/// Million rays per second of a run that takes this many seconds; 0 if `seconds` is 0.
inline double mrays(const LabReport& report, const RunFigures& run, double seconds) {
    return seconds > 0 ? static_cast<double>(report.sets[run.set].rays) / seconds * 1e-6 : 0;
}

/// Refused combinations grouped by reason, in order of first appearance. Wrong combinations are not included.
struct Refusal {
    std::string reason;
    std::vector<std::string> names;
};
std::vector<Refusal> refusals_by_reason(const std::vector<CombinationFigures>& combinations);

/// Returns whether the report contains anything new: figures, or a combination that is wrong.
bool has_findings(const LabReport& report);

/// Returns the combination's run on a set, or null.
const RunFigures* find_run(const CombinationFigures& combination, uint32_t set);

/// Seconds per frame with paths `depth` rays long: the sum over the sets of depths 1 to `depth`. Absent if one of
/// these sets was not measured.
std::optional<double> frame_seconds(const LabReport& report, const CombinationFigures& combination, int depth);
/// Number of rays in a frame with paths `depth` rays long.
uint64_t frame_rays(const LabReport& report, int depth);
/// The largest depth that the report has sets for.
int largest_depth(const LabReport& report);

} // namespace pertev
