#pragma once

// Where the origin of a scene's coordinates lies in its file. Floats are fine near 0 alone, so readers move a scene
// there while they still have its coordinates in double: they take `centre_of` its box off, then round.

#include "math/double_bounds3.h"
#include "scene/scene.h"

namespace pertev {

/// A scene whose centre is further from the file's origin than so many of its own sizes is far: floats in the
/// coordinates of the file would tell its places no better than to 2^-12 of its size.
inline constexpr double kFarSizes = 4096;

/// The middle of `box`, each coordinate rounded to a multiple of g, the least power of two that is not under the box's
/// longest side: 0 unless the box lies more than about its size from the origin. To move what lies there costs hardly
/// any bits: the difference of a coordinate from a multiple of g is exact but near 0. 0 for an empty box.
DoubleVec3 centre_of(const DoubleBounds3& box);

/// What a reader takes off the coordinates of a file whose scene lies in `box`: centre_of(box) where that is over 64
/// times the box's longest side from 0, else 0: nearer, floats tell places to 2^-18 of that side and better, and
/// prepare_scene() moves the world. 0 also beyond kMaxCoordinate, so that validate() refuses the scene.
DoubleVec3 origin_for(const DoubleBounds3& box);
/// Writes origin_for(box), which the reader has taken off, into the scene, and whether it is far.
void set_origin(const DoubleBounds3& box, Scene& scene);

/// Moves a scene that its nodes place, and which is in the coordinates of its file, to the middle of its box at rest:
/// instances, cameras, lights, and the vertices that joints move are placed anew.
void take_off_centre(Scene& scene);

/// A place of the scene in the coordinates of its file, and back; the latter is rounded.
inline DoubleVec3 in_file(const Scene& scene, Vec3 p) { return scene.origin_in_file + to_double(p); }
inline Vec3 in_scene(const Scene& scene, DoubleVec3 p) { return to_float(p - scene.origin_in_file); }

/// The place near `p` that numbers in double, in the coordinates of the file, lead to: in_scene(in_file(p)). To do so
/// twice changes nothing.
inline Vec3 told_in_file(const Scene& scene, Vec3 p) {
    return scene.origin_in_file == DoubleVec3{0, 0, 0} ? p : in_scene(scene, in_file(scene, p));
}

} // namespace pertev
