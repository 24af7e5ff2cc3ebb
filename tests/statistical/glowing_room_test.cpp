// In a closed room whose walls emit radiance 1 and have reflectance a, radiance is the same everywhere: 1 + a + ... +
// a^n after at most n scatterings. Thus the depth limit, Russian roulette, next-event estimation to many triangles,
// BSDF sampling and MIS weights have closed forms.

#include <cmath>

#include <doctest/doctest.h>

#include "tests/support/meshes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

Scene allocate(float albedo) {
    const test::TriangleMesh sphere = test::make_sphere(2, {0, 0, 0}, 2.0f);
    Scene scene;
    Mesh mesh;
    mesh.positions = sphere.positions;
    mesh.indices = sphere.indices;
    scene.meshes.push_back(mesh);
    scene.materials.push_back(
        {{.two_sided_emission = true, .base_color = grey(albedo), .emission = {1, 1, 1}}, "wall"});
    scene.instances.push_back({"room", 0, 0, {}});
    return scene;
}

struct Seen {
    double mean, standard_error;
};

RenderResult look_around(const Scene& scene, const PathSettings& path) {
    RenderSettings settings;
    settings.width = settings.height = 24;
    settings.samples = static_cast<uint32_t>(test::effort(64, 4096));
    settings.path = path;
    settings.path.sampler = SamplerKind::Independent;
    Camera camera;
    camera.world_from_camera = look_at({0.3f, 0.2f, -0.5f}, {1, 0.4f, 0.1f}, {0, 1, 0});
    camera.fov_y = 2.0f;
    Queue queue = test::requested_queue();
    RenderResult result = test::render(queue, scene, camera, settings);
    CHECK(result.invalid_samples == 0);
    return result;
}

Seen statistics_of(const Image& picture) {
    double sum = 0, square_sum = 0;
    const double pixels = 24 * 24;
    for (uint32_t i = 0; i < 24 * 24; ++i) {
        const auto value = static_cast<double>(picture.pixels[3 * i]);
        sum += value;
        square_sum += value * value;
    }
    const double mean = sum / pixels;
    return {mean, std::sqrt((square_sum / pixels - mean * mean) / (pixels - 1))};
}

/// Allows four standard errors, which must be under 0.5 %, plus a thousandth, because next-event estimation near edges
/// of the wall has rare, very bright samples.
void check_radiance(double wanted, float albedo, const PathSettings& path) {
    const Seen seen = statistics_of(look_around(allocate(albedo), path).picture);
    CAPTURE(seen.mean);
    CAPTURE(seen.standard_error);
    CAPTURE(wanted);
    CHECK(std::abs(seen.mean - wanted) <= 4 * seen.standard_error + 1e-3 * wanted);
    CHECK(seen.standard_error < 5e-3 * wanted);
}

} // namespace

TEST_CASE("a depth limit of n keeps the first n scatterings, each counted once") {
    for (const LightStrategy strategy : test::kLightStrategies) {
        double wanted = 0;
        for (uint32_t depth = 0; depth <= 4; ++depth) {
            CAPTURE(static_cast<int>(strategy));
            CAPTURE(depth);
            wanted += std::pow(0.5, depth);
            PathSettings path;
            path.max_depth = depth;
            path.roulette_depth = 100;
            path.strategy = strategy;
            check_radiance(wanted, 0.5f, path);
        }
    }
}

TEST_CASE("Russian roulette neither removes nor adds light") {
    for (const LightStrategy strategy : test::kLightStrategies) {
        for (const Roulette roulette : {Roulette::Throughput, Roulette::NearCubeRoot, Roulette::FourthRoot}) {
            CAPTURE(static_cast<int>(strategy));
            CAPTURE(static_cast<int>(roulette));
            PathSettings path;
            path.max_depth = 60;
            path.roulette = roulette;
            path.roulette_depth = 1;
            path.strategy = strategy;
            check_radiance((1 - std::pow(0.7, 61)) / (1 - 0.7), 0.7f, path);
        }
    }
}

TEST_CASE("direct light is emission and one scattering, and indirect light is the rest") {
    PathSettings path;
    path.max_depth = 3;
    path.roulette_depth = 100;
    path.light = PathLight::Direct;
    check_radiance(1.5, 0.5f, path);
    path.light = PathLight::Indirect;
    check_radiance(0.375, 0.5f, path);
}

TEST_CASE("light that mirrors hold without loss counts to the last bounce, by few long paths") {
    Scene scene = allocate(1);
    MaterialParameters& mirror = scene.materials[0];
    mirror.kind = MaterialKind::MetallicRoughness;
    mirror.metallic = 1;
    mirror.roughness = 0;
    PathSettings path;
    path.max_depth = 200;
    const RenderResult result = look_around(scene, path);
    const Seen seen = statistics_of(result.picture);
    CAPTURE(seen.mean);
    CHECK(std::abs(seen.mean - 201) <= 4 * seen.standard_error + 1e-3 * 201);
    CHECK(seen.standard_error < 0.01 * 201);
    CHECK(result.rays.bounce < 125 * result.rays.camera); // 64 and, on average, 46 of the other 136
}
