#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "base/sink.h"
#include "base/version.h"
#include "formats/builtin_scenes.h"
#include "formats/read_scene.h"

using namespace pertev;

namespace {

const Instance& instance_named(const Scene& scene, const std::string& name) {
    const auto found = std::ranges::find(scene.instances, name, &Instance::name);
    REQUIRE(found != scene.instances.end());
    return *found;
}

} // namespace

TEST_CASE("the built-in Cornell box is complete") {
    const auto bytes = builtin_scene("cornell-box");
    REQUIRE(bytes);
    const std::string text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
    CHECK(text.starts_with("{"));
    CHECK(text.ends_with("}\n"));
    CHECK(text.find("\"KHR_materials_emissive_strength\"") != std::string::npos);
    CHECK(std::ranges::count(builtin_scene_names(), "cornell-box") == 1);
}

TEST_CASE("the Cornell box is read without a warning, and its surfaces are Lambertian") {
    Messages messages;
    const Scene scene = read_scene("cornell-box", {}, messages);
    CHECK(messages.all().empty());
    CHECK(scene.instances.size() == 8);
    for (const Material& material : scene.materials) CHECK(material.kind == MaterialKind::Diffuse);
    uint32_t triangles = 0;
    for (const Instance& instance : scene.instances) triangles += scene.meshes[instance.mesh].triangle_count();
    CHECK(triangles == 5 * 2 + 8 + 2 * 10);
    const Material& light = scene.materials[instance_named(scene, "light").material];
    CHECK(light.is_emissive());
    CHECK(light.emission.r > light.emission.g);
    CHECK(light.emission.g > light.emission.b); // the emitter is warm white
}

TEST_CASE("in the Cornell box the red wall is on the camera's left and the green one on its right") {
    Messages messages;
    const Scene scene = read_scene("cornell-box", {}, messages);
    REQUIRE(scene.cameras.size() == 1);
    const Camera& camera = scene.cameras[0];
    CHECK(camera.fov_y == doctest::Approx(2 * std::atan(12.5 / 35)));
    const Vec3 right = column(camera.world_from_camera, 0), forward = -column(camera.world_from_camera, 2);
    const auto centre = [&](const char* name) {
        const Bounds3 box = bounds_of(scene.meshes[instance_named(scene, name).mesh]);
        return 0.5f * (box.lo + box.hi) - camera.world_from_camera.translation;
    };
    const auto color = [&](const char* name) {
        return scene.materials[instance_named(scene, name).material].base_color;
    };
    CHECK(dot(right, centre("left wall")) < 0);
    CHECK(color("left wall").r > 5 * color("left wall").g);
    CHECK(dot(right, centre("right wall")) > 0);
    CHECK(color("right wall").g > 5 * color("right wall").r);
    CHECK(dot(forward, centre("back wall")) > dot(forward, centre("tall block")));
    CHECK(dot(forward, centre("short block")) > 0);
}

TEST_CASE("the scenes with narrow light are built in with their materials") {
    for (const char* name : {"blind", "caustic", "cove", "door", "uplight"}) {
        CAPTURE(name);
        REQUIRE(builtin_materials(name));
        Messages messages;
        const Scene scene = read_scene(name, {}, messages);
        CHECK(messages.all().empty());
        CHECK(scene.materials[instance_named(scene, "lamp").material].emission.r == 60);
    }
    Messages messages;
    const Scene caustic = read_scene("caustic", {}, messages);
    const Material& glass = caustic.materials[instance_named(caustic, "glass").material];
    CHECK(glass.kind == MaterialKind::Dielectric);
    CHECK(glass.ior == 1.5f);
    CHECK_FALSE(builtin_materials("cornell-box"));
    CHECK_FALSE(builtin_materials("caustics"));
}

TEST_CASE("an unknown name of a built-in scene is not found") {
    CHECK_FALSE(builtin_scene("cornell"));
    CHECK_FALSE(builtin_scene(""));
}

TEST_CASE("the version has three numbers") {
    const std::string text = version();
    CHECK(std::ranges::count(text, '.') == 2);
    CHECK(text.find_first_not_of("0123456789.") == std::string::npos);
    const std::string commit = git_commit();
    CHECK((commit == "unknown" ||
           (commit.size() >= 12 && commit.find_first_not_of("0123456789abcdef+") == std::string::npos)));
}
