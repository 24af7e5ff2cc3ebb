#pragma once

// The cameras of a file (formats/cameras/read_cameras.h), and the eyes of stereo pairs, as pictures of one scene:
// camera k makes picture k.

#include "settings/picture_options.h"

namespace pertev {

/// Reads the file of `cameras`, if there is one and it was not read before, into `camera_list`; with `stereo` each
/// camera, or the only one, becomes two. Throws Error(BadInput).
void read_camera_list(PictureOptions& options);

/// Returns the options of the picture by camera `number` alone, without the list. Throws Error(BadInput) for what
/// is no setting of a camera, or does not go with others.
PictureOptions options_of_camera(const PictureOptions& options, uint32_t number, uint32_t verbs);

} // namespace pertev
