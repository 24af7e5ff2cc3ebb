// A film is rendered in two parts: samples [0, a) on one device and [a, n) on another. Each part is serialised and
// restored. Their sum has the bytes of one run's film in every target.

#include <doctest/doctest.h>

#include "image/picture_hash.h"
#include "render/light_paths/light_path_layers.h"
#include "session/film_render.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

/// A scene that is prepared once. Its emitter is too bright for a film, so that there are invalid samples.
struct BlindingWorld {
    Scene scene = test::make_mixed_scene();
    PreparedScene prepared;
    RenderSettings settings;
    BlindingWorld() {
        scene.materials[5].emission = grey(0x1p41f);
        Messages messages;
        prepared = prepare_scene(scene, {}, messages);
        settings.width = 32, settings.height = 20, settings.samples = 5;
        settings.aovs = kAovAlbedo | kAovNormal | kAovDepth | kAovPosition | kAovIds;
        settings.light_paths = std::make_shared<const LightPathLayers>(
            bind_to_scene({parse_light_path("sky=L<'environment'>.*E"), parse_light_path("once=L.E")}, scene));
    }
};

/// Renders films on one device.
struct FilmParts {
    FilmParts(Queue& queue, const BlindingWorld& world) : scene(queue), pictures(scene), settings(world.settings) {
        scene.set(world.prepared, settings);
    }
    FilmRender film(SampleRange range) {
        FilmRender film(pictures, test::mixed_scene_camera(), settings);
        CHECK(film.render(range) == range.count());
        CHECK(film.samples().first == range.first);
        return film;
    }

    DeviceScene scene;
    PictureRenderer pictures;
    RenderSettings settings;
};

std::vector<std::vector<std::byte>> bytes_of_targets(const Film& film) {
    std::vector<std::vector<std::byte>> all;
    for (const auto& target : film.targets()) all.push_back(target->bytes());
    return all;
}

/// Returns a film restored from bytes, on any device.
Film film_of_bytes(Queue& queue, const RenderSettings& settings, const std::vector<std::vector<std::byte>>& bytes,
                   SampleRange samples) {
    Film film(queue, settings.width, settings.height, settings.aovs, light_layers_of(settings));
    REQUIRE(film.targets().size() == bytes.size());
    for (std::size_t i = 0; i < bytes.size(); ++i) film.targets()[i]->set_bytes(bytes[i]);
    film.set_samples(samples);
    return film;
}

} // namespace

TEST_CASE("two parts of a film stored as bytes add up to the bytes of the film rendered at once") {
    const BlindingWorld world;
    Queue cpu = Queue::make_cpu(), queue = test::requested_queue();
    FilmParts on_cpu(cpu, world), on_asked(queue, world);
    FilmRender whole = on_cpu.film({0, 5});
    const auto bytes = bytes_of_targets(whole.film());
    REQUIRE(bytes.size() == 3); // sums, ids, invalid samples
    CHECK(whole.film().invalid_samples() > 0);
    const RenderResult picture = render_picture(cpu, world.prepared, test::mixed_scene_camera(), world.settings);
    CHECK(picture_hash(whole.picture()) == picture_hash(picture.picture));

    for (const uint32_t a : {1u, 4u}) {
        CAPTURE(a);
        FilmRender first = on_asked.film({0, a}), second = on_cpu.film({a, 5});
        const auto bytes_of_first = bytes_of_targets(first.film()), bytes_of_second = bytes_of_targets(second.film());
        for (std::size_t i = 0; i < bytes.size(); ++i) CHECK(bytes_of_second[i] != bytes[i]);
        CHECK(bytes_of_first[0] != bytes[0]);
        Film sum = film_of_bytes(cpu, world.settings, bytes_of_first, {0, a});
        sum.add(film_of_bytes(queue, world.settings, bytes_of_second, {a, 5}));
        CHECK(bytes_of_targets(sum) == bytes);
        CHECK(sum.part() == whole.film().part());
        second.film().add(first.film());
        CHECK(bytes_of_targets(second.film()) == bytes);
    }
}
