#pragma once

// The value of an animation's channel at a time. The same bits on every machine: products, sums and roots are IEEE's,
// the rest is of math/portable_math.h.
//
// Source: glTF 2.0 appendix C (step, linear, spherical linear, cubic spline).

#include <span>

#include "math/double_vec3.h"
#include "math/vec4.h"
#include "scene/animation.h"

namespace pertev {

/// Writes the channel's value at `time_s` (finite) to `value`, which has its numbers. Before the first key and after
/// the last their values hold. A rotation is unit; one that a spline leads through 0 is that of the key before.
void sample_channel(const AnimationChannel& channel, double time_s, std::span<float> value);

/// The same of a channel of Translation, computed in double: keys far from 0 have places between them.
DoubleVec3 sample_translation(const AnimationChannel& channel, double time_s);

/// The rotation at share `t` in [0, 1] of the shorter way from `a` to `b`. All of them unit quaternions.
Vec4 slerp(Vec4 a, Vec4 b, float t);

} // namespace pertev
