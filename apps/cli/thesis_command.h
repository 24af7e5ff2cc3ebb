#pragma once

// pertev lab --thesis

#include <string>

#include "apps/cli/reporter.h"
#include "apps/cli/scene_options.h"
#include "device/queue.h"
#include "lab/run_lab.h"

namespace pertev {

/// Measures chapter 6 of the thesis in the Cornell box and in `scene`, or where that names none in Sibenik under
/// PERTEV_SCENES; `output` is a folder, or empty. `settings` gives size, depths and runs. Returns the exit status.
int run_thesis(Queue& queue, const SceneOptions& scene, LabSettings settings, const std::string& output,
               Reporter& reporter);

} // namespace pertev
