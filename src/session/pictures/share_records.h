#pragma once

// Irradiance records that parts of a picture share by a file (records_file.h). radiosity_display shares a solution.

#include "base/sink.h"
#include "session/pictures/prepare_render.h"

namespace pertev {

/// Gives the settings of `record` and `ready` the records of the file that `options` name, if the integrator makes any:
/// those in it, or new ones, which are written there. Making them takes the memory of another copy of the scene. Throws
/// as RecordsFile, and Error(Interrupted, OutOfMemory, DeviceFault).
void share_records(const PictureOptions& options, RenderSetup& ready, PictureRecord& record, Sink& sink);

} // namespace pertev
