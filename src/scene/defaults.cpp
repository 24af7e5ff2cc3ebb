#include "scene/defaults.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/parallel_for.h"
#include "math/portable_math.h"
#include "scene/cast_rays.h"
#include "scene/surroundings.h"

namespace pertev {
namespace {

constexpr uint32_t kSkyWidth = 256, kSkyHeight = 128;
constexpr float kFovOutside = 0.6981317f, kFovInside = 1.1344640f; // 40 and 65 degrees, of the smaller side

bool is_lamp(const Material& material) {
    // What glows by a texture is a display or a badge, not what the rest is to be seen by.
    return material.is_emissive() && material.kind != MaterialKind::Unlit && !material.emission_texture.has_image();
}

bool needs_light(const Scene& scene) {
    if (scene.environment) return false;
    const bool is_lit = std::any_of(scene.lights.begin(), scene.lights.end(),
                                    [](const Light& light) { return max_component(light.intensity) > 0; });
    if (is_lit) return false;
    bool is_all_unlit = true; // what is unlit is seen without light, and gives none to the rest
    for (const Instance& instance : scene.instances) {
        const Material& material = scene.materials[instance.material];
        if (is_lamp(material)) return false;
        is_all_unlit = is_all_unlit && material.kind == MaterialKind::Unlit;
    }
    return !is_all_unlit;
}

/// Radiance from the unit direction d, W/(sr m2).
Rgb sky(Vec3 d) {
    const Rgb zenith = {0.32f, 0.46f, 0.72f}, horizon = {0.84f, 0.89f, 0.95f}, ground = {0.30f, 0.28f, 0.26f};
    const float up = d.y > 0 ? d.y : 0.0f;
    Rgb colour = lerp(horizon, zenith, up * (2 - up));
    // The ground rises into the horizon within a few degrees: a hard edge would show in every mirror.
    if (d.y < 0) colour = lerp(horizon, ground, min(-8 * d.y, 1.0f));
    // A lobe cos^64, in squarings: soft shadows, and few samples find it.
    const Vec3 sun = normalize({-0.45f, 0.72f, 0.53f});
    float lobe = max(dot(d, sun), 0.0f);
    for (int i = 0; i < 6; ++i) lobe = lobe * lobe;
    return colour + (32.0f * lobe) * Rgb{1.0f, 0.92f, 0.78f};
}

Environment make_sky() {
    Environment environment;
    Image& image = environment.image;
    image = {.width = kSkyWidth, .height = kSkyHeight, .channels = 3, .pixels = {}};
    image.pixels.resize(std::size_t(kSkyWidth) * kSkyHeight * 3);
    parallel_for(kSkyHeight, 8, [&](uint64_t y) {
        const float theta = kPi * (static_cast<float>(y) + 0.5f) / static_cast<float>(kSkyHeight);
        for (uint32_t x = 0; x < kSkyWidth; ++x) {
            const float phi = kTwoPi * ((static_cast<float>(x) + 0.5f) / static_cast<float>(kSkyWidth) - 0.5f);
            const Rgb c = sky({sin(theta) * sin(phi), cos(theta), -(sin(theta) * cos(phi))});
            float* pixel = image.at(x, static_cast<uint32_t>(y));
            pixel[0] = c.r, pixel[1] = c.g, pixel[2] = c.b;
        }
    });
    return environment;
}

float distance_along(const Scene& scene, Vec3 from, Vec3 direction, float otherwise) {
    const LookRay ray = {from, direction};
    const LookHit hit = cast_rays(scene, {&ray, 1}).front();
    return hit.is_hit() ? hit.distance : otherwise;
}

/// A room's free axis: how far one can see from a point at a person's height, along the longer of x and z.
struct Aisle {
    Vec3 middle, along; // along: unit; middle: half-way between the ends
    float length = 0, floor = 0, height = 0;
};

Aisle find_aisle(const Scene& scene, const Surroundings& room) {
    const Vec3 size = room.bounds.size();
    const float far = size.x + size.y + size.z;
    Aisle aisle;
    aisle.floor = room.inside.y - distance_along(scene, room.inside, {0, -1, 0}, room.inside.y - room.bounds.lo.y);
    aisle.height = room.bounds.hi.y - aisle.floor;
    // In metres where the room is of a house's size, else in proportion: the unit is unknown.
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

void add_lamps(Scene& scene, const Surroundings& room) {
    const Aisle aisle = find_aisle(scene, room);
    constexpr int count = 5;
    for (int i = 0; i < count; ++i) {
        const float at = ((static_cast<float>(i) + 0.5f) / count - 0.5f) * 0.9f * aisle.length;
        const Vec3 below = aisle.middle + at * aisle.along;
        const float up = distance_along(scene, below, {0, 1, 0}, 0.5f * aisle.height);
        Light lamp;
        lamp.name = fmt::format("default lamp {}", i);
        lamp.position = below + Vec3{0, 0.6f * up, 0};
        // About 1 W/(sr m2) off a white floor below one.
        lamp.intensity = (kPi * square(0.6f * up)) * Rgb{1.0f, 0.93f, 0.82f};
        scene.lights.push_back(std::move(lamp));
    }
}

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
        const Mesh& mesh = scene.meshes[instance.mesh];
        const std::size_t step = 1 + mesh.indices.size() / 20'000;
        for (std::size_t i = 0; i < mesh.indices.size(); i += step) {
            const Vec3 p = transform_point(instance.world_from_local, mesh.positions[mesh.indices[i]]) - centre;
            const float x = abs(dot(p, column(view, 0))), y = abs(dot(p, column(view, 1))), z = dot(p, column(view, 2));
            distance = max(distance, z + max(x / o.half_x, y / o.half_y));
        }
    }
    return look(centre + (1.08f * distance) * direction, centre, o.fov_y, name);
}

Camera inside(const Scene& scene, const Surroundings& room, float aspect) {
    const Aisle aisle = find_aisle(scene, room);
    const Vec3 eye = aisle.middle - (0.42f * aisle.length) * aisle.along;
    const Vec3 target = aisle.middle + (0.5f * aisle.length) * aisle.along + Vec3{0, 0.12f * aisle.height, 0};
    return look(eye, target, opening(kFovInside, aspect).fov_y, "default, inside");
}

} // namespace

void add_default_environment(Scene& scene, Messages& messages) {
    if (!needs_light(scene)) return;
    const Surroundings around = look_around(scene);
    if (around.is_dark) {
        add_lamps(scene, around);
        messages.note("no light in the scene, a closed room: it gets a row of lamps");
        return;
    }
    scene.environment = make_sky();
    messages.note("no light in the scene: it gets a sky");
}

Camera make_default_camera(const Scene& scene, float aspect, Messages& messages) {
    const Surroundings around = look_around(scene);
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
    messages.note(fmt::format("no camera in the scene: {} (--eye {:.4g},{:.4g},{:.4g} --target {:.4g},{:.4g},{:.4g})",
                              what, eye.x, eye.y, eye.z, target.x, target.y, target.z));
    return camera;
}

} // namespace pertev
