#include "session/survey/ground.h"

#include "math/portable_math.h"
#include "session/survey/made_up_sky.h"

namespace pertev {
namespace {

constexpr uint32_t kSpokes = 64;
constexpr int kFadingRings = 12;
constexpr float kShadowOfHeight = 1.5f; // the key light is 39 degrees high
constexpr float kRim = 2.4f;            // radius of the disc relative to its opaque part
constexpr float kGap = 0x1p-11f;        // fraction of the object's size, so that a face on the ground does not
                                        // coincide with it

/// Makes rings of vertices around the middle; the first one bounds the opaque part.
Mesh make_disc(float opaque_radius) {
    Mesh mesh;
    mesh.name = "ground";
    mesh.positions.push_back({0, 0, 0});
    mesh.colors.push_back({1, 1, 1, 1});
    for (int ring = 0; ring <= kFadingRings; ++ring) {
        const float t = static_cast<float>(ring) / kFadingRings;
        const float radius = opaque_radius * (1 + (kRim - 1) * t), alpha = 1 - t * t * (3 - 2 * t);
        for (uint32_t k = 0; k < kSpokes; ++k) {
            const float angle = kTwoPi * static_cast<float>(k) / kSpokes;
            mesh.positions.push_back({radius * cos(angle), 0, -(radius * sin(angle))}); // counter-clockwise from above
            mesh.colors.push_back({1, 1, 1, alpha});
        }
    }
    for (uint32_t k = 0; k < kSpokes; ++k) {
        const uint32_t next = (k + 1) % kSpokes;
        mesh.indices.insert(mesh.indices.end(), {0, 1 + k, 1 + next});
        for (uint32_t ring = 0; ring < kFadingRings; ++ring) {
            const uint32_t inner = 1 + ring * kSpokes, outer = inner + kSpokes;
            mesh.indices.insert(mesh.indices.end(), {inner + k, outer + k, outer + next});
            mesh.indices.insert(mesh.indices.end(), {inner + k, outer + next, inner + next});
        }
    }
    mesh.normals.assign(mesh.positions.size(), {0, 1, 0});
    return mesh;
}

Material make_material() {
    Material material;
    material.name = "ground";
    material.base_color = {kStudioFloor.r / kStudioWhite.r, kStudioFloor.g / kStudioWhite.g,
                           kStudioFloor.b / kStudioWhite.b};
    material.alpha_mode = AlphaMode::Blend;
    material.double_sided = false;
    return material;
}

} // namespace

void add_ground(Scene& scene) {
    const Bounds3 box = bounds_of(scene);
    if (box.is_empty()) return;
    const Vec3 size = box.size(), centre = box.centre();
    const float reach = 0.5f * sqrt(size.x * size.x + size.z * size.z) + kShadowOfHeight * size.y;
    if (!(reach > 0)) return;
    Instance ground;
    ground.name = "ground";
    ground.mesh = static_cast<uint32_t>(scene.meshes.size());
    ground.material = static_cast<uint32_t>(scene.materials.size());
    ground.world_from_local = make_translation({centre.x, box.lo.y - kGap * max_component(size), centre.z});
    ground.is_background = true;
    scene.meshes.push_back(make_disc(reach));
    scene.materials.push_back(make_material());
    scene.instances.push_back(std::move(ground));
}

bool has_ground(const Scene& scene) { return !scene.instances.empty() && scene.instances.back().is_background; }

} // namespace pertev
