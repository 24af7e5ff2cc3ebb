#pragma once

// What the laboratory measured: plain data that the command prints and that becomes CSV, JSON, HTML. Where nothing was
// measured there is no value, not a 0.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tracer/built_structure.h"
#include "tracer/combination.h"

namespace pertev {

/// A set of rays of one kind, traced as a whole. The proven walk is the one that is held against brute force, and that
/// all others are held to (lab/run_lab.h).
struct SetFigures {
    std::string name; // "primary", "shadow", "diffuse1", ...
    bool any_hit = false;
    int depth = 0; // which ray of a path these are: 1 = camera rays; 0: not part of a frame
    uint64_t rays = 0;
    double hit_share = 0;
    uint64_t brute_force_rays = 0; // how many rays the proven walk was held against brute force on
};

/// One combination on one set.
struct RunFigures {
    uint32_t set = 0;                                     // index into LabReport::sets
    double median_s = 0, least_s = 0, largest_s = 0;      // of the runs; the whole set
    std::optional<double> nodes, triangles;               // tests a ray; what a node is differs between layouts
    std::optional<double> node_lanes, triangle_lanes;     // live lanes of 32 at a test
    std::optional<double> node_sectors, triangle_sectors; // of 32 bytes, a load of 16 bytes a lane: 1 to 32
    uint64_t different = 0; // rays that meet something else: tests that leak alone may have any
    /// The same walk was measured for another combination (any hit with RTA on, say) and its figures stand here too.
    bool is_copy = false;
};

struct CombinationFigures {
    Combination combination;
    std::optional<uint32_t> structure; // index into LabReport::structures; none: it never came to its turn
    std::string name;
    std::string refused;                       // why there are no figures; empty: there are
    bool wrong = false;                        // it differs from the proven walk: `refused` says where
    std::optional<int> registers, local_bytes; // of the closest-hit kernel, a thread
    std::optional<double> occupancy;           // warps that fit / places for them, by its registers
    std::vector<RunFigures> runs;
};

struct HeatMap {
    std::string name; // of the combination
    double rays_per_second = 0;
    uint32_t width = 0, height = 0;
    std::vector<uint32_t> nodes, triangles; // [height * width] tests of the primary ray of a pixel
};

/// How many a report keeps: those of the fastest combinations.
inline constexpr std::size_t kHeatMapsKept = 10;

/// The name of the set that camera rays are in.
inline constexpr const char* kCameraSet = "primary";

struct LabReport {
    std::string scene, device, commit;
    uint32_t threads = 0; // of the CPU
    std::string camera;   // describe_camera in the words of the front end
    uint64_t triangles = 0, instances = 0;
    uint32_t width = 0, height = 0;
    int first_depth = 1; // of the frames to show
    int runs = 0, warm_ups = 0;
    bool interrupted = false;
    std::vector<SetFigures> sets;
    std::vector<StructureFigures> structures;
    std::vector<CombinationFigures> combinations;
    std::vector<std::string> notes;          // what was asked for and is not there, and why
    std::vector<std::string> heat_map_names; // combinations of all that were made
    std::vector<HeatMap> heat_maps;          // of the fastest, the fastest first
};

/// Million rays a second where a run takes so long; 0 where it took no time.
inline double mrays(const LabReport& report, const RunFigures& run, double seconds) {
    return seconds > 0 ? static_cast<double>(report.sets[run.set].rays) / seconds * 1e-6 : 0;
}
/// Of the median.
inline double mrays(const LabReport& report, const RunFigures& run) { return mrays(report, run, run.median_s); }

/// Refused combinations by reason, in the order in which these come up; wrong ones are not among them.
struct Refusal {
    std::string reason;
    std::vector<std::string> names;
};
std::vector<Refusal> refusals_by_reason(const std::vector<CombinationFigures>& combinations);

/// Whether there is anything in it that was not known before: figures, or a combination that is wrong.
bool has_findings(const LabReport& report);

/// The run of a combination on a set, or null.
const RunFigures* find_run(const CombinationFigures& combination, uint32_t set);

/// Seconds of a frame of paths `depth` rays long: the sets of depths 1 to that, one after the other. None where one of
/// them was not measured.
std::optional<double> frame_seconds(const LabReport& report, const CombinationFigures& combination, int depth);
/// Rays of such a frame.
uint64_t frame_rays(const LabReport& report, int depth);
/// The largest depth that there are sets for.
int largest_depth(const LabReport& report);

/// What exactness costs: time of this combination over that of the same one with fast tests, on the same set. None
/// where either was not measured, or this one has not the exact tests itself.
std::optional<double> price_of_exactness(const LabReport& report, const CombinationFigures& combination, uint32_t set);

} // namespace pertev
