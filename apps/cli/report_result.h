#pragma once

// Reports of a render: the camera at its start; files, time and rates at its end.

#include <cstdint>
#include <string>

#include "apps/cli/reporter.h"
#include "session/writing/write_picture.h"

namespace pertev {

/// Peak host memory of this process.
uint64_t peak_memory_bytes();

/// With --json, writes an object with the flags that reproduce this camera, with the names and values of an EXR's
/// metadata, where vectors are texts and here arrays.
void report_camera(const CameraSource& camera, Reporter& reporter);

/// With --json, writes an object with the exposure of PNG and JPEG, which the light meter may have chosen.
void report_display(const Display& display, bool is_metered, Reporter& reporter);

/// Reports the files that were written, and those that were not.
void report_files(const WrittenPicture& written, Reporter& reporter);

/// Members of a JSON object: `hash`, `layers_hash` and `denoised_hash`, null if there are none.
std::string hashes_json(const WrittenPicture& written);

/// Reports time, rates, memory, invalid samples and hashes. `pixels` is the number of pixels that got samples;
/// `total_seconds` counts from the start of loading the scene; `queue` is the one it was rendered on, and `device`
/// names all devices; `interrupted` means before all samples were done.
void report_result(const RenderResult& result, uint64_t pixels, const WrittenPicture& written, const Queue& queue,
                   const std::string& device, double total_seconds, bool interrupted, Reporter& reporter);

} // namespace pertev
