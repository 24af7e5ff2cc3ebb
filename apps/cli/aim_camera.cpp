#include "apps/cli/aim_camera.h"

#include <fmt/format.h>

#include "apps/cli/parse_values.h"
#include "scene/aim_camera.h"

namespace pertev {

void aim_eye(SceneOptions& options, const Scene& scene, Messages& messages) {
    if (options.eye.empty() || !options.target.empty()) return;
    const Target target = target_from(scene, parse_position("--eye", options.eye));
    const Vec3 at = target.position;
    // As a flag would say it, and no more exactly: the notice makes the same picture.
    options.target = fmt::format("{:.6g},{:.6g},{:.6g}", at.x, at.y, at.z);
    options.is_aimed = true;
    messages.note(fmt::format("--eye without --target: it looks {} (--eye {} --target {})",
                              target.is_middle ? "at the middle of the scene" : "along the scene from its middle",
                              options.eye, options.target));
}

void focus_in_the_middle(const SceneOptions& options, const Scene& scene, Camera& camera, Messages& messages) {
    const bool has_target = !options.target.empty() && !options.is_aimed;
    if (!(options.aperture_m > 0) || options.focus_m > 0 || has_target) return;
    const std::optional<float> seen = distance_in_the_middle(scene, camera);
    const float away = length(bounds_of(scene).centre() - camera.world_from_camera.translation);
    const std::string distance = fmt::format("{:.4g}", seen.value_or(max(away, 0x1p-40f)));
    camera.focus_distance = parse_number("--focus", distance);
    messages.note(fmt::format("--aperture without --focus: sharp at {} m, {} (--focus {})", distance,
                              seen ? "the distance of what is in the middle of the picture"
                                   : "the distance of the scene's middle, for nothing is in that of the picture",
                              distance));
}

} // namespace pertev
