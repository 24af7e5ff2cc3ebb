#include "tests/support/render_scenes.h"

#include "image/picture_hash.h"
#include "tests/support/meshes.h"
#include "tests/support/options.h"

namespace pertev::test {
namespace {

Mesh sphere_mesh(int subdivisions) {
    const TriangleMesh triangles = make_sphere(subdivisions, {0, 0, 0}, 1.0f);
    Mesh mesh;
    mesh.name = "sphere";
    mesh.positions = triangles.positions;
    mesh.indices = triangles.indices;
    for (const Vec3 p : mesh.positions) mesh.normals.push_back(normalize(p));
    return mesh;
}

/// The square [-1, 1]^2 in x and z, facing +y, texture coordinates over the unit square.
Mesh square_mesh() {
    Mesh mesh;
    mesh.name = "square";
    mesh.positions = {{-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}};
    mesh.uv[0] = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    return mesh;
}

/// Returns eight by eight texels of two colours and two alphas.
TextureImage checker_image() {
    TextureImage image;
    image.name = "checker";
    image.rgba8 = {8, 8, {}};
    for (uint32_t i = 0; i < 64; ++i) {
        const bool odd = ((i + i / 8) & 1) != 0;
        const uint8_t texel[4] = {odd ? uint8_t(220) : uint8_t(60), odd ? uint8_t(90) : uint8_t(160), 110,
                                  odd ? uint8_t(255) : uint8_t(40)};
        image.rgba8.pixels.insert(image.rgba8.pixels.end(), texel, texel + 4);
    }
    return image;
}

Environment sky() {
    Environment environment;
    environment.image = {32, 16, 3, {}};
    for (uint32_t y = 0; y < 16; ++y) {
        for (uint32_t x = 0; x < 32; ++x) {
            const float sun = (x == 20 && y == 4) ? 40.0f : 0.0f;
            const float blue = y < 8 ? 0.5f : 0.1f;
            for (const float c : {0.6f * blue + sun, 0.8f * blue + sun, blue + 0.8f * sun}) {
                environment.image.pixels.push_back(c);
            }
        }
    }
    return environment;
}

uint32_t add(Scene& scene, const Material& material) {
    scene.materials.push_back(material);
    return static_cast<uint32_t>(scene.materials.size() - 1);
}

void place(Scene& scene, uint32_t mesh, uint32_t material, Vec3 at, Vec3 scale) {
    scene.instances.push_back({"", mesh, material, compose(make_translation(at), make_scale(scale))});
}

/// An upright sheet of `mesh` that faces the camera.
void stand(Scene& scene, uint32_t mesh, uint32_t material, Vec3 at, float size) {
    const float half = 0.70710678f; // rotates by a quarter turn about x
    scene.instances.push_back(
        {"", mesh, material,
         compose(make_translation(at), compose(make_rotation(half, 0, 0, half), make_scale({size, size, size})))});
}

} // namespace

Scene make_mixed_scene() {
    Scene scene;
    scene.bakes_small_meshes = false; // so that there are instances
    scene.images.push_back(checker_image());
    for (int i = 0; i < 3; ++i) scene.meshes.push_back(i == 0 ? sphere_mesh(3) : square_mesh());
    scene.meshes.push_back(sphere_mesh(2)); // used once and thus baked, unlike the two squares
    scene.meshes.push_back(square_mesh());

    TextureRef checker{.image = 0, .is_srgb = true, .m00 = 3, .m11 = 3};
    const uint32_t floor = add(scene, {{.base_color = {1, 1, 1}, .base_color_texture = checker}, "floor"});
    const uint32_t red = add(scene, {{.base_color = {0.7f, 0.2f, 0.15f}}, "red"});
    const uint32_t gold = add(scene, {{.kind = MaterialKind::Conductor, .roughness = 0.3f}, "gold"});
    const uint32_t glass =
        add(scene, {{.kind = MaterialKind::Dielectric, .base_color = {1, 1, 1}, .roughness = 0}, "glass"});
    const uint32_t plastic =
        add(scene, {{.kind = MaterialKind::MetallicRoughness, .base_color = {0.2f, 0.4f, 0.8f}, .roughness = 0.4f},
                    "plastic"});
    const uint32_t emitter = add(scene, {{.base_color = {0, 0, 0}, .emission = {6, 5, 4}}, "lamp"});
    checker.m00 = checker.m11 = 1;
    const uint32_t mask = add(scene, {{.alpha_mode = AlphaMode::Mask, .base_color_texture = checker}, "mask"});
    const uint32_t blend =
        add(scene, {{.alpha_mode = AlphaMode::Blend, .alpha = 0.5f, .base_color = {0.9f, 0.9f, 0.3f}}, "blend"});

    const uint32_t turned = add(scene, {{.double_sided = false, .base_color = {0.2f, 0.8f, 0.2f}}, "turned"});

    place(scene, 1, floor, {0, 0, 0}, {5, 1, 5});
    place(scene, 0, red, {-2.2f, 1, -1}, {1, 1, 1});
    place(scene, 0, gold, {0, 0.9f, -1.5f}, {0.9f, 0.9f, 0.9f});
    place(scene, 0, glass, {1, 0.6f, 0.6f}, {0.6f, 0.6f, 0.6f});
    place(scene, 3, plastic, {2.2f, 0.8f, -0.8f}, {0.8f, 0.8f, 0.8f});
    place(scene, 1, emitter, {-0.5f, 4, -0.5f}, {0.6f, -1, 0.6f});
    stand(scene, 2, mask, {-1, 0.9f, 1}, 0.8f);
    stand(scene, 4, blend, {2.4f, 0.7f, 1.2f}, 0.5f);
    stand(scene, 1, turned, {0.2f, 0.5f, 2}, -0.4f); // mirrored, so that its front faces away from the camera

    scene.lights.push_back({.name = "point",
                            .kind = LightKind::Point,
                            .position = {-3, 2.5f, 2},
                            .direction = {0, -1, 0},
                            .intensity = {5, 6, 8}});
    scene.lights.push_back({.name = "spot",
                            .kind = LightKind::Spot,
                            .position = {3, 4, 2},
                            .direction = normalize(Vec3{-3, -4, -3}),
                            .intensity = {30, 20, 10},
                            .cos_inner = 0.97f,
                            .cos_outer = 0.9f});
    scene.lights.push_back({.name = "sun",
                            .kind = LightKind::Directional,
                            .position = {},
                            .direction = normalize(Vec3{1, -2, -1}),
                            .intensity = {0.6f, 0.6f, 0.5f}});
    scene.environment = sky();
    return scene;
}

Camera mixed_scene_camera() {
    Camera camera;
    camera.world_from_camera = look_at({0.3f, 2.2f, 6}, {0, 0.9f, 0}, {0, 1, 0});
    camera.fov_y = 0.7f;
    return camera;
}

Scene make_furnace_scene(float albedo) {
    Scene scene;
    scene.meshes.push_back(sphere_mesh(3));
    scene.materials.push_back({{.base_color = grey(albedo)}, "grey"});
    scene.instances.push_back({"sphere", 0, 0, {}});
    scene.environment = Environment{};
    return scene;
}

Queue make_cuda_queue() { return Queue::make_cuda(0); }
Queue requested_queue() { return cuda_requested() ? make_cuda_queue() : Queue::make_cpu(); }

RenderResult render(Queue& queue, const Scene& scene, const Camera& camera, const RenderSettings& settings,
                    const PrepareOptions& prepare) {
    Messages messages;
    return render_picture(queue, prepare_scene(scene, prepare, messages), camera, settings);
}

RenderSettings square_settings(uint32_t size, uint32_t samples, uint32_t max_depth) {
    RenderSettings settings;
    settings.width = settings.height = size;
    settings.samples = samples;
    settings.path.max_depth = max_depth;
    settings.path.roulette_depth = 1000;
    return settings;
}

RenderSettings layered_settings() {
    RenderSettings settings;
    settings.width = 24, settings.height = 16;
    settings.samples = 2;
    settings.path.max_depth = 4;
    settings.aovs = kAovNormal | kAovDepth | kAovIds;
    return settings;
}

void add_picture(Hasher& hasher, const RenderResult& result) {
    hasher.add_value(picture_hash(result.picture).high);
    hasher.add_value(picture_hash(result.picture).low);
    for (const FilmLayer& layer : result.layers) {
        hasher.add_values(std::span<const char>(layer.name));
        hasher.add_values(std::span<const float>(layer.image.pixels));
    }
    for (const PixelIds& ids : result.ids) {
        for (const uint32_t id : {ids.instance, ids.primitive, ids.material}) hasher.add_value(id);
    }
}

double mean_of(const Image& picture) {
    double sum = 0;
    for (const float value : picture.pixels) sum += static_cast<double>(value);
    return sum / static_cast<double>(picture.pixels.size());
}

Hash128 render_hash(const RenderResult& result) {
    Hasher hasher;
    add_picture(hasher, result);
    return hasher.result();
}

} // namespace pertev::test
