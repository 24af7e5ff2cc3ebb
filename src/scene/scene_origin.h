#pragma once

// The origin of a scene's coordinates in its file. Floats are precise only near 0, so readers move a scene there
// while its coordinates are in double: they subtract `centre_of` its box, then round.

#include "math/double_bounds3.h"
#include "scene/scene.h"

namespace pertev {

/// A scene is far if its centre is more than this many of its own sizes from the file's origin: floats in the
/// coordinates of the file would have an error of more than 2^-12 of its size.
inline constexpr double kFarSizes = 4096;

/// The middle of `box`, each coordinate rounded to a multiple of g, the least power of two that is not below the
/// box's longest side. It is 0 unless the box is more than about its size from the origin. The translation costs
/// hardly any precision, because the difference of a coordinate and a multiple of g is exact except near 0. Returns 0
/// for an empty box.
DoubleVec3 centre_of(const DoubleBounds3& box);

/// The origin that a reader subtracts from the coordinates of a file whose scene has this box: centre_of(box) if that
/// is over 64 times the box's longest side from 0, else 0, because at a smaller distance floats have errors of at
/// most 2^-18 of that side, and prepare_scene() moves the world. It is also 0 beyond kMaxCoordinate, so that
/// validate() refuses the scene.
DoubleVec3 origin_for(const DoubleBounds3& box);
/// Stores origin_for(box), which the reader has subtracted, in the scene, and whether the scene is far.
void set_origin(const DoubleBounds3& box, Scene& scene);

/// Moves a scene in the coordinates of its file to the middle of its box at rest: instances, cameras, lights, and
/// vertices with joints are placed again by the nodes.
void subtract_centre(Scene& scene);

/// Converts a position of the scene to the coordinates of the file, and back; the latter rounds.
inline DoubleVec3 in_file(const Scene& scene, Vec3 p) { return scene.origin_in_file + to_double(p); }
inline Vec3 in_scene(const Scene& scene, DoubleVec3 p) { return to_float(p - scene.origin_in_file); }

/// The position that results if `p` is stated in the coordinates of the file, in double: in_scene(in_file(p)). The
/// function is idempotent.
inline Vec3 rounded_to_file(const Scene& scene, Vec3 p) {
    return scene.origin_in_file == DoubleVec3{0, 0, 0} ? p : in_scene(scene, in_file(scene, p));
}

} // namespace pertev
