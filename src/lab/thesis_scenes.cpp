#include "lab/thesis_scenes.h"

#include <algorithm>
#include <string_view>

#include "base/error.h"
#include "formats/read_scene.h"
#include "lab/record_scenes.h"
#include "math/portable_math.h"
#include "session/opening/choose_camera.h"

namespace pertev {
namespace {

uint32_t instance_named(const Scene& scene, std::string_view name) {
    const auto found = std::ranges::find(scene.instances, name, &Instance::name);
    PERTEV_CHECK(found != scene.instances.end());
    return static_cast<uint32_t>(found - scene.instances.begin());
}

Bounds3 bounds_of(const Scene& scene, const Instance& instance) {
    Bounds3 bounds;
    for (const Vec3 p : scene.meshes[instance.mesh].positions) {
        bounds.extend(transform_point(instance.world_from_local, p));
    }
    return bounds;
}

/// Replaces the emitter by a point light in its middle, a centimetre below it, with the intensity that the emitter has
/// straight down: its radiance times its area.
void replace_emitter(Scene& scene) {
    const uint32_t emitter = instance_named(scene, "light");
    const Bounds3 bounds = bounds_of(scene, scene.instances[emitter]);
    const Vec3 size = bounds.size();
    Light light;
    light.name = "point";
    light.position = bounds.centre() - Vec3{0, 0.01f, 0};
    light.intensity = (size.x * size.z) * scene.materials[scene.instances[emitter].material].emission;
    scene.lights.push_back(light);
    scene.instances[emitter].is_hidden = true;
}

/// Makes a ball by longitude and latitude, with `down` rings of twice as many quads, and smooth normals.
Mesh make_ball(Vec3 centre, float radius, uint32_t down) {
    const uint32_t around = 2 * down;
    const auto number = [](uint32_t i) { return static_cast<float>(i); };
    Mesh ball;
    for (uint32_t j = 0; j <= down; ++j) {
        for (uint32_t i = 0; i < around; ++i) {
            const float theta = kPi * number(j) / number(down), phi = 2 * kPi * number(i) / number(around);
            const Vec3 normal = {sin(theta) * cos(phi), cos(theta), sin(theta) * sin(phi)};
            ball.normals.push_back(normalize(normal));
            ball.positions.push_back(centre + radius * normal);
        }
    }
    for (uint32_t j = 0; j < down; ++j) {
        for (uint32_t i = 0; i < around; ++i) {
            const uint32_t a = j * around + i, b = j * around + (i + 1) % around, c = a + around, d = b + around;
            if (j > 0) ball.indices.insert(ball.indices.end(), {a, b, c});
            if (j + 1 < down) ball.indices.insert(ball.indices.end(), {b, d, c});
        }
    }
    return ball;
}

/// Replaces a block by a ball of `material` at its position.
void replace_block(Scene& scene, std::string_view block, Material material, uint32_t rings) {
    Instance& instance = scene.instances[instance_named(scene, block)];
    const Bounds3 bounds = bounds_of(scene, instance);
    const float radius = 0.1f; // metres
    const Vec3 middle = bounds.centre();
    instance.mesh = static_cast<uint32_t>(scene.meshes.size());
    instance.material = static_cast<uint32_t>(scene.materials.size());
    instance.name = material.name;
    instance.world_from_local = instance.node_from_local = {};
    instance.node = kNoNode;
    scene.meshes.push_back(make_ball({middle.x, bounds.lo.y + radius, middle.z}, radius, rings));
    scene.meshes.back().name = material.name;
    scene.materials.push_back(std::move(material));
}

Material material_of(const char* name, MaterialKind kind, Rgb color, float metallic, float roughness) {
    Material material;
    material.name = name;
    material.kind = kind;
    material.base_color = color;
    material.metallic = metallic;
    material.roughness = roughness;
    return material;
}

Material mirror() { return material_of("mirror sphere", MaterialKind::MetallicRoughness, {0.95f, 0.95f, 0.95f}, 1, 0); }
Material glass() { return material_of("glass sphere", MaterialKind::Dielectric, {1, 1, 1}, 0, 0); }
Material plastic() {
    return material_of("plastic sphere", MaterialKind::MetallicRoughness, {0.15f, 0.3f, 0.65f}, 0, 0.35f);
}

constexpr uint32_t kSmoothRings = 48, kCoarseRings = 10;

} // namespace

Scene make_thesis_scene(ThesisScene which) {
    Scene scene = read_scene(which == ThesisScene::Caustic ? "caustic" : "cornell-box", {}, nobody());
    using enum ThesisScene;
    const auto is_one_of = [which](auto... scenes) { return ((which == scenes) || ...); };
    if (is_one_of(PointLight, PlasticBall, TwoBalls)) replace_emitter(scene);
    if (is_one_of(PlasticBall, TwoBalls))
        scene.lights.back().position.z = 0.06f; // so that the camera sees lit surfaces
    if (is_one_of(MirrorBall, TwoBalls)) replace_block(scene, "short block", mirror(), kSmoothRings);
    if (is_one_of(PlasticBall)) replace_block(scene, "short block", plastic(), kCoarseRings);
    if (is_one_of(TwoBalls)) replace_block(scene, "tall block", glass(), kSmoothRings);
    return scene;
}

Camera camera_of(ThesisScene which, const Scene& scene, float aspect) {
    const bool is_preset = which == ThesisScene::Caustic;
    return choose_camera(is_preset ? camera_choice(*find_named(the_record().presets, "caustic")) : CameraChoice{},
                         scene, aspect, nobody());
}

const char* command_of(ThesisScene which) {
    if (which == ThesisScene::Box) return "cornell-box";
    return which == ThesisScene::Caustic ? "caustic `eye=0.5,1.6,2.6` `target=0,0.5,0` `fov=50`" : "";
}

} // namespace pertev
