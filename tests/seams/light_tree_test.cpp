// Test code renders with a light tree of two nodes through the path tracer's functions. The picture is that of the
// light table, each sample has the density used to weight a hit of the light, and both devices give the same bytes.

#include "tests/seams/two_node_tree.h"

#include <doctest/doctest.h>

#include "image/picture_hash.h"
#include "integrators/kinds/make_integrator.h"
#include "tests/seams/picture_on_device.h"
#include "tests/support/chi_square.h"
#include "tests/support/compare_pictures.h"
#include "tests/support/lit_scenes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

constexpr uint32_t kTreeWidth = 16, kTreeHeight = 12;

/// A floor and a sheet seen from behind, under a sky and two emitters. Each emitter is near a part of them.
Scene two_emitter_scene() {
    Scene scene;
    const auto add = [&](Rgb color, Rgb emission, Vec3 at, Vec3 scale) {
        test::add_emitter(scene, test::make_square(1), emission, compose(make_translation(at), make_scale(scale)));
        scene.materials.back().base_color = color;
    };
    add(grey(0.6f), {0, 0, 0}, {0, 0, 0}, {5, 1, 3});
    add({0.8f, 0.5f, 0.3f}, {0, 0, 0}, {1.5f, 0.7f, 0.5f}, {0.8f, 1, 0.6f});
    add(grey(0.2f), {9, 6, 3}, {-2.5f, 1.2f, 0}, {0.4f, 1, 0.4f});
    add(grey(0.2f), {3, 6, 12}, {2.5f, 1.6f, 0}, {0.5f, 1, 0.3f});
    scene.environment = Environment{};
    scene.environment->scale = grey(0.05f);
    return scene;
}
Camera two_emitter_camera() {
    Camera camera;
    camera.world_from_camera = look_at({0, 2.5f, 7}, {0, 0.4f, 0}, {0, 1, 0});
    camera.fov_y = 0.6f;
    return camera;
}

struct TwoEmitters {
    explicit TwoEmitters(Queue& on)
        : queue(on), picture(on, prepared(), two_emitter_camera(), kTreeWidth, kTreeHeight) {}

    template <class Rounds>
    Image render(PathSettings settings, uint32_t samples) {
        Film film(queue, kTreeWidth, kTreeHeight, 0);
        Rounds(queue, kTreeWidth * kTreeHeight)
            .render({.picture = picture.view, .settings = settings, .film = film.view(), .layers = {}}, picture.tracer,
                    0, samples);
        CHECK(film.invalid_samples() == 0);
        film.set_samples({0, samples});
        return film.picture(false);
    }
    template <class Rounds>
    test::PictureEstimate estimate(LightStrategy strategy, uint32_t renders, uint32_t samples) {
        PathSettings settings = {.max_depth = 2, .strategy = strategy, .sampler = SamplerKind::Independent};
        return test::estimate_of(renders, [&](uint32_t number) {
            settings.seed = 100 * static_cast<uint32_t>(strategy) + number;
            return render<Rounds>(settings, samples);
        });
    }

    static const PreparedScene& prepared() {
        static const Scene scene = two_emitter_scene();
        static const PreparedScene prepared_scene = [] {
            Messages messages;
            return prepare_scene(scene, {}, messages);
        }();
        return prepared_scene;
    }
    Queue& queue;
    test::PictureOnDevice picture;
};

} // namespace

TEST_CASE("a schedule defined by a test over the path tracer's functions gives the bytes of the path tracer") {
    Queue queue = test::requested_queue();
    TwoEmitters emitters(queue);
    const auto integrator = make_integrator(queue, {});
    integrator->begin(emitters.picture.view, emitters.picture.tracer, 3);
    Film film(queue, kTreeWidth, kTreeHeight, 0);
    integrator->render(0, 3, film.view());
    film.set_samples({0, 3});
    CHECK(picture_hash(emitters.render<test::TableRounds>({}, 3)) == picture_hash(film.picture(false)));
}

TEST_CASE("a light tree gives the same bytes on both devices, which differ from those of the light table") {
    Queue cpu = Queue::make_cpu(), queue = test::requested_queue();
    TwoEmitters on_cpu(cpu), emitters(queue);
    const Hash128 hash = picture_hash(on_cpu.render<test::TreeRounds>({}, 4));
    CHECK(picture_hash(emitters.render<test::TreeRounds>({}, 4)) == hash);
    CHECK(picture_hash(emitters.render<test::TableRounds>({}, 4)) != hash);
}

TEST_CASE("a light tree converges to the light table's picture under every strategy, with less noise") {
    Queue queue = test::requested_queue();
    TwoEmitters emitters(queue);
    constexpr uint32_t kRenders = 24, kOfOne = 64;
    for (const LightStrategy strategy : {LightStrategy::Mis, LightStrategy::NeeOnly}) {
        CAPTURE(static_cast<int>(strategy));
        const test::PictureEstimate table = emitters.estimate<test::TableRounds>(strategy, kRenders, kOfOne);
        const test::PictureEstimate tree = emitters.estimate<test::TreeRounds>(strategy, kRenders, kOfOne);
        CHECK(test::p_value(tree, table) > 0.01);
        CHECK(test::p_value(test::brightened(tree, 1.02, 0), table) < 1e-6); // so an error of 2 % would be detected
        double of_table = 0, of_tree = 0;
        for (const double variance : table.variance_of_mean) of_table += variance;
        for (const double variance : tree.variance_of_mean) of_tree += variance;
        CHECK(of_tree < 0.5 * of_table);
    }
}

TEST_CASE("light that a path hits has the density by which the light tree samples it from the previous vertex") {
    Queue queue = test::requested_queue();
    TwoEmitters emitters(queue);
    const Film film(queue, kTreeWidth, kTreeHeight, 0);
    Buffer<uint32_t> counts(queue, 2, "counts");
    counts.zero();
    const test::DensityJob job = {
        {.picture = emitters.picture.view, .settings = {.max_depth = 3}, .film = film.view(), .layers = {}},
        counts.data(),
        counts.data() + 1};
    test::DensityRounds(queue, kTreeWidth * kTreeHeight).render(job, emitters.picture.tracer, 0, 32);
    const std::vector<uint32_t> of_lights = counts.download();
    CHECK(of_lights[0] > 1000);
    CHECK(of_lights[1] == 0);
}

TEST_CASE("a light tree samples lights with the probabilities that it reports") {
    const test::Lights lights(two_emitter_scene());
    const LightSetView& view = lights.view;
    REQUIRE(view.emitter_count == 2);
    REQUIRE(view.triangle_count == 4);
    const LightContext contexts[] = {{{-2, 0, 0.5f}, {0, 1, 0}, false, kAtRest},
                                     {{1.5f, 0.7f, 0.5f}, normalize(Vec3{0.3f, 1, 0}), false, kAtRest},
                                     {{1.5f, 0.7f, 0.5f}, {0, -1, 0}, true, kAtRest},
                                     {{4, 0.2f, -1}, kAtRest}};
    test::Random random(3);
    for (const LightContext& context : contexts) {
        std::vector<double> drawn(5), expected;
        constexpr uint32_t kDraws = 200'000;
        for (uint32_t light = 0; light < 4; ++light) {
            expected.push_back(kDraws * test::as_double(test::TwoNodeTree::pmf_of_triangle(view, context, light)));
        }
        expected.push_back(kDraws * test::as_double(test::TwoNodeTree::pmf_of_environment(view, context)));
        uint32_t other_density = 0;
        for (uint32_t i = 0; i < kDraws; ++i) {
            LightSample sample;
            if (!sample_light<EmitterVariant::Plain, test::TwoNodeTree>(view, context, test::random_bits(random),
                                                                        sample))
                continue;
            const bool is_sky = sample.instance == kNoLight;
            const uint32_t light = is_sky ? 4 : light_of(view, sample.instance, sample.primitive);
            drawn[light] += 1;
            const float pdf = is_sky ? find_environment<test::TwoNodeTree>(view, context, sample.wi, true).pdf
                                     : pdf_light_hit<test::TwoNodeTree>(view, light, context, sample.light_point);
            other_density += std::abs(pdf - sample.pdf) > 1e-5f * sample.pdf ? 1 : 0;
        }
        CHECK(other_density == 0);
        const test::ChiSquareResult result = test::chi_square(drawn, expected);
        CHECK_MESSAGE(result.passes(4), result.describe());
    }
}
