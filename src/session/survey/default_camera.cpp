#include "session/survey/default_camera.h"

#include <fmt/format.h>

#include "math/portable_math.h"
#include "session/place_text.h"
#include "session/survey/aisle.h"
#include "session/survey/surroundings.h"

namespace pertev {
namespace {

constexpr float kFovOutside = 0.6981317f, kFovInside = 1.1344640f; // 40 and 65 degrees, of the smaller side

Camera look(Vec3 eye, Vec3 target, float fov_y, const char* name) {
    Camera camera;
    camera.name = name;
    camera.world_from_camera = look_at(eye, target, {0, 1, 0});
    camera.fov_y = fov_y;
    camera.focus_distance = max(length(target - eye), 0x1p-40f);
    return camera;
}

/// The vertical angle at which the smaller side of the picture spans `fov`; its tangent's half for both sides.
struct Opening {
    float fov_y, half_x, half_y;
};

Opening opening(float fov, float aspect) {
    const float half = sin(0.5f * fov) / cos(0.5f * fov);
    const float half_y = aspect < 1 ? half / aspect : half;
    return {2 * atan2(half_y, 1.0f), half_y * aspect, half_y};
}

/// From `direction` (unit, towards the eye), as near as shows all of the scene (of large meshes a part of the
/// vertices).
Camera fitted(const Scene& scene, const Bounds3& box, Vec3 direction, float aspect, const char* name) {
    const Opening o = opening(kFovOutside, aspect);
    const Vec3 centre = box.centre();
    const Transform view = look_at(direction, {}, {0, 1, 0}); // columns: right, up, back
    float distance = 0;
    for (const Instance& instance : scene.instances) {
        if (instance.is_hidden) continue;
        const Mesh& mesh = scene.meshes[instance.mesh];
        const std::size_t step = 1 + mesh.indices.size() / 20'000;
        for (std::size_t i = 0; i < mesh.indices.size(); i += step) {
            const Vec3 p = transform_point(instance.world_from_local, mesh.positions[mesh.indices[i]]) - centre;
            const float x = abs(dot(p, column(view, 0))), y = abs(dot(p, column(view, 1))), z = dot(p, column(view, 2));
            distance = max(distance, z + max(x / o.half_x, y / o.half_y));
        }
    }
    if (distance == 0) distance = length(box.size());
    return look(centre + (1.08f * distance) * direction, centre, o.fov_y, name);
}

Camera inside(const Scene& scene, const Surroundings& room, float aspect) {
    const Aisle aisle = find_aisle(scene, room);
    const Vec3 eye = aisle.middle - (0.42f * aisle.length) * aisle.along;
    const Vec3 target = aisle.middle + (0.5f * aisle.length) * aisle.along + Vec3{0, 0.12f * aisle.height, 0};
    return look(eye, target, opening(kFovInside, aspect).fov_y, "default, inside");
}

} // namespace

Camera make_default_camera(const Scene& scene, float aspect, Messages& messages) {
    Surroundings around = look_around(scene);
    if (around.bounds.is_empty()) around.bounds = {{-1, -1, -1}, {1, 1, 1}}; // all is hidden at rest
    const char* what = "a view from outside and above";
    Camera camera;
    switch (around.kind) {
    case SurroundingsKind::Object:
        camera = fitted(scene, around.bounds, normalize({0.55f, 0.42f, 0.8f}), aspect, "default, outside");
        break;
    case SurroundingsKind::Stage:
        camera = fitted(scene, around.bounds, around.open_side, aspect, "default, in front");
        what = "a view through the open side";
        break;
    case SurroundingsKind::Room:
        camera = inside(scene, around, aspect);
        what = "a view inside";
        break;
    }
    const Vec3 eye = camera.world_from_camera.translation;
    const Vec3 target = eye - camera.focus_distance * column(camera.world_from_camera, 2);
    messages.make_up(fmt::format("no camera in the scene: {} (--eye {} --target {})", what, place_text(scene, eye, 4),
                                 place_text(scene, target, 4)));
    return camera;
}

} // namespace pertev
