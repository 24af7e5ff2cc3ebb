#pragma once

// The parts of a camera's choice that calibrations and other programs state: a matrix, the intrinsics K, a distorting
// lens, or the metadata of a picture.

#include "scene/scene.h"
#include "settings/picture_options.h"

namespace pertev {

/// Returns the place and axes that `choice.pose` states in its convention. Throws Error(BadInput, OverLimit) if that
/// is no rotation and a place near the scene.
Transform placed_by_pose(const CameraChoice& choice, const Scene& scene);

/// Sets the intrinsics and the lens of `camera` if the choice has them; an angle of view in the choice removes the
/// camera's own intrinsics. Throws Error(BadInput).
void set_lens(const CameraChoice& choice, Camera& camera);

/// Throws Error(BadInput) if no aperture has as many blades as the choice.
void check_aperture(const CameraChoice& choice);

/// Moves `camera` to its right by `choice.eye_offset`, and with `choice.convergence` its principal point, so that what
/// is at that distance stays where it is in the picture. Lens and place are set already. Throws Error(BadInput).
void offset_eye(const CameraChoice& choice, Camera& camera);

/// Takes `picture` as the size of the choice's intrinsics, or of what a convergence gives, if none is given. Throws
/// Error(BadInput) if the shapes of the two differ by more than a pixel, because then one of the focal lengths would
/// change.
void fit_intrinsics(PictureSize picture, CameraChoice& choice);

/// Reads the file of `camera_from`, if there is one, and fills in its camera, except for what is given, and the
/// picture's size if none is. Throws Error(BadInput).
void apply_camera_from(PictureOptions& options);

} // namespace pertev
