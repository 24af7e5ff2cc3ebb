#pragma once

// The end of a render: its files, with layers and metadata, and its last line.

#include <string>
#include <vector>

#include "apps/cli/choose_display.h"
#include "apps/cli/render_flags.h"
#include "apps/cli/reporter.h"

namespace pertev {

/// What the result itself does not know.
struct RenderRecord {
    std::string device;
    bool is_cuda = false;
    bool has_environment = false;
    float filter_radius = 0; // pixels
    Camera camera;
    Display display;
    double load_seconds = 0, build_seconds = 0;
    bool interrupted = false; // before all samples were done
};

struct WrittenResult {
    std::string hash;                  // of the picture
    std::vector<std::string> failures; // why a file could not be written, for each such
};

/// With --json, an object of the flags that place this camera, under the names and with the values that they have in an
/// EXR's metadata.
void report_camera(const SceneOptions& options, const Camera& camera, Reporter& reporter);

/// Writes the files that the flags name, each all or nothing; one that fails does not keep the others from being
/// written. Takes the layers out of `result`.
WrittenResult write_result(const RenderFlags& flags, const RenderRecord& record, RenderResult& result,
                           Reporter& reporter);

/// Says time, rates, memory, invalid samples and hash. `total_seconds` since the scene began to load.
void report_result(const RenderRecord& record, const RenderResult& result, const std::string& hash,
                   double total_seconds, Reporter& reporter);

} // namespace pertev
