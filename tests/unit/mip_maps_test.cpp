// Levels of mip-maps are means of linear values, and pictures with them have the light of those without, less noise,
// and the bytes of those without where nothing is coarser than the picture.

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include "device_scene/halve_texture.h"
#include "device_scene/mip_map_levels.h"
#include "image/picture_hash.h"
#include "image/srgb_table.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/render_scenes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

TextureImage random_image(uint32_t width, uint32_t height, bool has_floats) {
    TextureImage image;
    std::mt19937 random(width * 31 + height);
    const std::size_t count = std::size_t(4) * width * height;
    if (has_floats) {
        image.rgba_float = {width, height, 4, std::vector<float>(count)};
        for (float& value : image.rgba_float.pixels) value = static_cast<float>(random() % 1000) / 300.0f;
    } else {
        image.rgba8 = {width, height, std::vector<uint8_t>(count)};
        for (uint8_t& value : image.rgba8.pixels) value = static_cast<uint8_t>(random());
    }
    return image;
}

double component_of(Vec4 texel, uint32_t c) { return static_cast<double>(channel_of(texel, c)); }

/// Mean of a channel over an area of an image, by small steps.
double mean_over(const TextureImageView& image, bool is_srgb, double x0, double x1, double y0, double y1, uint32_t c) {
    double sum = 0, weights = 0;
    for (uint32_t y = 0; y < image.height; ++y) {
        for (uint32_t x = 0; x < image.width; ++x) {
            const double wide = std::min(x1, x + 1.0) - std::max(x0, double(x)),
                         high = std::min(y1, y + 1.0) - std::max(y0, double(y));
            if (wide <= 0 || high <= 0) continue;
            const Vec4 texel = load_texel(image, x, y, is_srgb, srgb_decode_table().data());
            const double weight = wide * high * (is_srgb && c < 3 ? component_of(texel, 3) : 1);
            sum += weight * component_of(texel, c);
            weights += weight;
        }
    }
    return weights > 0 ? sum / weights : 0;
}

/// A checker of texels, black and white, on an unlit floor of 2 x 2 metres, and a camera that shows it.
struct Checker {
    Scene scene;
    Camera camera = camera_down({0, 4, 0}, 2);

    explicit Checker(uint32_t side = 256) {
        TextureImage image;
        image.rgba8 = {side, side, std::vector<uint8_t>(std::size_t(4) * side * side, 255)};
        for (uint32_t i = 0; i < side * side; ++i) {
            if ((i / side + i % side) % 2 == 0) std::fill_n(image.rgba8.pixels.begin() + 4 * i, 3, uint8_t(0));
        }
        scene.images.push_back(image);
        Material material = white();
        material.kind = MaterialKind::Unlit;
        material.base_color_texture.image = 0;
        material.base_color_texture.filter = TextureFilter::Nearest;
        Mesh mesh = floor_at(0, 1);
        mesh.uv[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
        add(scene, mesh, material);
    }
};

RenderSettings settings_with(MipMaps mip_maps, uint32_t side = 16) {
    RenderSettings settings;
    settings.width = settings.height = side;
    settings.samples = 1;
    settings.filter = PixelFilter::Box;
    settings.path.mip_maps = mip_maps;
    return settings;
}

RenderResult render_with(const Scene& scene, const Camera& camera, const RenderSettings& settings) {
    Queue queue = requested_queue();
    return render(queue, scene, camera, settings);
}

double variance_of(const Image& picture) {
    const double mean = test::mean_of(picture);
    double sum = 0;
    for (const float value : picture.pixels) sum += std::pow(static_cast<double>(value) - mean, 2);
    return sum / static_cast<double>(picture.pixels.size());
}

} // namespace

TEST_CASE("mip-map: a texel of a level is the mean of its area, and colours count by their alpha") {
    for (const auto& [width, height] : {std::pair(8u, 8u), {5u, 3u}, {7u, 1u}, {1u, 6u}, {1u, 1u}, {33u, 18u}}) {
        for (const bool has_floats : {false, true}) {
            for (const bool is_srgb : {false, true}) {
                if (has_floats && is_srgb) continue;
                const TextureImage image = random_image(width, height, has_floats);
                Queue queue = Queue::make_cpu();
                const MipMapLevels made(queue, {view_of(image)}, {is_srgb}, srgb_decode_table().data());
                const TextureImageView* views = made.images();
                TextureImageView from = views[0];
                CHECK(from.coarser_levels == static_cast<uint32_t>(std::log2(std::max(width, height))));
                for (uint32_t k = 0; k < views[0].coarser_levels; ++k) {
                    const TextureImageView& level = views[views[0].first_coarser + k];
                    REQUIRE(level.width == std::max(from.width / 2, 1u));
                    REQUIRE(level.height == std::max(from.height / 2, 1u));
                    const double x = double(from.width) / level.width, y = double(from.height) / level.height;
                    double error = 0;
                    for (uint32_t i = 0; i < level.width * level.height; ++i) {
                        const uint32_t at_x = i % level.width, at_y = i / level.width;
                        const Vec4 texel = load_texel(level, at_x, at_y, is_srgb, srgb_decode_table().data());
                        for (uint32_t c = 0; c < 4; ++c) {
                            const double mean =
                                mean_over(from, is_srgb, at_x * x, (at_x + 1) * x, at_y * y, (at_y + 1) * y, c);
                            error = std::max(error, std::abs(component_of(texel, c) - mean));
                        }
                    }
                    CHECK(error < (has_floats ? 1e-5 : is_srgb ? 0.005 : 0.51 / 255)); // a byte's step
                    from = level;
                }
            }
        }
    }
}

TEST_CASE("mip-map: a level is half the logarithm of the footprint's texels, and lookups between levels are mixed") {
    for (int k = 0; k < 20; ++k) CHECK(mip_level(static_cast<float>(std::ldexp(1.0, 2 * k))) == static_cast<float>(k));
    for (float area = 1; area < 1e6f; area *= 1.1f) {
        CHECK(std::abs(static_cast<double>(mip_level(area)) - 0.5 * std::log2(static_cast<double>(area))) < 0.05);
    }
    for (const float none : {0.0f, 1.0f, 0.1f, -4.0f, std::numeric_limits<float>::quiet_NaN()})
        CHECK(mip_level(none) == 0);

    const TextureImage image = random_image(16, 4, false);
    Queue queue = Queue::make_cpu();
    const MipMapLevels made(queue, {view_of(image), view_of(image)}, {false, false}, srgb_decode_table().data());
    const TextureImageView* views = made.images();
    TextureRef ref;
    ref.image = 1;
    const Vec2 uv = {0.3f, 0.7f};
    const auto at = [&](float level) { return lookup_mip_map(views, ref, uv, level, srgb_decode_table().data()); };
    CHECK(at(0) == lookup_texture(views, ref, uv, srgb_decode_table().data()));
    for (uint32_t k = 1; k <= 4; ++k) {
        const Vec4 of_level = lookup_image(views[views[1].first_coarser + k - 1], ref, uv, srgb_decode_table().data());
        CHECK(at(static_cast<float>(k)) == of_level);
        CHECK(at(static_cast<float>(k) - 0.5f) == mix_texels(at(static_cast<float>(k) - 1), of_level, 0.5f));
    }
    CHECK(at(50) == at(4));
}

TEST_CASE("mip-maps: a texture that is finer than the pixels has its mean, and one that is coarser its own bytes") {
    const Checker fine;
    const RenderResult with = render_with(fine.scene, fine.camera, settings_with(MipMaps::On)),
                       without = render_with(fine.scene, fine.camera, settings_with(MipMaps::Off));
    CHECK(test::mean_of(with.picture) == doctest::Approx(0.5).epsilon(0.01));
    CHECK(variance_of(with.picture) < 1e-4);
    CHECK(variance_of(without.picture) > 0.2);

    const Checker coarse(8);
    const auto hash_with = [&](MipMaps mip_maps) {
        return picture_hash(render_with(coarse.scene, coarse.camera, settings_with(mip_maps)).picture);
    };
    CHECK(hash_with(MipMaps::On) == hash_with(MipMaps::Off));
    CHECK(picture_hash(without.picture) ==
          picture_hash(render_with(fine.scene, fine.camera, settings_with(MipMaps::Frames)).picture));
}

TEST_CASE("mip-maps: the cone goes on at a mirror, and widens where light is scattered") {
    Checker above(64); // 4 texels for a pixel at its distance of one metre
    above.camera.projection = Projection::Perspective;
    above.camera.fov_y = 0.5f;
    Scene seen_in_mirror = above.scene;
    Mesh& checker = seen_in_mirror.meshes[0];
    // It hangs one metre over the floor, and the camera sees through its back: 4 texels for a pixel at five metres, and
    // one for what a pixel is wide at one metre.
    for (Vec3& p : checker.positions) p = {1.3f * p.x, 1, -1.3f * p.z};
    seen_in_mirror.materials[0].double_sided = false;
    for (const bool is_mirror : {true, false}) {
        CAPTURE(is_mirror);
        Scene scene = seen_in_mirror;
        add(scene, floor_at(0, 4), is_mirror ? mirror() : white());
        const RenderResult with = render_with(scene, above.camera, settings_with(MipMaps::On)),
                           without = render_with(scene, above.camera, settings_with(MipMaps::Off));
        CHECK(test::mean_of(with.picture) == doctest::Approx(test::mean_of(without.picture)).epsilon(0.1));
        CHECK(variance_of(with.picture) < 0.5 * variance_of(without.picture));
    }
}

TEST_CASE("mip-maps: alpha and emission are those of the image itself") {
    Checker checker;
    Material& material = checker.scene.materials[0];
    material.kind = MaterialKind::Diffuse;
    material.emission = grey(1);
    material.emission_texture = material.base_color_texture;
    material.base_color_texture = {};
    material.alpha_texture = material.emission_texture;
    material.alpha_mode = AlphaMode::Mask;
    RenderSettings settings = settings_with(MipMaps::On);
    settings.transparent = true;
    const Hash128 with = picture_hash(render_with(checker.scene, checker.camera, settings).picture);
    settings.path.mip_maps = MipMaps::Off;
    CHECK(with == picture_hash(render_with(checker.scene, checker.camera, settings).picture));
}

TEST_CASE("mip-maps: filtered pictures and frames have the same bytes in either schedule and on the device") {
    const Scene scene = make_mixed_scene();
    RenderSettings settings = settings_with(MipMaps::On, 40);
    settings.samples = 3;
    Queue cpu = Queue::make_cpu(), device = requested_queue();
    const Hash128 expected = render_hash(render(cpu, scene, mixed_scene_camera(), settings));
    CHECK(render_hash(render(device, scene, mixed_scene_camera(), settings)) == expected);
    settings.body = PathBody::Wavefront;
    CHECK(render_hash(render(cpu, scene, mixed_scene_camera(), settings)) == expected);
    settings.path.mip_maps = MipMaps::Off;
    CHECK(render_hash(render(cpu, scene, mixed_scene_camera(), settings)) != expected);
}

TEST_CASE("mip-maps: frames are filtered, with ReSTIR and without, unless the setting says otherwise") {
    Checker checker;
    checker.scene.materials[0].kind = MaterialKind::Diffuse;
    Light sun;
    sun.kind = LightKind::Directional;
    sun.direction = {0, -1, 0};
    sun.intensity = grey(kPi);
    checker.scene.lights.push_back(sun);
    Messages messages;
    const PreparedScene prepared = prepare_scene(checker.scene, {}, messages);
    const auto picture_of = [&](MipMaps mip_maps, RestirLight light) {
        Queue queue = requested_queue();
        Session session(queue, prepared, checker.camera, settings_with(mip_maps));
        RestirSettings restir;
        restir.light = light;
        session.render_frame(
            0, {.history = 1, .passes = 0, .clamp_fireflies = false, .clamp_history = false, .anti_alias = false},
            restir);
        return session.frame().picture();
    };
    for (const RestirLight light : {RestirLight::Off, RestirLight::Direct, RestirLight::Indirect}) {
        const Image filtered = picture_of(MipMaps::Frames, light);
        CHECK(test::mean_of(filtered) == doctest::Approx(0.5).epsilon(0.02));
        CHECK(variance_of(filtered) < 1e-3);
        CHECK(variance_of(picture_of(MipMaps::Off, light)) > 0.1);
    }
}

TEST_CASE("mip-maps are made when a picture needs them, predicted, and lost with their textures") {
    const Checker checker;
    Messages messages;
    const PreparedScene prepared = prepare_scene(checker.scene, {}, messages);
    Queue queue = requested_queue();
    SceneOnDevice scene(queue, prepared);
    const std::size_t before = queue.allocated_bytes();
    scene.make_mip_maps(queue);
    const std::size_t more = queue.allocated_bytes() - before, image = checker.scene.images[0].rgba8.pixels.size();
    CHECK(more > image / 3 - 64);
    CHECK(more < image / 3 + 1024);
    CHECK(scene.view().images != scene.view().lights.images);
    const uint64_t allocations = queue.allocation_count();
    scene.make_mip_maps(queue);
    CHECK(queue.allocation_count() == allocations);
    scene.update(queue, prepared, kPartTextures);
    CHECK(queue.allocated_bytes() == before);
    CHECK(scene.view().images == scene.view().lights.images);
}
