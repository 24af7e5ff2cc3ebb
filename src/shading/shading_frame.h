#pragma once

// The coordinate frame of a BSDF: interpolated normal and tangent, normal map. It follows glTF 2.0 sections 3.7.2.1
// and 3.9.3: x of the map is the tangent; y = cross(normal, tangent) * w points to the top of the image, thus against
// growing v.
//
// A bent normal may reflect into the surface, which shows as black spots. valid_normal turns it just far enough
// (Keller et al., "The Iray Light Transport Simulation and Rendering System", 2017, appendix A.3).

#include <type_traits>

#include "base/host_device.h"
#include "math/frame.h"
#include "math/scalar.h"
#include "math/transform.h"
#include "math/vec2.h"
#include "math/vec3.h"
#include "math/vec4.h"

namespace pertev {

/// Weighted sum of three vertices' values; b1 and b2 belong to the second and third.
template <class T = float>
HD inline Vec3Of<T> interpolate(Vec3Of<T> v0, Vec3Of<T> v1, Vec3Of<T> v2, T b1, T b2) {
    return (1.0f - b1 - b2) * v0 + b1 * v1 + b2 * v2;
}
HD inline Vec2 interpolate(Vec2 v0, Vec2 v1, Vec2 v2, float b1, float b2) {
    return (1.0f - b1 - b2) * v0 + b1 * v1 + b2 * v2;
}

/// Returns `v` at unit length, or `otherwise` if it has no direction (zero, tiny or not finite).
template <class T = float>
HD inline Vec3Of<T> normalize_or(Vec3Of<T> v, std::type_identity_t<Vec3Of<T>> otherwise) {
    const T squared = length_squared(v);
    return select(squared > 0x1p-80f && is_finite(squared), (1.0f / sqrt(squared)) * v, otherwise);
}

/// Unit world-space shading normal on the side of the front face. `local_normal` is the interpolated vertex normal
/// (zero: none); `geometric_normal` is unit, world space, of the front. A normal that points behind the face is
/// considered an error of the file and replaced by the geometric one.
template <class T = float>
HD inline Vec3Of<T> world_normal(const TransformOf<T>& local_from_world, Vec3Of<T> local_normal,
                                 Vec3Of<T> geometric_normal) {
    const Vec3Of<T> normal = normalize_or(transform_transposed(local_from_world, local_normal), geometric_normal);
    return select(dot(normal, geometric_normal) > 0, normal, geometric_normal);
}

/// Frame with z = `normal` (unit), x as near to `tangent` (any length) as possible, and y by the handedness `w`, so
/// that the frame is left-handed for w < 0. If the tangent has no component perpendicular to the normal, it is an
/// arbitrary right-handed frame.
template <class T = float>
HD inline FrameOf<T> frame_with_tangent(Vec3Of<T> normal, std::type_identity_t<Vec3Of<T>> tangent,
                                        std::type_identity_t<T> w) {
    const Vec3Of<T> along = normalize_or<T>(tangent, {0, 0, 0});
    const Vec3Of<T> across = along - dot(along, normal) * normal;
    const MaskOf<T> has_tangent = length_squared(across) > 1e-10f;
    if (!any(has_tangent)) return make_frame(normal);
    const Vec3Of<T> x = normalize(across);
    const FrameOf<T> frame = {x, select(w < 0, T(-1.0f), T(1.0f)) * cross(normal, x), normal};
    return any(!has_tangent) ? select(has_tangent, frame, make_frame(normal)) : frame;
}

/// Transforms `frame` (orthonormal) for a map with transformed coordinates: u' grows by u_by.x with u and by u_by.y
/// with v, and v' by v_by. Its x lies along growing u' at constant v', and a mirroring transform flips it. A pure
/// scale, or a transform without inverse, changes nothing.
template <class T = float>
HD inline FrameOf<T> frame_of_transformed_map(const FrameOf<T>& frame, Vec2Of<T> u_by, Vec2Of<T> v_by) {
    const T det = u_by.x * v_by.y - u_by.y * v_by.x;
    const MaskOf<T> is_scale = u_by.y == 0 && v_by.x == 0 && u_by.x > 0 && v_by.y > 0;
    const MaskOf<T> changes = !is_scale && abs(det) > 0 && is_finite(det);
    if (!any(changes)) return frame;
    const T sign = copysign(T(1.0f), det);
    const Vec3Of<T> along = sign * (v_by.y * frame.tangent + v_by.x * frame.bitangent); // y of the frame is against v
    const Vec3Of<T> x = normalize_or(along, frame.tangent);
    const T handedness = sign * copysign(T(1.0f), dot(cross(frame.normal, frame.tangent), frame.bitangent));
    return select(changes, FrameOf<T>{x, handedness * cross(frame.normal, x), frame.normal}, frame);
}

/// Unit normal of a normal map's texel: `texel` is the colour in [0, 1], `scale` the map's strength.
template <class T = float>
HD inline Vec3Of<T> mapped_normal(const FrameOf<T>& frame, std::type_identity_t<Vec3Of<T>> texel,
                                  std::type_identity_t<T> scale) {
    const Vec3Of<T> local = {scale * (2.0f * texel.x - 1.0f), scale * (2.0f * texel.y - 1.0f), 2.0f * texel.z - 1.0f};
    return normalize_or(frame.to_world(local), frame.normal);
}

/// Turns `normal` (unit) as little as needed so that the mirror direction of `wo` lies above the surface. wo is unit;
/// `geometric_normal` is unit and on wo's side; wo may lie below `normal`. The result is unit and on the side of
/// both.
template <class T = float>
HD inline Vec3Of<T> valid_normal(Vec3Of<T> normal, Vec3Of<T> geometric_normal, Vec3Of<T> wo) {
    const T above = dot(wo, geometric_normal);
    const T least = min(0.9f * above, T(0.01f));    // so that an unbent normal never changes
    const T facing = max(dot(wo, normal), T(0.0f)); // a normal turned away from wo counts as seen edge-on
    const Vec3Of<T> mirrored = 2.0f * facing * normal - wo;
    const T height = dot(mirrored, geometric_normal);
    const MaskOf<T> is_valid = height >= least && facing > 0;
    if (!any(!is_valid)) return normal;
    const MaskOf<T> is_flat = above < 1e-3f; // the sum below would cancel
    const Vec3Of<T> along = normalize_or(mirrored - height * geometric_normal, {0, 0, 0});
    const Vec3Of<T> raised = safe_sqrt(1.0f - square(least)) * along + least * geometric_normal;
    const Vec3Of<T> turned = select(is_flat, geometric_normal, normalize_or(wo + raised, geometric_normal));
    return select(is_valid, normal, turned);
}

} // namespace pertev
