#include "session/survey/aim_camera.h"

#include "session/survey/cast_rays.h"

namespace pertev {

Target target_from(const Scene& scene, Vec3 eye) {
    const Bounds3 box = bounds_of(scene);
    if (box.is_empty()) return {}; // everything is hidden at rest
    const Vec3 centre = box.centre(), size = box.size();
    // At a smaller distance rounding would determine the direction.
    if (length(centre - eye) > 1e-4f * max_component(size)) return {centre, true};
    return {size.x >= size.z ? Vec3{box.lo.x, centre.y, centre.z} : Vec3{centre.x, centre.y, box.lo.z}, false};
}

std::optional<float> distance_in_the_middle(const Scene& scene, const Camera& camera) {
    const SurveyRay ray = {camera.world_from_camera.translation, normalize(-column(camera.world_from_camera, 2))};
    const SurveyHit hit = cast_rays(scene, {&ray, 1}, Backs::Shown).front();
    return hit.is_hit() ? std::optional(hit.distance) : std::nullopt;
}

} // namespace pertev
