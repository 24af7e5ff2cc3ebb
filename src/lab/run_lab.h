#pragma once

// The traversal laboratory. It makes the rays of a frame and compares the reference traversal (while-while over the
// binned binary tree) with brute force on some of them. It then compares every combination with the reference traversal
// on all rays and times those that agree.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/sink.h"
#include "device/queue.h"
#include "lab/lab_report.h"
#include "scene/scene.h"

namespace pertev {

struct LabSettings {
    std::string scene;  // the scene's name in the report
    std::string camera; // describe_camera's text in the front end's words, for the report
    std::vector<StructureKind> structures;
    std::vector<TraversalKind> traversals;
    std::vector<TraversalOptions> options; // each is combined with every structure and traversal
    std::vector<Distribution> distributions = {Distribution::OneAThread};
    bool by_name = false; // structures and traversals were both named, so pairs that make no sense are listed with
                          // the reason
    std::vector<Combination> only; // if not empty, exactly these combinations, instead of all that the fields above
                                   // give
    uint32_t width = 1024, height = 768;
    int first_depth = 1, depth = 2; // numbers of rays in the shortest and longest paths of frames, [1, 9]
    bool primary = true, shadow = true, diffuse = true;
    uint32_t record_rays = 0;    // if not 0, measures the record's five sets with this many rays each instead of a
                                 // frame's sets
    int runs = 20, warm_ups = 3; // with 0 runs combinations are checked, but not timed or counted
    bool heat_maps = true;
};

/// Number of rays in each set on which the reference traversal is compared with brute force: rays spread over the set,
/// and additional rays along axes or exactly at edges of triangles.
inline constexpr uint32_t kOracleRays = 2000, kOracleStressRays = 200;

/// Measures all combinations of the settings. Stops early, with `interrupted` set, when `sink` stops; a running build
/// or timed run is finished first. `save` gets the results so far after each structure. Throws Error(BadInput) for a
/// scene without triangles or if no combination can be measured, Error(OutOfMemory) if the rays do not fit, and
/// Error(DeviceFault) if the reference traversal differs from brute force. A combination that differs from the
/// reference traversal or does not fit into memory has no figures but a reason.
LabReport run_lab(Queue& queue, const Scene& scene, const Camera& camera, const LabSettings& settings,
                  Sink& sink = nobody(), const std::function<void(const LabReport&)>& save = {});

} // namespace pertev
