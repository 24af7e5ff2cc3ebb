#include "lab/thesis_pictures.h"

#include <algorithm>

#include "base/error.h"
#include "formats/read_scene.h"
#include "image/tone_map_image.h"
#include "math/portable_math.h"
#include "session/choose_camera.h"
#include "session/settings_text.h"

namespace pertev {
namespace {

struct Figure {
    const char* number;
    const char* title;
    const char* integrator;
    float stops; // of exposure
};
constexpr Figure kFigures[] = {
    {"3.3", "hard shadows: a point light in the lamp's place", "cast", 2},
    {"3.4", "soft shadows: the lamp itself", "distributed", 2},
    {"3.6", "indirect light alone", "indirect", 2},
    {"3.8", "the Cornell box with a mirror sphere", "path", 2},
};

const Figure& figure_of(std::string_view number) {
    const auto figure = std::ranges::find(kFigures, number, &Figure::number);
    PERTEV_CHECK(figure != std::end(kFigures));
    return *figure;
}

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

/// A light without size in the middle of the lamp, a centimetre below it, of the intensity that the lamp has straight
/// down: its radiance times its area.
void replace_lamp(Scene& scene) {
    const uint32_t lamp = instance_named(scene, "light");
    const Bounds3 bounds = bounds_of(scene, scene.instances[lamp]);
    const Vec3 size = bounds.size();
    Light light;
    light.name = "point";
    light.position = bounds.centre() - Vec3{0, 0.01f, 0};
    light.intensity = (size.x * size.z) * scene.materials[scene.instances[lamp].material].emission;
    scene.lights.push_back(light);
    scene.instances[lamp].is_hidden = true;
}

/// Longitude by latitude, with smooth normals.
Mesh make_ball(Vec3 centre, float radius) {
    constexpr uint32_t kAround = 96, kDown = 48;
    Mesh ball;
    ball.name = "mirror sphere";
    for (uint32_t j = 0; j <= kDown; ++j) {
        for (uint32_t i = 0; i < kAround; ++i) {
            const float down = kPi * static_cast<float>(j) / kDown, around = 2 * kPi * static_cast<float>(i) / kAround;
            const Vec3 normal = {sin(down) * cos(around), cos(down), sin(down) * sin(around)};
            ball.normals.push_back(normalize(normal));
            ball.positions.push_back(centre + radius * normal);
        }
    }
    for (uint32_t j = 0; j < kDown; ++j) {
        for (uint32_t i = 0; i < kAround; ++i) {
            const uint32_t a = j * kAround + i, b = j * kAround + (i + 1) % kAround, c = a + kAround, d = b + kAround;
            if (j > 0) ball.indices.insert(ball.indices.end(), {a, b, c});
            if (j + 1 < kDown) ball.indices.insert(ball.indices.end(), {b, d, c});
        }
    }
    return ball;
}

/// A ball that stands where the short block stood.
void replace_block(Scene& scene) {
    Instance& block = scene.instances[instance_named(scene, "short block")];
    const Bounds3 bounds = bounds_of(scene, block);
    const float radius = 0.1f; // metres
    const Vec3 middle = bounds.centre();
    block.mesh = static_cast<uint32_t>(scene.meshes.size());
    block.material = static_cast<uint32_t>(scene.materials.size());
    block.name = "mirror sphere";
    block.world_from_local = block.node_from_local = {};
    block.node = kNoNode;
    scene.meshes.push_back(make_ball({middle.x, bounds.lo.y + radius, middle.z}, radius));
    Material mirror;
    mirror.name = "mirror";
    mirror.kind = MaterialKind::MetallicRoughness;
    mirror.base_color = {0.95f, 0.95f, 0.95f};
    mirror.metallic = 1;
    mirror.roughness = 0;
    scene.materials.push_back(mirror);
}

} // namespace

Scene thesis_scene(std::string_view number) {
    Messages messages;
    Scene scene = read_scene("cornell-box", {}, messages);
    if (number == "3.3") replace_lamp(scene);
    if (number == "3.8") replace_block(scene);
    return scene;
}

ThesisPicture render_thesis_picture(Queue& queue, const char* number, const RenderSettings& settings,
                                    const std::function<bool(const RenderProgress&)>& keep_going) {
    const Figure& figure = figure_of(number);
    const Scene scene = thesis_scene(number);
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    const float aspect = static_cast<float>(settings.width) / static_cast<float>(settings.height);
    const Camera camera = choose_camera({}, scene, aspect, messages);
    RenderSettings of_figure = settings;
    set_integrator(of_figure, figure.integrator);
    of_figure.path.max_depth = std::min(of_figure.path.max_depth, most_depth(of_figure.integrator));
    const RenderResult result = render_picture(queue, prepared, camera, of_figure, keep_going);
    return {.number = figure.number,
            .title = figure.title,
            .integrator = figure.integrator,
            .image = tone_map_image(result.picture, ToneMap::Agx, figure.stops),
            .stats = result,
            .interrupted = result.samples < settings.samples};
}

} // namespace pertev
