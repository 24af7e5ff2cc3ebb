#include "session/survey/default_camera.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "math/portable_math.h"
#include "session/position_text.h"
#include "session/survey/aisle.h"
#include "session/survey/cast_rays.h"
#include "session/survey/surroundings.h"

namespace pertev {
namespace {

constexpr float kFovOutside = 0.6981317f, kFovInside = 1.1344640f; // 40 and 65 degrees, for the smaller side
constexpr float kAside = 28, kAbove = 18;                          // degrees, for a view from outside
constexpr float kAboveFlat = 38;                                   // degrees, for flat objects
constexpr uint64_t kMaxTrianglesSeen = 8'000'000;                  // a second on one core
constexpr int kViewRays = 8;                                       // rays along each side of a candidate view

Camera camera_at(Vec3 eye, Vec3 target, float fov_y, const char* name) {
    Camera camera;
    camera.name = name;
    camera.world_from_camera = look_at(eye, target, {0, 1, 0});
    camera.fov_y = fov_y;
    camera.focus_distance = max(length(target - eye), 0x1p-40f);
    return camera;
}

/// The vertical field of view at which the smaller side of the picture spans `fov`, and tangents of the half angles
/// of both sides.
struct Opening {
    float fov_y, half_x, half_y;
};

Opening opening(float fov, float aspect) {
    const float half = sin(0.5f * fov) / cos(0.5f * fov);
    const float half_y = aspect < 1 ? half / aspect : half;
    return {2 * atan2(half_y, 1.0f), half_y * aspect, half_y};
}

/// A camera in `direction` (unit, towards the eye), as near as it can be while it shows all of the scene (of large
/// meshes only some vertices are tested).
Camera fitted(const Scene& scene, const Bounds3& box, Vec3 direction, float aspect, const char* name) {
    const Opening o = opening(kFovOutside, aspect);
    const Vec3 centre = box.centre();
    const Transform view = look_at(direction, {}, {0, 1, 0}); // columns: right, up, back
    float distance = 0;
    for (const Instance& instance : scene.instances) {
        if (instance.is_hidden || instance.is_background) continue;
        const Mesh& mesh = scene.meshes[instance.mesh];
        const std::size_t step = 1 + mesh.indices.size() / 20'000;
        for (std::size_t i = 0; i < mesh.indices.size(); i += step) {
            const Vec3 p = transform_point(instance.world_from_local, mesh.positions[mesh.indices[i]]) - centre;
            const float x = abs(dot(p, column(view, 0))), y = abs(dot(p, column(view, 1))), z = dot(p, column(view, 2));
            distance = max(distance, z + max(x / o.half_x, y / o.half_y));
        }
    }
    if (distance == 0) distance = length(box.size());
    return camera_at(centre + (1.08f * distance) * direction, centre, o.fov_y, name);
}

/// Unit direction towards the eye: `aside` degrees to the right of +z as seen from there, and `above` degrees above
/// the horizon.
Vec3 direction_to_eye(float aside, float above) {
    const float a = aside * (kPi / 180), b = above * (kPi / 180);
    return {sin(a) * cos(b), sin(b), cos(a) * cos(b)};
}

/// Counts the rays of a view from `direction` (unit, towards the eye) that hit something.
int count_hits(const Scene& scene, const Bounds3& box, Vec3 direction, Backs backs) {
    const Transform view = look_at(direction, {}, {0, 1, 0}); // columns: right, up, back
    const Vec3 size = box.size(), right = column(view, 0), up = column(view, 1);
    const float half_x = 0.5f * dot(abs(right), size), half_y = 0.5f * dot(abs(up), size);
    std::vector<SurveyRay> rays;
    for (int i = 0; i < kViewRays * kViewRays; ++i) {
        const float x = (2 * static_cast<float>(i % kViewRays) + 1) / kViewRays - 1;
        const float y = (2 * static_cast<float>(i / kViewRays) + 1) / kViewRays - 1;
        rays.push_back(
            {box.centre() + length(size) * direction + (x * half_x) * right + (y * half_y) * up, -direction});
    }
    return static_cast<int>(std::ranges::count_if(cast_rays(scene, rays, backs), &SurveyHit::is_hit));
}

/// Viewing direction: a little to the side of +z, the front of glTF models, and above. If hardly anything but culled
/// backs were visible from there, it is the first other direction that shows at least half of the maximum.
Vec3 view_direction(const Scene& scene, const Bounds3& box) {
    const Vec3 size = box.size();
    const float flat = clamp(1 - 4 * size.y / max(size.x, size.z), 0.0f, 1.0f); // NaN, for a point, becomes a bound
    const float above = kAbove + (kAboveFlat - kAbove) * flat;
    const Vec3 front = direction_to_eye(kAside, above);
    uint64_t triangles = 0;
    bool hides_any = false;
    for (const Instance& instance : scene.instances) {
        triangles += scene.meshes[instance.mesh].triangle_count();
        hides_any = hides_any || !scene.materials[instance.material].double_sided;
    }
    if (!hides_any || triangles > kMaxTrianglesSeen) return front;
    if (2 * count_hits(scene, box, front, Backs::Shown) >= count_hits(scene, box, front, Backs::All)) return front;
    std::vector<Vec3> directions;
    std::vector<int> shown;
    for (const float up : {above, -above}) {
        for (const float aside : {kAside, -kAside, 65.0f, -65.0f, 115.0f, -115.0f, 180 - kAside, kAside - 180}) {
            directions.push_back(direction_to_eye(aside, up));
            shown.push_back(count_hits(scene, box, directions.back(), Backs::Shown));
        }
    }
    const int most = std::ranges::max(shown);
    if (most == 0) return front;
    const auto first = std::ranges::find_if(shown, [&](int count) { return 2 * count >= most; });
    return directions[static_cast<std::size_t>(first - shown.begin())];
}

Camera inside(const Scene& scene, const Surroundings& room, float aspect) {
    const Aisle aisle = find_aisle(scene, room);
    const Vec3 eye = aisle.middle - (0.42f * aisle.length) * aisle.along;
    const Vec3 target = aisle.middle + (0.5f * aisle.length) * aisle.along + Vec3{0, 0.12f * aisle.height, 0};
    return camera_at(eye, target, opening(kFovInside, aspect).fov_y, "default, inside");
}

} // namespace

Camera make_default_camera(const Scene& scene, float aspect, Sink& sink) {
    Surroundings around = survey_surroundings(scene);
    if (around.bounds.is_empty()) around.bounds = {{-1, -1, -1}, {1, 1, 1}}; // everything is hidden at rest
    const char* what = "a view from outside";
    Camera camera;
    switch (around.kind) {
    case SurroundingsKind::Object:
        camera = fitted(scene, around.bounds, view_direction(scene, around.bounds), aspect, "default, outside");
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
    sink.make_up(fmt::format("the scene has no camera: {} (`eye={}` `target={}`)", what, position_text(scene, eye, 4),
                             position_text(scene, target, 4)));
    return camera;
}

} // namespace pertev
