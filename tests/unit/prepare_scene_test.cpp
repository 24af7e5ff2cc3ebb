#include <doctest/doctest.h>

#include "render/prepare_scene.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

std::size_t warnings_for_glass(float ior, float roughness) {
    Scene scene = test::make_furnace_scene(1);
    scene.materials[0].kind = MaterialKind::Dielectric;
    scene.materials[0].ior = ior;
    scene.materials[0].roughness = roughness;
    Messages messages;
    prepare_scene(scene, {}, messages);
    return messages.all().size();
}

} // namespace

TEST_CASE("rough glass whose index is rendered as another is a warning") {
    CHECK(warnings_for_glass(1.05f, 0.3f) == 1);
    CHECK(warnings_for_glass(4, 0.3f) == 1);
    CHECK(warnings_for_glass(1.5f, 0.3f) == 0);
    CHECK(warnings_for_glass(1, 0.3f) == 0);
    CHECK(warnings_for_glass(1.05f, 0) == 0); // smooth glass takes any
}
