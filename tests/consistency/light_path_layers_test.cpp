// Layers of light-path expressions under the one-picture law: the same bytes for any number of threads, any split of
// the samples, either schedule of the path tracer, any batch. Layers do not change the picture, and layers that
// partition all paths add up to it. With --device cuda the GPU renders, too.

#include <doctest/doctest.h>

#include <span>

#include <fmt/format.h>

#include "base/machine_memory.h"
#include "base/parallel_for.h"
#include "render/light_paths/light_path_layers.h"
#include "session/render_memory.h"
#include "session/session_bytes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

/// Each path is in one of the first four layers, and in one of the last two.
constexpr const char* kLightLayers[] = {"seen=LE",       "direct=L[DG]E",           "mirrored=L.*SE",
                                        "rest=L.+[DG]E", "sky=L<'environment'>.*E", "lamps=L<^'environment'>.*E"};

std::shared_ptr<const LightPathLayers> light_layers_in(const Scene& scene, std::span<const std::string> texts) {
    std::vector<LightPathExpression> expressions;
    for (const std::string& text : texts) expressions.push_back(parse_light_path(text));
    return std::make_shared<const LightPathLayers>(bind_to_scene(std::move(expressions), scene));
}

RenderSettings with_light_layers(const Scene& scene) {
    RenderSettings settings;
    settings.width = 61; // not a multiple of a tile
    settings.height = 35;
    settings.samples = 4;
    settings.aovs = kAovAlbedo | kAovDepth;
    settings.light_paths =
        light_layers_in(scene, std::vector<std::string>(std::begin(kLightLayers), std::end(kLightLayers)));
    return settings;
}

/// A hundred different expressions, n0 to n99. Many of them accept the same light.
std::vector<std::string> hundred_expressions() {
    std::vector<std::string> texts;
    for (const char* end : {"D", "G", "S", ".", "[^D]"}) {
        for (const char* between : {"", ".?", ".*", "[DS]*"}) {
            for (const char* light : {"L", "L<'environment'>", "L<^'environment'>", "L<'*'>D", "LD"}) {
                texts.push_back("n" + std::to_string(texts.size()) + "=" + light + between + end + "E");
            }
        }
    }
    return texts;
}

RenderResult render_mixed_layers(Queue& queue, const RenderSettings& settings) {
    return test::render(queue, test::make_mixed_scene(), test::mixed_scene_camera(), settings);
}
Hash128 cpu_layers_hash(const RenderSettings& settings) {
    Queue queue = Queue::make_cpu();
    return test::render_hash(render_mixed_layers(queue, settings));
}
const Hash128& reference_layers_hash() {
    static const Hash128 hash = cpu_layers_hash(with_light_layers(test::make_mixed_scene()));
    return hash;
}

} // namespace

TEST_CASE("layers do not depend on threads, passes, schedules and batch sizes") {
    const RenderSettings settings = with_light_layers(test::make_mixed_scene());
    for (const int threads : {1, 5}) {
        const UseThreads use(threads);
        CHECK(cpu_layers_hash(settings) == reference_layers_hash());
    }
    RenderSettings other = settings;
    other.pass_samples = 1;
    CHECK(cpu_layers_hash(other) == reference_layers_hash());
    other = settings;
    other.body = PathBody::Wavefront;
    for (const uint32_t batch : {777u, 1u << 20}) {
        other.batch = batch;
        CHECK(cpu_layers_hash(other) == reference_layers_hash());
    }
    for (const PathBody body : {PathBody::Loop, PathBody::Wavefront}) { // hybrid has the samples of path
        other.integrator = IntegratorKind::Hybrid;
        other.body = body;
        CHECK(cpu_layers_hash(other) == reference_layers_hash());
    }
    if (!test::cuda_requested()) return;
    Queue queue = test::make_cuda_queue();
    for (const uint32_t batch : {777u, 1u << 20}) {
        other.batch = batch;
        CHECK(test::render_hash(render_mixed_layers(queue, other)) == reference_layers_hash());
    }
}

TEST_CASE("layers change neither the picture nor the auxiliary layers") {
    Queue queue = test::requested_queue();
    RenderSettings settings = with_light_layers(test::make_mixed_scene());
    RenderResult with = render_mixed_layers(queue, settings);
    settings.light_paths = nullptr;
    const RenderResult without = render_mixed_layers(queue, settings);
    CHECK(with.layers.size() == without.layers.size() + std::size(kLightLayers));
    with.layers.resize(without.layers.size());
    CHECK(test::render_hash(with) == test::render_hash(without));
}

TEST_CASE("layers that partition all paths add up to the picture within 1e-6") {
    Queue queue = test::requested_queue();
    for (const LightStrategy strategy : test::kLightStrategies) {
        RenderSettings settings = with_light_layers(test::make_mixed_scene());
        settings.path.strategy = strategy;
        settings.path.clamp = strategy == LightStrategy::Mis ? 0.0f : 2.0f;
        const RenderResult result = render_mixed_layers(queue, settings);
        const auto add = [&](std::initializer_list<const char*> names, std::size_t i) {
            double sum = 0;
            for (const char* name : names) sum += static_cast<double>(layer_named(result, name).pixels[i]);
            return sum;
        };
        std::size_t wrong = 0;
        double sums[6] = {};
        for (std::size_t i = 0; i < result.picture.pixels.size(); ++i) {
            const auto whole = static_cast<double>(result.picture.pixels[i]);
            const auto is_whole = [&](double sum) { return std::abs(sum - whole) <= 1e-6 * whole; };
            wrong += is_whole(add({"seen", "direct", "mirrored", "rest"}, i)) ? 0 : 1;
            wrong += is_whole(add({"sky", "lamps"}, i)) ? 0 : 1;
            int layer = 0;
            for (const char* name : {"seen", "direct", "mirrored", "rest", "sky", "lamps"})
                sums[layer++] += add({name}, i);
        }
        CHECK(wrong == 0);
        for (const double sum : sums) CHECK(sum > 0);
    }
}

TEST_CASE("each of 33, 64, 65 and 100 layers has the bytes of a render with that layer only") {
    const Scene scene = test::make_mixed_scene();
    const std::vector<std::string> texts = hundred_expressions();
    REQUIRE(texts.size() == 100);
    RenderSettings settings;
    settings.width = 29;
    settings.height = 17;
    settings.samples = 3;
    settings.aovs = kAovDepth;
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    const auto layers_by = [&](Session& session, std::span<const std::string> requested) {
        settings.light_paths = light_layers_in(scene, requested);
        session.set_settings(settings);
        session.render(settings.samples);
        std::vector<FilmLayer> layers = session.layers();
        CHECK(layers.size() == 1 + requested.size());
        layers.erase(layers.begin()); // depth
        return layers;
    };
    Queue queue = Queue::make_cpu();
    std::vector<Image> alone;
    {
        Session session(queue, prepared, test::mixed_scene_camera(), settings);
        for (const std::string& text : texts) alone.push_back(layers_by(session, {&text, 1}).front().image);
    }
    std::size_t lit = 0;
    for (const Image& image : alone) lit += test::mean_of(image) > 0 ? 1 : 0;
    CHECK(lit >= 90);
    for (const std::size_t border : {31u, 32u, 63u, 64u, 95u, 96u, 99u}) CHECK(test::mean_of(alone[border]) > 0);
    const auto check = [&](Queue& on, PathBody body, IntegratorKind integrator) {
        settings.body = body;
        settings.integrator = integrator;
        Session session(on, prepared, test::mixed_scene_camera(), settings);
        for (const std::size_t count : {33u, 64u, 65u, 100u}) {
            CAPTURE(count);
            const std::vector<FilmLayer> layers = layers_by(session, {texts.data(), count});
            for (std::size_t i = 0; i < count; ++i) {
                CAPTURE(i);
                CHECK(layers[i].name == "n" + std::to_string(i));
                CHECK(layers[i].image.pixels == alone[i].pixels);
            }
        }
    };
    check(queue, PathBody::Loop, IntegratorKind::Path);
    check(queue, PathBody::Wavefront, IntegratorKind::Path);
    check(queue, PathBody::Wavefront, IntegratorKind::Hybrid);
    if (!test::cuda_requested()) return;
    Queue gpu = test::make_cuda_queue();
    check(gpu, PathBody::Wavefront, IntegratorKind::Path);
}

TEST_CASE("a session that changes its layers renders the pictures of new sessions") {
    Queue queue = test::requested_queue();
    const Scene scene = test::make_mixed_scene();
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings = with_light_layers(scene);
    Session session(queue, prepared, test::mixed_scene_camera(), settings);
    session.render(2);
    RenderSettings none = settings;
    none.light_paths = nullptr;
    session.set_settings(none);
    session.render(1);
    CHECK(session.layers().size() == 2);
    session.set_settings(settings);
    session.render(1);
    session.meter(ToneMap::Agx); // a film without layers is rendered in between
    session.render(3);
    CHECK(test::render_hash(session.result()) == reference_layers_hash());
}

TEST_CASE("memory of layers equals its prediction in both schedules") {
    const Scene scene = test::make_mixed_scene();
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings = with_light_layers(scene);
    const auto few = settings.light_paths, many = light_layers_in(scene, hundred_expressions());
    for (const auto& [body, requested_layers] :
         {std::pair(PathBody::Loop, few), std::pair(PathBody::Wavefront, few), std::pair(PathBody::Loop, many),
          std::pair(PathBody::Wavefront, many)}) {
        settings.body = body;
        settings.light_paths = requested_layers;
        Queue queue = Queue::make_cpu();
        Session session(queue, prepared, test::mixed_scene_camera(), settings);
        session.render(settings.samples);
        const std::size_t predicted = predicted_bytes(prepared, settings, false);
        CHECK(queue.allocated_bytes() >= predicted);
        CHECK(queue.allocated_bytes() <= predicted + 4096); // the filter's table, the scene's view
        RenderSettings without = settings;
        without.light_paths = nullptr;
        const std::size_t pixels = settings.width * settings.height, paths = pixels * settings.samples;
        const std::size_t layers = pixels * requested_layers->count() * 3 * sizeof(FixedSum);
        const std::size_t queues = body == PathBody::Wavefront ? paths * 48 : 0;
        CHECK(predicted - predicted_bytes(prepared, without, false) == doctest::Approx(layers + queues).epsilon(0.01));
        check_render_memory(predicted, settings, {predicted, true, false});
        const auto error = test::thrown_error([&] {
            check_render_memory(predicted, settings, {predicted - 1, true, false});
        });
        REQUIRE((error && error->code() == ErrorCode::OutOfMemory));
        CHECK(test::says(error, fmt::format("{} layers of `lpe`", requested_layers->count())));
        CHECK(memory_to_render_in(queue, settings, predicted).bytes == predicted);
        const std::size_t of_machine = memory_to_render_in(queue, settings, {}).bytes;
        const std::size_t channels = 4 + 3 + 1 + 3 * requested_layers->count(); // with albedo and depth
        CHECK(of_machine == machine_memory_bytes() - pixels * channels * sizeof(float));
    }
}
