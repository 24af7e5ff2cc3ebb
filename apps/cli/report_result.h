#pragma once

// What a render says: the camera at its start, files, time and rates at its end.

#include <cstdint>
#include <string>

#include "apps/cli/reporter.h"
#include "base/error.h"
#include "session/writing/write_picture.h"

namespace pertev {

/// Of the host's memory, the most that this process has had.
uint64_t peak_memory_bytes();

/// With --json, an object of the flags that place this camera, under the names and with the values that they have in an
/// EXR's metadata, where vectors are texts and here arrays.
void report_camera(const CameraSource& camera, Reporter& reporter);

/// Says which files were written. Returns what went wrong with the others; empty where nothing has.
std::string report_files(const WrittenPicture& written, Reporter& reporter);

/// As members of a JSON object: `hash`, `layers_hash` and `denoised_hash`, null where there are none.
std::string hashes_json(const WrittenPicture& written);

/// What --strict ends with where samples are not finite.
Error not_finite(uint64_t invalid_samples);

/// Says time, rates, memory, invalid samples and hashes. `total_seconds` since the scene began to load; `queue`: that
/// it was rendered on; `interrupted`: before all samples were done.
void report_result(const RenderResult& result, const WrittenPicture& written, const Queue& queue, double total_seconds,
                   bool interrupted, Reporter& reporter);

} // namespace pertev
