#include "formats/mitsuba/clipping.h"

#include <algorithm>
#include <map>

#include "math/portable_math.h"

namespace pertev::mitsuba {
namespace {

/// Returns a box in the camera's space, with z along the view, around what lies in its view before the near plane.
Bounds3 space_before(const Camera& camera, float near) {
    Bounds3 box;
    if (has_parallel_rays(camera.projection)) {
        const float half = 0.5f * camera.ortho_height, across = half * camera.aspect;
        box.lo = {-across, -half, 0}, box.hi = {across, half, near};
        return box;
    }
    const float high = near * tan(0.5f * camera.fov_y), across = high * camera.aspect;
    box.lo = {-across, -high, 0}, box.hi = {across, high, near};
    if (camera.intrinsics) {
        const Intrinsics& of = *camera.intrinsics;
        const auto shifted = [near](double pixels, double focal) { return near * static_cast<float>(pixels / focal); };
        box.lo = {shifted(-of.centre_x, of.focal_x), shifted(of.centre_y - of.height, of.focal_y), 0};
        box.hi = {shifted(of.width - of.centre_x, of.focal_x), shifted(of.centre_y, of.focal_y), near};
    }
    return box;
}

bool overlap(const Bounds3& a, const Bounds3& b) {
    return a.lo.x < b.hi.x && b.lo.x < a.hi.x && a.lo.y < b.hi.y && b.lo.y < a.hi.y && a.lo.z < b.hi.z &&
           b.lo.z < a.hi.z;
}

/// Returns whether a triangle may meet a box: their boxes overlap, and the triangle's plane divides the box.
bool may_meet(const Bounds3& box, const Vec3 (&corners)[3]) {
    Bounds3 own;
    for (const Vec3 p : corners) own.extend(p);
    if (!(own.hi.z > 1e-6f * box.hi.z)) return false; // the camera's own plane is invisible
    // A flat triangle's box has no depth, so equality counts along its plane.
    const Vec3 size = own.size(), slack = 1e-6f * Vec3{size.x + size.y + size.z, size.x + size.y + size.z, size.z};
    own.lo = own.lo - slack, own.hi = own.hi + slack;
    if (!overlap(own, box)) return false;
    const Vec3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
    const float middle = dot(normal, box.centre() - corners[0]), reach = 0.5f * dot(abs(normal), box.size());
    return abs(middle) <= reach;
}

} // namespace

Clipping find_clipping(const Scene& scene, const Camera& camera, float near, float far) {
    const Bounds3 space = space_before(camera, near);
    const Transform camera_from_world = inverse(camera.world_from_camera);
    std::map<uint32_t, Bounds3> boxes; // by mesh
    Clipping found;
    for (const Instance& instance : scene.instances) {
        if (instance.is_hidden || scene.materials[instance.material].is_clear_boundary) continue;
        const Mesh& mesh = scene.meshes[instance.mesh];
        const auto [known, is_new] = boxes.try_emplace(instance.mesh);
        if (is_new) known->second = bounds_of(mesh);
        const Bounds3& local = known->second;
        if (local.is_empty()) continue;
        const auto in_camera = [&](Vec3 p) {
            const Vec3 q = transform_point(camera_from_world, transform_point(instance.world_from_local, p));
            return Vec3{q.x, q.y, -q.z};
        };
        Bounds3 box;
        for (int i = 0; i < 8; ++i)
            box.extend(in_camera({(i & 1) != 0 ? local.hi.x : local.lo.x, (i & 2) != 0 ? local.hi.y : local.lo.y,
                                  (i & 4) != 0 ? local.hi.z : local.lo.z}));
        found.is_far = found.is_far || box.hi.z > far;
        if (found.is_near || box.lo.z > near || box.hi.z < 0) continue;
        for (std::size_t i = 0; i + 2 < mesh.indices.size() && !found.is_near; i += 3) {
            const uint32_t* const of = mesh.indices.data() + i;
            const Vec3 corners[3] = {in_camera(mesh.positions[of[0]]), in_camera(mesh.positions[of[1]]),
                                     in_camera(mesh.positions[of[2]])};
            found.is_near = may_meet(space, corners);
        }
    }
    return found;
}

} // namespace pertev::mitsuba
