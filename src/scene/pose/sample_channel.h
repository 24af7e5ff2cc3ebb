#pragma once

// The value of an animation channel at a time. It has the same bits on every machine: products, sums and roots follow
// IEEE, the rest is from math/portable_math.h.
//
// Source: glTF 2.0 appendix C (step, linear, spherical linear, cubic spline).

#include <span>

#include "math/double_vec3.h"
#include "math/vec4.h"
#include "scene/animation.h"

namespace pertev {

/// Writes the channel's value at `time_s` (finite) to `value`, which has as many components. Before the first and
/// after the last key their values hold. A rotation is unit; if a spline passes through 0, it is the previous key's.
void sample_channel(const AnimationChannel& channel, double time_s, std::span<float> value);

/// Samples a Translation channel in double, because keys far from 0 need the precision between them.
DoubleVec3 sample_translation(const AnimationChannel& channel, double time_s);

/// Interpolates rotations with fraction `t` in [0, 1] of the shorter arc from `a` to `b`. All are unit quaternions.
Vec4 slerp(Vec4 a, Vec4 b, float t);

} // namespace pertev
