// Denoised pictures are smooth where a mirror or glass shows something, and keep its light and its edges.

#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "image/metrics.h"
#include "session/session.h"
#include "tests/support/lit_scenes.h"
#include "tests/support/render_scenes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

constexpr uint32_t kSheetSide = 48, kSheetSamples = 8, kSheetReference = 512;

Material matt(float albedo) {
    Material material;
    material.base_color = {albedo, albedo, albedo};
    return material;
}

/// Adds a square of side 2 `size` in a plane of constant y; it faces -y, or +y if it is turned.
void add_wall(Scene& scene, const Material& material, Vec3 at, Vec3 size, bool is_turned) {
    scene.materials.push_back(material);
    const Transform turn = is_turned ? make_rotation(0, 0, 1, 0) : Transform{};
    Instance instance;
    instance.material = static_cast<uint32_t>(scene.materials.size() - 1);
    instance.world_from_local = compose(make_translation(at), compose(turn, make_scale(size)));
    scene.instances.push_back(instance);
}

/// A sheet between two walls of a white and a dark half. The camera looks at the sheet from between it and one wall, on
/// which there is an emitter.
Scene scene_with(const Material& sheet) {
    Scene scene;
    scene.meshes.push_back(make_square(1));
    for (const float side : {-1.0f, 1.0f}) { // parts of the walls
        add_wall(scene, matt(side < 0 ? 0.8f : 0.1f), {3 * side, -4, 0}, {3, 1, 6}, true);
        add_wall(scene, matt(side < 0 ? 0.2f : 0.7f), {3 * side, 3, 0}, {3, 1, 6}, false);
    }
    Material lamp = matt(0);
    lamp.emission = {6, 5, 4};
    add_wall(scene, lamp, {0.3f, -3.9f, 0.6f}, {0.5f, 1, 0.3f}, true);
    lamp.emission = {30, 30, 30};
    add_wall(scene, lamp, {-2.5f, 2, 2.5f}, {0.2f, 1, 0.2f}, false);
    add_wall(scene, lamp, {2.5f, 2.2f, -2.5f}, {0.2f, 1, 0.2f}, true);
    add_wall(scene, sheet, {0, 0, 0}, {1.2f, 1, 1.2f}, false);
    return scene;
}

Image picture_of_sheet(Queue& queue, const Scene& scene, Denoise denoise, uint32_t samples) {
    Camera camera;
    camera.fov_y = 0.6f;
    camera.world_from_camera = look_at({0.05f, -3, 0.1f}, {0, 0, 0}, {0, 0, 1});
    RenderSettings settings;
    settings.width = settings.height = kSheetSide;
    settings.denoise = denoise;
    settings.path.seed = samples;
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Session session(queue, prepared, camera, settings);
    session.render(samples);
    return denoise == Denoise::None ? session.picture() : session.denoised().value();
}

double error_of_sheet(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) sum += as_double(std::abs(a.pixels[i] - b.pixels[i]));
    return sum / static_cast<double>(a.pixels.size());
}

void check_sheet(const Material& sheet) {
    Queue queue = requested_queue();
    const Scene scene = scene_with(sheet);
    const Image reference = picture_of_sheet(queue, scene, Denoise::None, kSheetReference);
    const Image samples = picture_of_sheet(queue, scene, Denoise::None, kSheetSamples);
    const Image denoised = picture_of_sheet(queue, scene, Denoise::Svgf, kSheetSamples);
    CHECK(error_of_sheet(denoised, reference) < 0.4 * error_of_sheet(samples, reference));
    CHECK(pertev::mean_of(denoised) == doctest::Approx(pertev::mean_of(reference)).epsilon(0.02));
}

} // namespace

TEST_CASE("what a mirror shows is denoised, and emitters in it have no noise") {
    Material mirror;
    mirror.kind = MaterialKind::MetallicRoughness;
    mirror.base_color = {0.9f, 0.8f, 0.7f};
    mirror.metallic = 1;
    mirror.roughness = 0;
    check_sheet(mirror);
}

TEST_CASE("what glass reflects and what it lets through are denoised apart") {
    Material glass;
    glass.kind = MaterialKind::Dielectric;
    glass.base_color = {1, 1, 1};
    glass.ior = 1.5f;
    glass.roughness = 0;
    check_sheet(glass);
}

TEST_CASE("what a smooth coat reflects is denoised apart from the diffuse base") {
    Material plastic;
    plastic.kind = MaterialKind::MetallicRoughness;
    plastic.base_color = {0.3f, 0.1f, 0.1f};
    plastic.metallic = 0;
    plastic.roughness = 0;
    check_sheet(plastic);
}
