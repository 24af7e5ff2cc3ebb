#include "session/survey/aisle.h"

#include "session/survey/cast_rays.h"

namespace pertev {

float distance_along(const Scene& scene, Vec3 from, Vec3 direction, float otherwise) {
    const SurveyRay ray = {from, direction};
    const SurveyHit hit = cast_rays(scene, {&ray, 1}).front();
    return hit.is_hit() ? hit.distance : otherwise;
}

Aisle find_aisle(const Scene& scene, const Surroundings& room) {
    const Vec3 size = room.bounds.size();
    const float far = size.x + size.y + size.z;
    Aisle aisle;
    aisle.floor = room.inside.y - distance_along(scene, room.inside, {0, -1, 0}, room.inside.y - room.bounds.lo.y);
    aisle.height = room.bounds.hi.y - aisle.floor;
    // In metres if the room has the size of a house, else in proportion, because the unit is unknown.
    const float eye = aisle.height > 2.2f && aisle.height < 12 ? 1.7f : 0.14f * aisle.height;
    const Vec3 from = {room.inside.x, aisle.floor + eye, room.inside.z};
    for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 0, 1}}) {
        const float ahead = distance_along(scene, from, axis, far), behind = distance_along(scene, from, -axis, far);
        if (ahead + behind <= aisle.length) continue;
        aisle.length = ahead + behind;
        aisle.middle = from + (0.5f * (ahead - behind)) * axis;
        aisle.along = axis;
    }
    return aisle;
}

} // namespace pertev
