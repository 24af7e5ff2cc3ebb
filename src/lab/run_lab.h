#pragma once

// The laboratory: makes the rays of a frame, holds one walk of one tree (the proven walk: while-while over the binned
// binary tree) against brute force on some of them, then every combination against the proven walk on all of them, and
// times those that agree.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "device/queue.h"
#include "lab/lab_report.h"
#include "scene/scene.h"

namespace pertev {

struct LabSettings {
    std::string scene;  // its name in the report
    std::string camera; // describe_camera in the words of the front end, for the report
    std::vector<StructureKind> structures;
    std::vector<WalkKind> walks;
    std::vector<WalkOptions> options; // each is tried with every structure and walk
    std::vector<Distribution> distributions = {Distribution::OneAThread};
    bool by_name = false; // structures and walks were both named: pairs that make no sense are listed with the reason
    std::vector<Combination> only; // where given, these in place of all of the above with each other
    uint32_t width = 1024, height = 768;
    int first_depth = 1, depth = 2; // rays of the shortest and the longest path that frames are of, [1, 9]
    bool primary = true, shadow = true, diffuse = true;
    uint32_t record_rays = 0;    // where not 0: the record's five sets of so many rays each, in place of a frame's
    int runs = 20, warm_ups = 3; // 0 runs: combinations are checked and nothing is timed or counted
    bool heat_maps = true;
};

/// Rays of each set that the proven walk is held against brute force on: spread over the set, and as many more that
/// run along axes or exactly at edges of triangles.
inline constexpr uint32_t kOracleRays = 2000, kOracleNastyRays = 200;

struct LabProgress {
    double share = 0; // done, [0, 1]
    std::string doing;
    double share_of_that = 0;          // where that is long work, done in pieces
    double seconds = 0;                // since the start
    const LabReport* so_far = nullptr; // after each structure: what has been measured, to be kept
    const HeatMap* heat_map = nullptr; // one that was just made, to be kept: the report has but a few of them
};

/// Stops early, with `interrupted` set, when keep_going returns false; a builder, and a run that is timed, are finished
/// first. Throws Error(BadInput) for a scene without triangles or where no combination can be measured,
/// Error(OutOfMemory) where the rays do not fit, Error(DeviceFault) where the proven walk itself differs from brute
/// force. A combination that differs from the proven walk, or does not fit into memory, has no figures and says so.
LabReport run_lab(Queue& queue, const Scene& scene, const Camera& camera, const LabSettings& settings,
                  const std::function<bool(const LabProgress&)>& keep_going);

} // namespace pertev
