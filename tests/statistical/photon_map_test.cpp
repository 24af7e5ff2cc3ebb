// Photon mapping against path tracing: what passes leave of blur and noise falls at least as fast as the literature
// says, to a stated bound, and no light is missing or counted twice.

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/support/flat_scenes.h"
#include "tests/support/meshes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

/// A room that is open to the camera: a lamp under its ceiling, and a ball.
Scene room_with_ball(const Material& ball_material, const Material& floor, bool has_sky) {
    Scene scene;
    const Material red = {.name = "red", .base_color = {0.7f, 0.2f, 0.2f}};
    test::add(scene, test::sheet({0, 0, 0}, {0, 0, 1}, {1, 0, 0}), floor);
    test::add(scene, test::sheet({0, 1, -1}, {1, 0, 0}, {0, 1, 0}), test::white(0.6f));
    test::add(scene, test::sheet({-1, 1, 0}, {0, 1, 0}, {0, 0, 1}), red);
    const test::TriangleMesh ball = test::make_sphere(2, {0.1f, 0.6f, 0.1f}, 0.4f);
    Mesh mesh;
    mesh.positions = ball.positions;
    mesh.indices = ball.indices;
    test::add(scene, mesh, ball_material);
    if (has_sky) {
        scene.environment = test::make_mixed_scene().environment;
        return scene;
    }
    test::add(scene, test::sheet({0, 2, 0}, {1, 0, 0}, {0, 0, 1}), test::white(0.6f));
    test::add(scene, test::sheet({-0.1f, 1.9f, 0}, {0.5f, 0, 0}, {0, 0, 0.5f}),
              {.name = "lamp", .base_color = {0.2f, 0.2f, 0.2f}, .emission = {4, 3.5f, 3}});
    return scene;
}

Material of_roughness(MaterialKind kind, float roughness, float metallic = 0) {
    return {
        .name = "ball", .kind = kind, .base_color = {0.9f, 0.8f, 0.7f}, .metallic = metallic, .roughness = roughness};
}

struct PhotonCase {
    std::string name;
    Scene scene;
    double bound = 4e-3; // of the squared error after 256 passes
};

std::vector<PhotonCase> photon_cases() {
    const Material wall = test::white(0.6f);
    const Material plastic = of_roughness(MaterialKind::MetallicRoughness, 0.4f);
    const Material varnished = of_roughness(MaterialKind::MetallicRoughness, 0); // a delta lobe on a diffuse one
    return {{"diffuse", room_with_ball(test::white(0.8f), wall, false)},
            {"glass", room_with_ball(of_roughness(MaterialKind::Dielectric, 0), wall, false)},
            {"glossy", room_with_ball(of_roughness(MaterialKind::MetallicRoughness, 0.3f, 1), plastic, false)},
            {"mirrors under the sky", room_with_ball(of_roughness(MaterialKind::Conductor, 0), varnished, true),
             4e-2}}; // its sun is small
}

Image picture_by(Queue& queue, const PreparedScene& prepared, IntegratorKind integrator, PhotonGather gather,
                 uint32_t samples, uint32_t seed) {
    Camera camera;
    camera.world_from_camera = look_at({0.4f, 1.1f, 3.6f}, {0, 0.9f, 0}, {0, 1, 0});
    camera.fov_y = 0.6f;
    RenderSettings settings;
    settings.width = settings.height = 16;
    settings.filter = PixelFilter::Box;
    settings.path.max_depth = 6;
    settings.path.seed = seed;
    settings.samples = samples;
    settings.integrator = integrator;
    settings.photon_map.photons = 4000;
    settings.photon_map.gather = gather;
    return render_picture(queue, prepared, camera, settings).picture;
}

/// Mean of (a - b)^2 / (b^2 + 0.01).
double rel_mse(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        const auto x = static_cast<double>(a.pixels[i]), y = static_cast<double>(b.pixels[i]);
        sum += (x - y) * (x - y) / (y * y + 0.01);
    }
    return sum / static_cast<double>(a.pixels.size());
}

} // namespace

TEST_CASE("photon mapping comes to path tracing's picture, at least as fast as Knaus and Zwicker say") {
    Queue queue = test::queue_asked_for();
    for (const PhotonCase& c : photon_cases()) {
        Messages messages;
        const PreparedScene prepared = prepare_scene(c.scene, {}, messages);
        const Image reference = picture_by(queue, prepared, IntegratorKind::Path, {}, 8192, 9);
        const double light = test::mean_of(reference);
        for (const PhotonGather gather : {PhotonGather::Direct, PhotonGather::Final}) {
            const auto error_of = [&](uint32_t passes) {
                double sum = 0;
                for (uint32_t seed = 0; seed < 4; ++seed) {
                    sum += rel_mse(picture_by(queue, prepared, IntegratorKind::PhotonMap, gather, passes, seed),
                                   reference);
                }
                return sum / 4;
            };
            const Image last = picture_by(queue, prepared, IntegratorKind::PhotonMap, gather, 256, 77);
            const double few = error_of(4), many = error_of(64), end = rel_mse(last, reference);
            CAPTURE(c.name);
            CAPTURE(static_cast<int>(gather));
            CAPTURE(few);
            CAPTURE(many);
            CAPTURE(end);
            CHECK(many < few * std::pow(16, -2.0 / 3)); // the squared error falls with the passes to the power -2/3
            CHECK(end < c.bound);
            CHECK(test::mean_of(last) == doctest::Approx(light).epsilon(0.01));
        }
    }
}
