#pragma once

// The code of a path tracer that a job needs: what it writes, and its mask of features. The host asks which masks are
// compiled (integrators/path/compiled_features.h).

#include "integrators/path/path_job.h"

namespace pertev {

/// Kinds of results. Each has its own listeners and masks.
enum class PathOutput : uint8_t {
    Films,
    Frames,
    ReusedFrames, // they leave direct light to ReSTIR
    Layers,       // films with layers of light paths, or irradiance
};

inline PathOutput output_of(const PathJob& job) {
    if (job.layers.is_there() || job.is_meter) return PathOutput::Layers;
    if (!job.film.frame.is_there()) return PathOutput::Films;
    return job.film.frame.first_bounce.leaves_direct_light() ? PathOutput::ReusedFrames : PathOutput::Frames;
}

/// Returns whether code has been compiled that has all of these features. The host has kBatched with any other.
bool is_compiled(PathOutput output, Features features);

/// Returns whether the job's vertices select lights by a tree: the settings say so, and there is code for it. The draws
/// of a light meter are by power, which must then hold for the lights that a path hits.
bool uses_light_tree(const PathJob& job);

/// Returns the features that the job needs. A moving camera's depth is along its axis at the ray's time.
Features features_for(const PathJob& job);

} // namespace pertev
