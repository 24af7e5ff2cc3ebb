// Near and far lights share samples by their irradiance on surfaces, not by power.

#include <doctest/doctest.h>

#include "image/srgb_table.h"
#include "render/balance_lights.h"

using namespace pertev;

namespace {

/// A box of side 2 about the origin, visible from inside and outside. An open box has no lid.
Mesh make_box(bool is_open) {
    Mesh mesh;
    for (int i = 0; i < 8; ++i) {
        mesh.positions.push_back({i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f});
    }
    mesh.indices = {0, 1, 5, 0, 5, 4, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    if (!is_open) mesh.indices.insert(mesh.indices.end(), {2, 6, 7, 2, 7, 3});
    return mesh;
}

/// A box that contains an emitter of this radiance, under a sky of radiance 1. The camera can be anywhere.
double far_share_of(bool is_open, float emitter_radiance, float scale = 1) {
    Scene scene;
    Mesh emitter = make_box(false);
    for (Vec3& p : emitter.positions) p = 0.1f * scale * p;
    Mesh box = make_box(is_open);
    for (Vec3& p : box.positions) p = scale * p;
    scene.meshes = {box, emitter};
    scene.materials.resize(2);
    scene.materials[1].emission = {emitter_radiance, emitter_radiance, emitter_radiance};
    scene.instances.resize(2);
    scene.instances[1].mesh = scene.instances[1].material = 1;
    scene.environment = Environment{};
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    const LightSetView view = view_of(prepared.lights, nullptr, srgb_decode_table().data());
    return static_cast<double>(cdf_pmf(view.choice, view.environment_source));
}

} // namespace

TEST_CASE("kinds of lights separated by a wall are balanced by the surfaces that they light") {
    // Half of the points are outside the box, where only the sky gives light. The others are inside, with the emitter.
    // Both need enough samples.
    for (const float radiance : {30.0f, 300.0f}) {
        const double share = far_share_of(false, radiance);
        CAPTURE(radiance);
        CHECK(share > 0.1);
        CHECK(share < 0.8);
    }
}

TEST_CASE("the share follows the emitter's power, and neither kind gets none") {
    double last = 1;
    for (const float radiance : {1e-6f, 0.1f, 10.0f, 1e3f, 1e9f}) {
        const double share = far_share_of(true, radiance);
        CAPTURE(radiance);
        CHECK(share <= last);
        CHECK(share > kMinShare * 0.999);
        CHECK(share < 1 - kMinShare * 0.999);
        last = share;
    }
    CHECK(far_share_of(true, 1e-6f) == doctest::Approx(1 - kMinShare));
    CHECK(far_share_of(true, 1e9f) < 0.3);
}

TEST_CASE("the share does not depend on the unit of length") {
    const double metres = far_share_of(true, 10), millimetres = far_share_of(true, 10, 1e-3f);
    CHECK(millimetres == doctest::Approx(metres).epsilon(0.02));
}
